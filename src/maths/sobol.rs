//! Owen-scrambled Sobol points (Joe and Kuo's direction numbers, dimensions
//! 1 to 4; hashed Owen scrambling after Laine and Karras 2011 in the form of
//! Burley, "Practical Hash-based Owen Scrambling", JCGT 2020).

use super::hash::{hash3, unit_f32};

/// Points of a set are numbered up to 2^16; more are never asked for.
const DIRECTION_BITS: usize = 16;

/// Direction numbers of dimensions 2 to 4 (dimension 1 is the bit reversal),
/// from Joe and Kuo's table: (degree s, coefficients a, initial numbers m).
const JOE_KUO: [(u32, u32, &[u32]); 3] = [(1, 0, &[1]), (2, 1, &[1, 3]), (3, 1, &[1, 3, 1])];

const DIRECTIONS: [[u32; DIRECTION_BITS]; 4] = direction_numbers();

const fn direction_numbers() -> [[u32; DIRECTION_BITS]; 4] {
    let mut v = [[0_u32; DIRECTION_BITS]; 4];
    let mut i = 0;
    while i < DIRECTION_BITS {
        v[0][i] = 1 << (31 - i);
        i += 1;
    }
    let mut dim = 1;
    while dim < 4 {
        let (s, a, m) = JOE_KUO[dim - 1];
        let s = s as usize;
        let mut i = 0;
        while i < DIRECTION_BITS {
            if i < s {
                v[dim][i] = m[i] << (31 - i);
            } else {
                let mut x = v[dim][i - s] ^ (v[dim][i - s] >> s);
                let mut k = 1;
                while k < s {
                    if (a >> (s - 1 - k)) & 1 == 1 {
                        x ^= v[dim][i - k];
                    }
                    k += 1;
                }
                v[dim][i] = x;
            }
            i += 1;
        }
        dim += 1;
    }
    v
}

/// Coordinates of the points that have bits in one byte of their number only:
/// `PARTIAL[byte][value]`. A point is the exclusive or of its two bytes' (with a
/// loop over the bits, the points of a bake's rays took a fifth of its time).
static PARTIAL: [[[u32; 4]; 256]; 2] = partial_points();

const fn partial_points() -> [[[u32; 4]; 256]; 2] {
    let mut partial = [[[0_u32; 4]; 256]; 2];
    let mut byte = 0;
    while byte < 2 {
        let mut value = 0;
        while value < 256 {
            let mut dimension = 0;
            while dimension < 4 {
                let mut bit = 0;
                while bit < 8 {
                    if (value >> bit) & 1 == 1 {
                        partial[byte][value][dimension] ^= DIRECTIONS[dimension][8 * byte + bit];
                    }
                    bit += 1;
                }
                dimension += 1;
            }
            value += 1;
        }
        byte += 1;
    }
    partial
}

/// Point `index` (below 65,536) before scrambling.
fn sobol(index: u32) -> [u32; 4] {
    let low = &PARTIAL[0][(index & 0xff) as usize];
    let high = &PARTIAL[1][(index >> 8 & 0xff) as usize];
    [0, 1, 2, 3].map(|d| low[d] ^ high[d])
}

/// Owen scrambling by a hash that lets a bit depend on higher bits only
/// (the improved Laine-Karras permutation on reversed bits).
fn owen_scramble(bits: u32, seed: u32) -> u32 {
    let mut x = bits.reverse_bits();
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x.reverse_bits()
}

/// A set of points in the unit cube of 4 dimensions, scrambled by its seed: each is a
/// (0, m, 2)-net in its first two dimensions.
///
/// Points of different sets are independent unless the number of the one follows from
/// that of the other: where two sets are used together, one takes its points in the
/// order of [`Self::shuffled`].
#[derive(Clone, Copy)]
pub(crate) struct ScrambledSobol {
    seeds: [u32; 4],
}

impl ScrambledSobol {
    pub(crate) fn new(seed: u32, set: u32) -> Self {
        Self {
            seeds: [0, 1, 2, 3].map(|dimension| hash3(seed, set, dimension)),
        }
    }

    /// Point `index` (below 65,536), coordinates in [0, 1).
    pub(crate) fn point(&self, index: u32) -> [f32; 4] {
        debug_assert!(index < 1 << DIRECTION_BITS, "a Sobol set has 65,536 points");
        let bits = sobol(index);
        [0, 1, 2, 3].map(|d| unit_f32(owen_scramble(bits[d], self.seeds[d])))
    }

    /// A number (below 65,536) for `index`, such that runs of 2^k numbers that begin at a
    /// multiple of it stay such runs: this set's first two coordinates in that order are
    /// independent of another set's point by point, and as even (padding; Burley 2020,
    /// section 5). In the same order they are a function of one another.
    pub(crate) fn shuffled(&self, index: u32) -> u32 {
        debug_assert!(index < 1 << DIRECTION_BITS, "a Sobol set has 65,536 points");
        owen_scramble(index << (32 - DIRECTION_BITS), self.seeds[3]) >> (32 - DIRECTION_BITS)
    }

    /// The first two coordinates of point `index`.
    pub(crate) fn point2(&self, index: u32) -> [f32; 2] {
        let bits = sobol(index);
        [0, 1].map(|d| unit_f32(owen_scramble(bits[d], self.seeds[d])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_the_sum_of_its_bits_directions() {
        for index in (0..65_536).step_by(97) {
            let bits = (0..16).filter(|bit| index >> bit & 1 == 1);
            let expected = bits.fold([0; 4], |sum: [u32; 4], bit: usize| {
                [0, 1, 2, 3].map(|d| sum[d] ^ DIRECTIONS[d][bit])
            });
            assert_eq!(sobol(index), expected, "{index}");
        }
    }

    #[test]
    fn every_dimension_is_stratified() {
        let set = ScrambledSobol::new(7, 3);
        for d in 0..4 {
            let mut seen = [false; 256];
            for i in 0..256 {
                seen[(set.point(i)[d] * 256.0) as usize] = true;
            }
            assert!(
                seen.iter().all(|&s| s),
                "dimension {d} misses a 256th of its range"
            );
        }
    }

    #[test]
    fn first_two_dimensions_form_a_net() {
        let set = ScrambledSobol::new(1, 9);
        let mut seen = [false; 256];
        for i in 0..256 {
            let [x, y] = set.point2(i);
            seen[(x * 16.0) as usize * 16 + (y * 16.0) as usize] = true;
        }
        assert!(seen.iter().all(|&s| s), "a 16 x 16 cell has no point");
    }

    #[test]
    fn shuffled_points_of_another_set_fill_the_square_with_the_first_ones() {
        let [a, b] = [3, 4].map(|set| ScrambledSobol::new(1, set));
        let cells = |number: &dyn Fn(u32) -> u32| {
            let mut seen = [false; 256];
            for i in 512..1536 {
                let [x, y] = [a.point2(i)[0], b.point2(number(i))[0]];
                seen[(x * 16.0) as usize * 16 + (y * 16.0) as usize] = true;
            }
            seen.into_iter().filter(|&s| s).count()
        };
        // Without, x says which sixteenth y is in.
        assert_eq!(cells(&|i| i), 16);
        let found = cells(&|i| b.shuffled(i));
        assert!(found > 240, "{found} of 256 cells");
        // Runs stay runs.
        let mut run: Vec<u32> = (512..768).map(|i| b.shuffled(i)).collect();
        run.sort_unstable();
        assert_eq!(run[0] % 256, 0);
        assert!(run.windows(2).all(|pair| pair[1] == pair[0] + 1));
    }

    #[test]
    fn sets_differ_and_average_to_one_half() {
        let mean = |set: u32| {
            let points = ScrambledSobol::new(5, set);
            (0..1024)
                .map(|i| f64::from(points.point(i)[3]))
                .sum::<f64>()
                / 1024.0
        };
        assert!((mean(0) - 0.5).abs() < 1e-3);
        assert_ne!(
            ScrambledSobol::new(5, 0).point(17),
            ScrambledSobol::new(5, 1).point(17)
        );
    }
}
