//! Receivers that an operator is judged at, and the light that truly arrives there.

use rayon::prelude::*;

use super::basis::Basis;
use super::operator::{receiver_groups, vertices_of};
use super::test_lights::{Fields, LIGHTS};
use super::transfer::vertex_rays;
use super::{BakeError, RunSettings};
use crate::simd::Level;
use crate::surface::Surface;

/// Groups that stand for the scene, and rays of each half by which it is found how much
/// of a light arrives there: many receivers with few rays, whose noise is gone in the
/// mean.
pub(super) const GROUPS_OF_SCENE: usize = 4096;
pub(super) const RAYS_OF_SCENE: u32 = 64;

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

    /// Those that stand for the scene.
    pub(super) fn of_scene(surface: &Surface, basis: &Basis) -> Self {
        Self::spread(surface, basis, GROUPS_OF_SCENE)
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

    /// The same receivers, with errors relative to what arrives in the whole scene: where
    /// hardly anything of a light arrives, an error of it matters as little there as it
    /// does in the scene. (A spot of which these receivers saw next to nothing was 29 %
    /// wrong by them in the sheet's room, 6 % by all.)
    pub(super) fn relative_to_scene(
        self,
        job: (&Surface, &Basis, &RunSettings),
        scene: &Self,
        seeds: [u32; 2],
        fields: &Fields,
    ) -> Result<Self, BakeError> {
        let truth = Truth::sample(job, scene, (seeds, RAYS_OF_SCENE), fields)?;
        Ok(self.relative_to(scene, &truth))
    }

    fn relative_to(self, others: &Self, truth: &Truth) -> Self {
        Self {
            strengths: Some(others.strengths(truth)),
            ..self
        }
    }

    /// Groups, as first slot and count.
    pub(super) fn groups(&self) -> &[(u32, u32)] {
        &self.groups
    }

    /// Rays of a truth at all of them by so many in each half.
    pub(super) fn rays_of_truth(&self, rays: u32) -> u64 {
        2 * u64::from(rays) * self.areas.len() as u64
    }

    /// How many receivers there are.
    pub(super) fn receiver_count(&self) -> usize {
        self.areas.len()
    }

    /// How much of each light arrives at the receivers. The square is a product of the
    /// truth's halves, which are independent: that of their mean would have their noise.
    fn strengths(&self, truth: &Truth) -> Strengths {
        let area: f64 = self.areas.iter().sum();
        let [one, other] = &truth.halves;
        std::array::from_fn(|light| {
            let (mut squares, mut sum) = (0.0, 0.0);
            for ((area, a), b) in self.areas.iter().zip(one).zip(other) {
                let [a, b] = [a, b].map(|half| f64::from(half[light]));
                squares += area * a * b;
                sum += area * 0.5 * (a + b);
            }
            if area > 0.0 {
                [squares / area, sum / area]
            } else {
                [0.0; 2]
            }
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
    /// By so many rays of each of two seeds; a step of progress a ray.
    pub(crate) fn sample(
        (surface, basis, run): (&Surface, &Basis, &RunSettings),
        receivers: &Receivers,
        (seeds, rays): ([u32; 2], u32),
        fields: &Fields,
    ) -> Result<Self, BakeError> {
        let slots: Vec<usize> = receivers.slots().collect();
        let half = |seed| -> Result<Fields, BakeError> {
            let row_of = |&slot: &usize| {
                if run.progress.cancelled() {
                    return Err(BakeError::Cancelled);
                }
                let key = [seed, slot as u32];
                let row = true_row((surface, basis, run.level), key, rays, fields);
                run.progress.advance(u64::from(rays));
                Ok(row)
            };
            slots.par_iter().with_min_len(4).map(row_of).collect()
        };
        let halves = [half(seeds[0])?, half(seeds[1])?];
        let pairs = halves[0].iter().zip(&halves[1]);
        let mean = pairs
            .map(|(a, b)| std::array::from_fn(|l| 0.5 * (a[l] + b[l])))
            .collect();
        Ok(Self { halves, mean })
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
    (surface, basis, level): (&Surface, &Basis, Level),
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
        // Ten times the area, mean 4. The squares are products of the halves, 3 and 96,
        // in the mean 26.25; those of the halves' mean would be 4 and 100.
        let others = receivers([30.0, 10.0]);
        let everywhere = Truth {
            halves: [field([1.0, 12.0]), field([3.0, 8.0])],
            mean: Vec::new(),
        };
        let relative = [0.1 / 26.25_f64.sqrt(), 0.1 / 4.0];
        let judged = few().relative_to(&others, &everywhere);
        near(judged.errors(&truth, &estimate)[0], relative);
        assert_eq!(judged.errors(&truth, &estimate)[1], None, "a dark light");
        // Nothing arrives at the receivers, but in the scene.
        let in_the_dark = judged.errors(&field([0.0; 2]), &field([0.1; 2]));
        near(in_the_dark[0], relative);
        assert_eq!(few().errors(&field([0.0; 2]), &field([0.1; 2]))[0], None);
    }
}
