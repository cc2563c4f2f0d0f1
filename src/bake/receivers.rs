//! Receivers that an operator is judged at, and the light that truly arrives there.

use rayon::prelude::*;

use super::basis::Basis;
use super::operator::{receiver_groups, vertices_of};
use super::test_lights::{Fields, LIGHTS};
use super::transfer::vertex_rays;
use crate::simd::Level;
use crate::surface::Surface;

/// Vertices that are looked at: whole groups of eight.
pub(crate) struct Receivers {
    groups: Vec<(u32, u32)>,
    /// Areas of the receivers, group by group.
    areas: Vec<f64>,
    /// What errors are relative to where the receivers do not stand for the scene.
    strengths: Option<Strengths>,
}

/// How much of each light arrives: mean of the square over the area, and mean.
type Strengths = [[f64; 2]; LIGHTS];

impl Receivers {
    /// Groups spread evenly over the slots.
    pub(crate) fn spread(surface: &Surface, basis: &Basis, count: usize) -> Self {
        Self::among(surface, basis, &receiver_groups(basis), count)
    }

    /// Groups spread evenly over some.
    pub(super) fn among(
        surface: &Surface,
        basis: &Basis,
        all: &[(u32, u32)],
        count: usize,
    ) -> Self {
        let count = count.min(all.len());
        let groups: Vec<(u32, u32)> = (0..count)
            .map(|i| all[(2 * i + 1) * all.len() / (2 * count)])
            .collect();
        let areas = groups
            .iter()
            .flat_map(|&group| vertices_of(basis, group))
            .map(|&v| f64::from(surface.vertices.open_area(v as usize)))
            .collect();
        Self {
            groups,
            areas,
            strengths: None,
        }
    }

    /// The same receivers, with errors relative to what arrives at others: where
    /// hardly anything of a light arrives, an error of it matters as little there
    /// as it does in the whole scene.
    pub(super) fn relative_to(self, others: &Self, truth: &Truth) -> Self {
        Self {
            strengths: Some(others.strengths(&truth.mean)),
            ..self
        }
    }

    /// Groups, as first slot and count.
    pub(super) fn groups(&self) -> &[(u32, u32)] {
        &self.groups
    }

    /// How much of each field there is at the receivers.
    fn strengths(&self, fields: &Fields) -> Strengths {
        std::array::from_fn(|light| {
            let values = self.areas.iter().zip(fields);
            let sums = Sums::of(values.map(|(area, right)| (*area, right[light], 0.0)));
            let of_area = |sum: f64| {
                if sums.area > 0.0 {
                    sum / sums.area
                } else {
                    0.0
                }
            };
            [of_area(sums.right_squares), of_area(sums.right)]
        })
    }

    /// The slots, group by group.
    pub(crate) fn slots(&self) -> impl Iterator<Item = usize> {
        let slots = |&(first, count): &(u32, u32)| first as usize..(first + count) as usize;
        self.groups.iter().flat_map(slots)
    }

    /// The values of all slots at the receivers.
    pub(crate) fn pick(&self, fields: &Fields) -> Fields {
        self.slots().map(|slot| fields[slot]).collect()
    }

    /// Relative error of each light, and of its sum; `None` for a light that
    /// does not arrive.
    pub(crate) fn errors(&self, truth: &Fields, estimate: &Fields) -> [Option<[f64; 2]>; LIGHTS] {
        std::array::from_fn(|light| {
            let values = self.areas.iter().zip(truth).zip(estimate);
            let sums =
                Sums::of(values.map(|((area, right), found)| (*area, right[light], found[light])));
            match &self.strengths {
                Some(strengths) => {
                    let [square, mean] = strengths[light];
                    sums.relative_to([square * sums.area, mean * sums.area])
                }
                None => sums.relative(),
            }
        })
    }
}

/// Sums over the area of (area, right value, value found).
struct Sums {
    /// Of (found - right)^2, and of found - right.
    squares: f64,
    differences: f64,
    /// Of right^2, and of right.
    right_squares: f64,
    right: f64,
    area: f64,
}

impl Sums {
    fn of(values: impl Iterator<Item = (f64, f32, f32)>) -> Self {
        let mut sums = Self {
            squares: 0.0,
            differences: 0.0,
            right_squares: 0.0,
            right: 0.0,
            area: 0.0,
        };
        for (area, right, found) in values {
            let right = f64::from(right);
            let difference = f64::from(found) - right;
            sums.squares += area * difference * difference;
            sums.right_squares += area * right * right;
            sums.differences += area * difference;
            sums.right += area * right;
            sums.area += area;
        }
        sums
    }

    fn relative(&self) -> Option<[f64; 2]> {
        self.relative_to([self.right_squares, self.right])
    }

    /// Root mean square and mean error, relative to sums of right^2 and of right.
    fn relative_to(&self, [squares, sum]: [f64; 2]) -> Option<[f64; 2]> {
        (squares > 0.0 && sum > 0.0)
            .then(|| [(self.squares / squares).sqrt(), self.differences / sum])
    }
}

/// Error of a field over (area, right value, value found): root mean square
/// relative to the right field's, and that of the sum; `None` without any light.
pub(crate) fn relative_error(values: impl Iterator<Item = (f64, f32, f32)>) -> Option<[f64; 2]> {
    Sums::of(values).relative()
}

/// One bounce of the lights at the receivers by independent rays, twice.
pub(crate) struct Truth {
    halves: [Fields; 2],
    mean: Fields,
}

impl Truth {
    /// By so many rays of each of two seeds.
    pub(crate) fn sample(
        (surface, basis, level): (&Surface, &Basis, Level),
        receivers: &Receivers,
        (seeds, rays): ([u32; 2], u32),
        fields: &Fields,
    ) -> Self {
        let slots: Vec<usize> = receivers.slots().collect();
        let halves = seeds.map(|seed| {
            let rows = slots.par_iter().with_min_len(4);
            rows.map(|&slot| true_row(surface, basis, level, [seed, slot as u32], rays, fields))
                .collect::<Fields>()
        });
        let pairs = halves[0].iter().zip(&halves[1]);
        let mean = pairs
            .map(|(a, b)| std::array::from_fn(|l| 0.5 * (a[l] + b[l])))
            .collect();
        Self { halves, mean }
    }

    /// Relative noise of the mean.
    pub(super) fn noise(&self, receivers: &Receivers) -> [Option<[f64; 2]>; LIGHTS] {
        receivers.errors(&self.mean, &self.halves[0])
    }

    /// Errors of an estimate, less what is the truth's own noise.
    pub(crate) fn errors(
        &self,
        receivers: &Receivers,
        estimate: &Fields,
    ) -> [Option<[f64; 2]>; LIGHTS] {
        let noise = self.noise(receivers);
        let mut errors = receivers.errors(&self.mean, estimate);
        for (error, noise) in errors.iter_mut().zip(noise) {
            if let (Some([error, _]), Some([noise, _])) = (error, noise) {
                let squared = *error * *error - noise * noise;
                *error = if squared > 0.0 { squared.sqrt() } else { 0.0 };
            }
        }
        errors
    }
}

/// What a vertex receives of every light, by rays of a seed.
fn true_row(
    surface: &Surface,
    basis: &Basis,
    level: Level,
    [seed, slot]: [u32; 2],
    rays: u32,
    fields: &Fields,
) -> [f32; LIGHTS] {
    let vertex = basis.vertex_of_slot()[slot as usize];
    let mut sums = [0.0_f32; LIGHTS];
    let mut inside = 0;
    for (_, (_, hit)) in vertex_rays(surface, level, [seed, vertex], rays) {
        let Some(hit) = hit else { continue };
        let Some(met) = surface.vertices.met(&hit) else {
            inside += 1;
            continue;
        };
        for (sender, weight) in met {
            let values = &fields[basis.slot_of_vertex()[sender as usize] as usize];
            for light in 0..LIGHTS {
                sums[light] += weight * values[light];
            }
        }
    }
    sums.map(|sum| sum / (rays - inside).max(1) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two receivers of these areas.
    fn receivers(areas: [f64; 2]) -> Receivers {
        Receivers {
            groups: Vec::new(),
            areas: areas.to_vec(),
            strengths: None,
        }
    }

    /// Values of light 0 at them; the other lights are dark.
    fn field(values: [f32; 2]) -> Fields {
        let of = |value| {
            let mut lights = [0.0; LIGHTS];
            lights[0] = value;
            lights
        };
        values.map(of).to_vec()
    }

    #[test]
    fn errors_are_relative_to_what_arrives_in_the_scene() {
        let (truth, estimate) = (field([1.0, 1.0]), field([1.1, 1.1]));
        let near = |found: Option<[f64; 2]>, expected: [f64; 2]| {
            let [error, mean] = found.expect("light arrives");
            assert!((error - expected[0]).abs() < 1e-6, "{error}");
            assert!((mean - expected[1]).abs() < 1e-6, "{mean}");
        };
        let few = || receivers([1.0, 3.0]);
        near(few().errors(&truth, &estimate)[0], [0.1, 0.1]);
        // Ten times the area, mean 4 and mean square 28.
        let others = receivers([30.0, 10.0]);
        let everywhere = Truth {
            halves: [Vec::new(), Vec::new()],
            mean: field([2.0, 10.0]),
        };
        let relative = [0.1 / 28.0_f64.sqrt(), 0.1 / 4.0];
        let judged = few().relative_to(&others, &everywhere);
        near(judged.errors(&truth, &estimate)[0], relative);
        assert_eq!(judged.errors(&truth, &estimate)[1], None, "a dark light");
        // Nothing arrives at the receivers, but in the scene.
        let in_the_dark = judged.errors(&field([0.0; 2]), &field([0.1; 2]));
        near(in_the_dark[0], relative);
        assert_eq!(few().errors(&field([0.0; 2]), &field([0.1; 2]))[0], None);
    }
}
