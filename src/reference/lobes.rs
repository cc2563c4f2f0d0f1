//! How a path's vertex reflects: a diffuse part and, maybe, a glossy lobe, of
//! which a path follows one.

use glam::Vec3;

use super::ReferencePart;
use super::lights::Drawn;
use crate::brdf::{Glossy, ViewedFrame};
use crate::maths::order::Order;
use crate::maths::sampling::{cosine_direction, mirrored_above};
use crate::scene::max_component;
use crate::surface::SurfacePoint;
use crate::surface::direct::SeenLobe;

/// Least chance of each part where there are both, so that none is forgotten.
const LEAST_CHANCE: f32 = 0.1;

/// Diffuse albedo and lobe of a vertex for one viewer.
pub(super) struct Reflection<'a> {
    pub(super) diffuse: Vec3,
    pub(super) lobe: Option<SeenLobe<'a>>,
    /// Directional albedo of the lobe.
    lobe_albedo: Vec3,
}

/// The part that a path follows, and 1 over the chance of it.
pub(super) enum Branch<'a> {
    Diffuse(Vec3),
    Lobe(SeenLobe<'a>, f32),
}

/// Where a path goes on.
pub(super) struct Followed {
    pub(super) direction: Vec3,
    /// What its throughput is multiplied by.
    pub(super) weight: Vec3,
    pub(super) drawn: Drawn,
}

impl<'a> Reflection<'a> {
    /// `albedo` is Kd; without `reflects` the lobe is part of the diffuse albedo.
    pub(super) fn of(
        albedo: Vec3,
        glossy: Option<&'a Glossy>,
        reflects: bool,
        point: &SurfacePoint,
        to_eye: Vec3,
    ) -> Self {
        let plain = |diffuse| Self {
            diffuse,
            lobe: None,
            lobe_albedo: Vec3::ZERO,
        };
        let Some(glossy) = glossy else {
            return plain(albedo);
        };
        if !reflects {
            let by_lobe = glossy.mean_albedo();
            return plain(albedo * (Vec3::ONE - by_lobe) + by_lobe);
        }
        let frame = ViewedFrame::of(point.normal, to_eye);
        let lobe_albedo = glossy.albedo(frame.cosine);
        Self {
            diffuse: albedo * (Vec3::ONE - lobe_albedo),
            lobe: Some(SeenLobe { glossy, frame }),
            lobe_albedo,
        }
    }

    /// The part to follow, by a uniform; `None` if the picture's part ends here.
    pub(super) fn branch(&self, bounce: u32, part: ReferencePart, u: f32) -> Option<Branch<'a>> {
        let lobe = self.lobe;
        match (part, bounce, lobe) {
            (ReferencePart::Glossy, 0, None) => return None,
            (ReferencePart::Glossy, 0, Some(lobe)) => return Some(Branch::Lobe(lobe, 1.0)),
            (ReferencePart::Indirect, 0, _) | (_, _, None) => {
                return Some(Branch::Diffuse(self.diffuse));
            }
            _ => {}
        }
        let lobe = lobe?;
        let [diffuse, by_lobe] = [self.diffuse, self.lobe_albedo].map(max_component);
        if diffuse <= 0.0 {
            return Some(Branch::Lobe(lobe, 1.0));
        }
        let chance = by_lobe / (by_lobe + diffuse);
        let chance = chance.at_least(LEAST_CHANCE).at_most(1.0 - LEAST_CHANCE);
        Some(if u < chance {
            Branch::Lobe(lobe, 1.0 / chance)
        } else {
            Branch::Diffuse(self.diffuse / (1.0 - chance))
        })
    }
}

impl Branch<'_> {
    /// Where the path goes on; not at all where the lobe reflects into the surface.
    pub(super) fn followed(&self, point: &SurfacePoint, u: [f32; 2]) -> Option<Followed> {
        match self {
            Self::Diffuse(weight) => {
                let about_normal = cosine_direction(point.normal, u);
                let direction = mirrored_above(about_normal, point.flat_normal);
                Some(Followed {
                    direction,
                    weight: *weight,
                    drawn: Drawn::diffuse(point, direction),
                })
            }
            Self::Lobe(lobe, scale) => {
                let (direction, weight) = lobe.glossy.sample(&lobe.frame, u)?;
                let density = lobe.glossy.density(&lobe.frame, direction);
                let is_above = direction.dot(point.flat_normal) > 0.0;
                is_above.then(|| Followed {
                    direction,
                    weight: weight * *scale,
                    drawn: Drawn::ByLobe(density),
                })
            }
        }
    }
}
