//! Numbers as the scene file has them: the shortest decimal that is read back as
//! the same bits.

use glam::{DVec3, Vec3};

use crate::scene::file::fields::unit;

/// Most decimals of a component of a direction: enough for the smallest number
/// of single precision.
const MOST_DECIMALS: usize = 50;
/// Powers of two by which a length is varied until normalising it rounds well.
const LENGTHS: usize = 64;

/// A number in double precision.
pub(super) fn double(number: f64) -> String {
    format!("{number:?}")
}

/// A number that the reader rounds to single precision.
pub(super) fn single(number: f32) -> String {
    let short = format!("{number:?}");
    let read = short.parse::<f64>().map(|read| (read as f32).to_bits());
    if read == Ok(number.to_bits()) {
        short
    } else {
        double(f64::from(number))
    }
}

/// Three numbers in double precision.
pub(super) fn vector(vector: DVec3) -> [String; 3] {
    vector.to_array().map(double)
}

/// Three numbers that the reader rounds to single precision.
pub(super) fn colour(colour: Vec3) -> [String; 3] {
    colour.to_array().map(single)
}

/// A direction that the reader makes a unit vector of: the fewest decimals from
/// which it makes this one.
pub(super) fn direction(direction: Vec3) -> [String; 3] {
    let unit_vector = unit_within(direction);
    let found = rounded(unit_vector, |read| reads_as(read, direction));
    vector(found.unwrap_or(unit_vector))
}

/// A target at about `distance` along a direction from a position, from which
/// the reader makes this direction; `None` where the digits do not suffice.
pub(super) fn target(position: DVec3, direction: Vec3, distance: f64) -> Option<[String; 3]> {
    let exact = position + unit_within(direction) * distance;
    rounded(exact, |read| reads_as(read - position, direction)).map(vector)
}

/// A unit vector in double precision that the reader makes the same of.
pub(super) fn unit_direction(direction: DVec3) -> [String; 3] {
    let same =
        |candidate: &DVec3| unit(*candidate).is_some_and(|read| bits(read) == bits(direction));
    let lengths = (0..LENGTHS).map(|length| direction * (1.0 + length as f64 / LENGTHS as f64));
    vector(lengths.into_iter().find(same).unwrap_or(direction))
}

fn bits(vector: DVec3) -> [u64; 3] {
    vector.to_array().map(f64::to_bits)
}

fn reads_as(vector: DVec3, direction: Vec3) -> bool {
    let read = unit(vector).map(|read| read.as_vec3().to_array().map(f32::to_bits));
    read == Some(direction.to_array().map(f32::to_bits))
}

/// A vector with the fewest decimals that fits.
fn rounded(vector: DVec3, fits: impl Fn(DVec3) -> bool) -> Option<DVec3> {
    (1..=MOST_DECIMALS)
        .map(|decimals| {
            DVec3::from_array(
                vector
                    .to_array()
                    .map(|x| format!("{x:.decimals$}").parse().unwrap_or(x)),
            )
        })
        .find(|candidate| fits(*candidate))
}

/// A vector of unit length in double precision among those that round to
/// `direction`: each component may move by half a unit of its last place. There
/// is one for every direction that was rounded from a unit vector.
fn unit_within(direction: Vec3) -> DVec3 {
    let middle = direction.as_dvec3();
    if reads_as(middle, direction) {
        return middle.normalize();
    }
    // Almost half a unit of the last place of single precision.
    let room = direction.to_array().map(|x| {
        let step = f64::from(f32::from_bits(x.abs().to_bits() + 1)) - f64::from(x.abs());
        0.499 * step
    });
    let stretched = |stretch: f64| {
        let by = |x: f64, room: f64| x + (x * stretch).clamp(-room, room);
        DVec3::new(
            by(middle.x, room[0]),
            by(middle.y, room[1]),
            by(middle.z, room[2]),
        )
    };
    // Longer stretches are longer vectors, so the unit one is found by halving.
    let (mut low, mut high) = (-1e-6, 1e-6);
    for _ in 0..80 {
        let between = 0.5 * (low + high);
        if stretched(between).length() < 1.0 {
            low = between;
        } else {
            high = between;
        }
    }
    stretched(high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::functions::{cos, sin};

    #[test]
    fn numbers_are_short_and_read_back() {
        assert_eq!(double(0.1), "0.1");
        assert_eq!(double(2.0), "2.0");
        assert_eq!(single(0.1), "0.1");
        assert_eq!(single(1e30), "1e30");
        for bits in (0..0x7f00_0000_u32).step_by(0x1_2345) {
            let number = f32::from_bits(bits);
            let read: f64 = single(number).parse().unwrap();
            assert_eq!((read as f32).to_bits(), bits, "{number}");
        }
    }

    fn directions() -> impl Iterator<Item = Vec3> {
        (0..2000_u32).map(|index| {
            let (turn, tilt) = (f64::from(index) * 0.7, f64::from(index) * 0.013 - 13.0);
            let exact = DVec3::new(cos(turn) * cos(tilt), sin(tilt), sin(turn) * cos(tilt));
            unit(exact).unwrap().as_vec3()
        })
    }

    fn read([x, y, z]: [String; 3]) -> DVec3 {
        let number = |text: String| text.parse::<f64>().unwrap();
        DVec3::new(number(x), number(y), number(z))
    }

    #[test]
    fn directions_read_back_with_few_digits() {
        for direction in directions() {
            let written = super::direction(direction);
            let digits = written.iter().map(String::len).max().unwrap();
            assert!(digits <= 15, "{written:?}");
            assert!(reads_as(read(written), direction), "{direction}");
        }
        let down = super::direction(Vec3::new(0.0, -1.0, 0.0));
        assert_eq!(down, ["0.0", "-1.0", "0.0"].map(str::to_owned));
    }

    #[test]
    fn targets_read_back_as_directions() {
        let position = DVec3::new(0.5, 1.9, -0.25);
        for direction in directions() {
            let written = target(position, direction, 1.7).unwrap();
            assert!(reads_as(read(written) - position, direction), "{direction}");
        }
        assert_eq!(target(DVec3::splat(1e12), Vec3::X, 1e-9), None);
    }
}
