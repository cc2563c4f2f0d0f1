//! What the rays of neighbouring pixels found, for a pixel too.
//!
//! A patch of sun seen from the other end of a room is met by one ray in a hundred,
//! and 256 rays leave grain there. The points of neighbours complete one another, so
//! a mean over some pixels has next to none of it; it is taken over those to which
//! all that sends light is so far away that it looks the same from there: by the
//! harmonic mean of the rays' lengths (Ward, Rubinstein and Clear, "A Ray Tracing
//! Solution for Diffuse Interreflection", 1988).

use glam::Vec3;
use rayon::prelude::*;

use super::{Gathered, SITES_A_TASK};
use crate::maths::order::Order;
use crate::relight::reach::seen_point;
use crate::relight::shade::View;
use crate::relight::sites::Sites;
use crate::surface::SurfacePoint;

/// Pixels either way that a mean is taken over. In a room with a patch of sun
/// (`window/day.toml`, 320 x 240) pixels are full of grain without, and smooth but for
/// some along corners with it; the error of 8 x 8 means falls from 0.277 % to 0.266 %.
/// In the same room by a lamp, which has no grain to begin with, blur raises it from
/// 0.192 % to 0.212 %. Farther would blur more for nothing: a tile has 16 pixels.
const REACH_PX: usize = 4;
/// Distance of two points, share of the harmonic mean of the lengths of their rays, up
/// to which they are taken for one another: there weights end, and so does the detail
/// that is kept where surfaces meet.
const ALIKE_WITHIN: f32 = 0.1;
/// The same of the angle between their normals, as a share of a radian.
const NORMALS_WITHIN: f32 = 0.1;

/// A site as its neighbours know it.
struct Neighbour<'a> {
    point: &'a SurfacePoint,
    /// 1 / the harmonic mean of the lengths of its rays.
    nearness: f32,
}

/// The means at every site.
pub(super) fn smoothed(view: &View, sites: &Sites, found: &[Gathered]) -> Vec<Gathered> {
    let pixels_of_groups = sites.pixels_of_groups();
    let site = |site: usize| {
        let Some(group) = site.checked_sub(sites.pixel_count()) else {
            let point = sites.points[site].as_ref();
            let point = point.filter(|_| !sites.edges[site]);
            return point.map_or(found[site], |it| mean(view, sites, found, (site, site), it));
        };
        let pixel = pixels_of_groups[group] as usize;
        let samples = sites.samples.pixel(pixel);
        let samples = samples.expect("a pixel of an edge has samples");
        let representative = sites.group(group).representative;
        let point = seen_point(view, &samples[representative as usize]);
        point.map_or(found[site], |it| {
            mean(view, sites, found, (site, pixel), &it)
        })
    };
    let all = (0..found.len()).into_par_iter();
    all.with_min_len(SITES_A_TASK).map(site).collect()
}

/// The mean over a site in a pixel and the pixels around it that show one surface.
fn mean(
    view: &View,
    sites: &Sites,
    found: &[Gathered],
    (site, pixel): (usize, usize),
    point: &SurfacePoint,
) -> Gathered {
    let (width, height) = (view.camera.width as usize, view.camera.height as usize);
    let (x, y) = (pixel % width, pixel / width);
    let own = &found[site];
    let here = Neighbour {
        point,
        nearness: own.nearness,
    };
    let (mut sum, mut weights) = ([own.indirect, own.sky], 1.0);
    for row in y.saturating_sub(REACH_PX)..(y + REACH_PX + 1).min(height) {
        for column in x.saturating_sub(REACH_PX)..(x + REACH_PX + 1).min(width) {
            let other = row * width + column;
            let Some(point) = &sites.points[other] else {
                continue;
            };
            if other == site || sites.edges[other] {
                continue;
            }
            let there = Neighbour {
                point,
                nearness: found[other].nearness,
            };
            let weight = likeness(&here, &there);
            if weight > 0.0 {
                sum[0] += found[other].indirect * weight;
                sum[1] += found[other].sky * weight;
                weights += weight;
            }
        }
    }
    let [indirect, sky]: [Vec3; 2] = sum.map(|light| light / weights);
    Gathered {
        indirect,
        sky,
        glossy: own.glossy,
        nearness: own.nearness,
    }
}

/// 1 for the same point, falling to 0 where another one may be lit otherwise.
fn likeness(a: &Neighbour, b: &Neighbour) -> f32 {
    let nearness = a.nearness.at_least(b.nearness);
    let apart = (a.point.position - b.point.position).length() * nearness;
    // The chord of the angle.
    let turned = (a.point.normal - b.point.normal).length();
    let folded = (a.point.flat_normal - b.point.flat_normal).length();
    let off = apart / ALIKE_WITHIN + turned.at_least(folded) / NORMALS_WITHIN;
    (1.0 - off).at_least(0.0)
}
