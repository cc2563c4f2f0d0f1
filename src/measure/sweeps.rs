//! Error against what a bake may spend: functions, coefficients, rays. Every
//! point is a bake of its own; all share the traced rays.

use std::time::{Duration, Instant};

use glam::Vec3;

use super::vertices::{BOUNCES, Truth};
use crate::bake::{
    Bake, BakeError, BakeSettings, DEFAULT_RAYS, LightErrors, RunSettings, Scheme, Study,
};
use crate::maths::order::Order;
use crate::relight::Transport;
use crate::scene::Bounces;

/// Points of the sweeps, ascending. (At 256 coefficients relume's own scheme, which
/// leaves out components that are noise, has 130 bytes a vertex: 512 bring it to those
/// of the published scheme.)
const FUNCTIONS: [u32; 7] = [32, 64, 128, 256, 512, 1024, 2048];
const COEFFICIENTS: [u32; 6] = [16, 32, 64, 128, 256, 512];
pub(super) const RAYS: [u32; 5] = [384, 768, 1536, 3072, DEFAULT_RAYS];
/// Times at least that the bounces of a point are timed, and for how long at least;
/// the least counts, since other programs only ever add to it. (The same bake had 7.5
/// and 14.1 ms on a busy machine by 15 times alone, which are over in 0.1 s.)
pub(super) const TIMED: usize = 15;
const TIMED_FOR: Duration = Duration::from_millis(300);

/// What a sweep changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Swept {
    /// Functions of the basis.
    Functions,
    /// Coefficients a vertex.
    Coefficients,
    /// Rays a vertex.
    Rays,
}

impl Swept {
    pub(super) const ALL: [Self; 3] = [Self::Functions, Self::Coefficients, Self::Rays];

    fn values(self) -> &'static [u32] {
        match self {
            Self::Functions => &FUNCTIONS,
            Self::Coefficients => &COEFFICIENTS,
            Self::Rays => &RAYS,
        }
    }

    /// Its values for a mesh of so many partitions, each of which has a function: of
    /// fewer functions than that, the last value says what all of them do.
    fn values_from(self, partitions: usize) -> &'static [u32] {
        let values = self.values();
        let too_few = |&&value: &&u32| self == Self::Functions && value as usize <= partitions;
        let alike = values.iter().take_while(too_few).count();
        &values[alike.saturating_sub(1)..]
    }

    fn put(self, settings: &BakeSettings, value: u32) -> BakeSettings {
        let mut settings = *settings;
        match self {
            Self::Functions => settings.functions = Some(value),
            Self::Coefficients => settings.coefficients = value,
            Self::Rays => settings.rays = value,
        }
        settings
    }
}

/// One bake of a sweep.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    pub(super) scheme: Scheme,
    pub(super) is_default: bool,
    /// What the settings ask for.
    pub(super) functions_asked: u32,
    pub(super) coefficients_asked: u32,
    pub(super) rays: u32,
    /// What the bake has.
    pub(super) partitions: usize,
    pub(super) functions: usize,
    pub(super) coefficients: f64,
    /// Of the operator; the basis is apart.
    pub(super) bytes_per_vertex: f64,
    /// After one bounce and after four.
    pub(super) errors: [LightErrors; 2],
    /// One bounce with nothing cut or quantised (the sweep of functions, and the
    /// defaults).
    pub(super) uncut: Option<Uncut>,
    /// Of all threads by the clock: what tracing so many rays took in the mean, and
    /// building the operator; of the scene's own bake, all of it.
    pub(super) bake_seconds: f64,
    /// Four bounces of RGB light, all threads, the least of [`TIMED`] or more.
    pub(super) relight_ms: f64,
}

/// Mean errors after one bounce of sampled rows that nothing is left out of.
#[derive(Debug, Clone, Copy)]
pub(super) struct Uncut {
    /// The rows themselves: the dense transfer by as many rays.
    pub(super) rows: f64,
    /// On all functions of the basis, with the near field.
    pub(super) on_basis: f64,
}

/// What points are measured by.
pub(super) struct Sweeper<'a> {
    pub(super) study: &'a Study<'a>,
    pub(super) truth: &'a Truth,
    /// Rays a vertex that the study keeps.
    pub(super) most_rays: u32,
    /// What tracing one of them from every vertex took, in the mean.
    pub(super) seconds_a_ray: f64,
}

impl Sweeper<'_> {
    /// Bakes and measures all points of a sweep whose rays are kept, and adds those
    /// that it starts from, as they were found before.
    pub(super) fn sweep(
        &self,
        swept: Swept,
        starts: &[(BakeSettings, Point)],
        run: &RunSettings,
    ) -> Result<Vec<Point>, BakeError> {
        let mut points = Vec::new();
        for (settings, start) in starts {
            let mut found = vec![*start];
            for &value in swept.values_from(start.partitions) {
                if run.progress.cancelled() {
                    return Err(BakeError::Cancelled);
                }
                let settings = swept.put(settings, value);
                let is_start = match swept {
                    Swept::Functions => {
                        let are_alike = |count: u32| count as usize <= start.partitions;
                        let asked = start.functions_asked;
                        value == asked || are_alike(value) && are_alike(asked)
                    }
                    Swept::Coefficients => value == start.coefficients_asked,
                    Swept::Rays => value == start.rays,
                };
                if is_start || settings.rays > self.most_rays {
                    continue;
                }
                let (bake, seconds) = self.timed_bake(&settings, run)?;
                let mut point = self.point(&bake, &settings, seconds, run);
                if swept == Swept::Functions {
                    point.uncut = Some(self.uncut(&bake, &settings, run)?);
                }
                found.push(point);
            }
            found.sort_by(|a, b| swept.place(a).total_cmp(&swept.place(b)));
            points.extend(found);
        }
        Ok(points)
    }

    /// Measures where a sweep starts: as a default is, but for the rays.
    pub(super) fn start(
        &self,
        settings: &BakeSettings,
        run: &RunSettings,
    ) -> Result<Point, BakeError> {
        let (bake, seconds) = self.timed_bake(settings, run)?;
        Ok(Point {
            is_default: true,
            uncut: Some(self.uncut(&bake, settings, run)?),
            ..self.point(&bake, settings, seconds, run)
        })
    }

    /// A bake, and its seconds with those of its rays, which may have been traced
    /// before.
    pub(super) fn timed_bake(
        &self,
        settings: &BakeSettings,
        run: &RunSettings,
    ) -> Result<(Bake, f64), BakeError> {
        let start = Instant::now();
        let bake = self.study.bake(settings, run)?;
        let mut seconds = start.elapsed().as_secs_f64();
        if settings.rays <= self.most_rays {
            seconds += self.seconds_a_ray * f64::from(settings.rays);
        }
        Ok((bake, seconds))
    }

    fn uncut(
        &self,
        bake: &Bake,
        settings: &BakeSettings,
        run: &RunSettings,
    ) -> Result<Uncut, BakeError> {
        Ok(self.truth.parts(self.study, bake, settings, run)?.uncut())
    }

    /// Measures a bake that took so many seconds.
    pub(super) fn point(
        &self,
        bake: &Bake,
        settings: &BakeSettings,
        bake_seconds: f64,
        run: &RunSettings,
    ) -> Point {
        run.progress.stage("error", 1);
        let errors = self.truth.scheme(bake, run);
        let slots = bake.basis().slot_count().max(1);
        Point {
            scheme: settings.scheme,
            is_default: false,
            functions_asked: settings.function_count(slots),
            coefficients_asked: settings.coefficients,
            rays: settings.rays,
            partitions: bake.basis().part_count(),
            functions: bake.basis().function_count(),
            coefficients: bake.operator().coefficients_per_vertex(),
            bytes_per_vertex: bake.operator().bytes() as f64 / slots as f64,
            errors: [errors.all(0), errors.all(1)],
            uncut: None,
            bake_seconds,
            relight_ms: self.relight_ms(bake, run),
        }
    }

    fn relight_ms(&self, bake: &Bake, run: &RunSettings) -> f64 {
        let transport = Transport {
            bake,
            level: run.level,
        };
        let albedo: Vec<Vec3> = self
            .truth
            .albedo()
            .iter()
            .map(|&a| Vec3::splat(a))
            .collect();
        let begin = Instant::now();
        let (mut least, mut count) = (f64::INFINITY, 0);
        while count < TIMED || begin.elapsed() < TIMED_FOR {
            let start = Instant::now();
            let solved = transport.solve(&albedo, &albedo, Bounces::Count(BOUNCES));
            std::hint::black_box(solved.is_ok());
            least = f64::at_most(least, start.elapsed().as_secs_f64() * 1e3);
            count += 1;
        }
        least
    }
}

impl Swept {
    /// Where a point stands on the horizontal axis.
    pub(super) fn place(self, point: &Point) -> f64 {
        match self {
            Self::Functions => point.functions as f64,
            Self::Coefficients => point.coefficients,
            Self::Rays => f64::from(point.rays),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bakes_that_would_be_one_are_made_once() {
        let functions = |partitions| Swept::Functions.values_from(partitions);
        assert_eq!(functions(1), FUNCTIONS);
        assert_eq!(functions(32), FUNCTIONS);
        assert_eq!(functions(140), &FUNCTIONS[2..]);
        assert_eq!(functions(5000), [2048]);
        assert_eq!(Swept::Rays.values_from(5000), RAYS);
    }
}
