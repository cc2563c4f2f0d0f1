//! What a light does to a scene, roughly: shadow rays from a few points that stand
//! for all that hands light on.

use super::places::Places;
use crate::maths::hash::uniform;
use crate::maths::order::Order;
use crate::scene::PlacedLight;
use crate::surface::SurfacePoint;
use crate::surface::direct::{LightPoints, Shadows};

/// Points, and their seed. (Spread by what vertices hand on: 512 know how evenly a
/// light lights a room to some 5 %, which is enough to sort lights by.)
const PROBES: u32 = 512;
const SEED: u32 = 0x9e0b;

/// What a light does.
pub(super) struct Footprint {
    /// (sum E)^2 / sum E^2 over the points: how many it lights, as it were.
    pub(super) evenness: f64,
    /// Share of its light that arrives at a second surface.
    pub(super) indirect_share: f64,
    /// Number of the brightest point. Points are numbered as the vertices are, so
    /// that near numbers are near places, mostly.
    pub(super) brightest: usize,
}

/// A point that hands light on, and the share of its rays that arrive.
struct Probe {
    point: SurfacePoint,
    arrived: f64,
}

impl Footprint {
    /// Whether no probe is lit; a small patch may be.
    pub(super) fn is_unseen(&self) -> bool {
        self.evenness == 0.0
    }
}

/// Points that lights are looked at by.
pub(super) struct Probes<'a> {
    shadows: Shadows<'a>,
    probes: Vec<Probe>,
}

impl<'a> Probes<'a> {
    /// Points of a seed.
    pub(super) fn of(places: &Places<'a>, seed: u32) -> Self {
        let probe = |index: u32| {
            let u = |dimension| uniform(seed ^ SEED, index, dimension);
            // Rounding reaches 1, where there is no vertex.
            let place = ((index as f32 + u(0)) / PROBES as f32).at_most(1.0 - f32::EPSILON);
            let (vertex, arrived) = places.hands_on(place);
            Probe {
                point: places.surface().sample_point(vertex, [u(1), u(2)]),
                arrived,
            }
        };
        Self {
            shadows: Shadows::of_surface(places.surface(), places.level()),
            probes: (0..PROBES).map(probe).collect(),
        }
    }

    /// What a light does to them.
    pub(super) fn footprint(&self, light: &PlacedLight) -> Footprint {
        let points = LightPoints::of(SEED, 0, 0, 1);
        let (mut sum, mut squares, mut all) = (0.0, 0.0, 0.0);
        let mut brightest = (0.0, 0);
        for (number, probe) in self.probes.iter().enumerate() {
            let value = f64::from(self.shadows.irradiance(light, &probe.point, points).x);
            sum += value;
            squares += value * value;
            // The points are dense where much is handed on.
            all += value / probe.arrived;
            if value > brightest.0 {
                brightest = (value, number);
            }
        }
        let over = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
        Footprint {
            evenness: over(sum * sum, squares),
            indirect_share: over(sum, all),
            brightest: brightest.1,
        }
    }
}
