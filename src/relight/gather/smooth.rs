//! What the rays of neighbouring pixels found, for a pixel too.
//!
//! A patch of sun seen from the other end of a room is met by one ray in a hundred,
//! and 256 rays leave grain there. The points of neighbours complete one another, so
//! a fit to some pixels has next to none of it; it is made to those to which
//! all that sends light is so far away that it looks the same from there: by the
//! harmonic mean of the rays' lengths (Ward, Rubinstein and Clear, "A Ray Tracing
//! Solution for Diffuse Interreflection", 1988). In a corner the other wall is near to
//! all pixels, and none would be alike; where few rays bring most of the light, what is
//! far is therefore taken as if nothing were nearer than where far begins.

use glam::Vec3;
use rayon::prelude::*;

use super::{Gathered, SITES_A_TASK};
use crate::maths::order::Order;
use crate::relight::reach::seen_point;
use crate::relight::shade::View;
use crate::relight::sites::Sites;
use crate::scene::max_component;
use crate::surface::SurfacePoint;

/// Pixels either way that are taken together. In a room with a patch of sun
/// (`window/day.toml`, 320 x 240) pixels are full of grain without; the error of 8 x 8
/// means falls from 0.277 % to 0.262 %, and in the same room by a lamp from 0.192 % to
/// 0.17 %. Farther would blur more for nothing: a tile has 16 pixels. Far is counted in
/// pixels too: of 240 x 180 so much of the room is near that its corners keep grain.
const REACH_PX: usize = 4;
/// Distance of two points, share of the harmonic mean of the lengths of their rays, up
/// to which they are taken for one another: there weights end, and so does the detail
/// that is kept where surfaces meet.
const ALIKE_WITHIN: f32 = 0.1;
/// The same of the angle between their normals, as a share of a radian.
const NORMALS_WITHIN: f32 = 0.1;

/// Keeps a plane level where its points do not say how it leans, square pixels: a
/// thousandth of what the pixels of one side have together.
const LEVELLING: f32 = 0.01;
/// Difference of the shares of far rays of two points, up to which they are taken for
/// one another: along a wall it is some 0.05 over the reach, below a thing that stands
/// on a floor it is 0.2 from one pixel to the next.
const OPEN_WITHIN: f32 = 0.15;
/// Mean square of the radiance of rays over their squared mean up to which nothing of
/// it is grain, and from which on all is. With 3 and 6 the corners of that room by sun
/// are smooth; where every pixel took the mean of all that is far, things in between
/// lost their shadows by a lamp (8 x 8: 0.30 % instead of 0.17 %).
const BY_ALL: f32 = 3.0;
/// See [`BY_ALL`].
const BY_FEW: f32 = 6.0;

/// Length of rays in placed units from which on what they bring would look the same
/// from all pixels that are taken together, of a surface that faces the eye.
pub(super) fn reach(view: &View, from: &SurfacePoint) -> f32 {
    let eye = view.camera.eye.as_vec3();
    let pixel = view.camera.right.length() as f32 * from.position.distance(eye);
    (pixel * REACH_PX as f32 / ALIKE_WITHIN).at_least(f32::MIN_POSITIVE)
}

/// Share of what a ray brings that counts as far: 0 up to the reach, 1 from twice of
/// it on; from reach / length.
pub(super) fn far_share(reaches: f32) -> f32 {
    (1.0 / reaches.at_least(f32::MIN_POSITIVE) - 1.0)
        .at_least(0.0)
        .at_most(1.0)
}

/// What every site has found together with its neighbours.
pub(super) fn smoothed(view: &View, sites: &Sites, found: &[Gathered]) -> Vec<Gathered> {
    let field = Field::of(view, sites, found);
    let all = (0..found.len()).into_par_iter();
    all.with_min_len(SITES_A_TASK)
        .map(|site| field.smoothed(site))
        .collect()
}

/// What was found at the sites of a picture, and where they are.
struct Field<'a> {
    size: [usize; 2],
    sites: &'a Sites,
    found: &'a [Gathered],
    /// Of the sites beyond the pixels' own.
    pixels_of_groups: Vec<u32>,
    points_of_groups: Vec<Option<SurfacePoint>>,
}

impl<'a> Field<'a> {
    fn of(view: &View, sites: &'a Sites, found: &'a [Gathered]) -> Self {
        let pixels_of_groups = sites.pixels_of_groups();
        let groups = pixels_of_groups.par_iter().enumerate();
        let points_of_groups = groups
            .map(|(group, &pixel)| {
                let samples = sites.samples.pixel(pixel as usize);
                let samples = samples.expect("a pixel of an edge has samples");
                seen_point(view, &samples[sites.group(group).representative as usize])
            })
            .collect();
        Self {
            size: [view.camera.width, view.camera.height].map(|it| it as usize),
            sites,
            found,
            pixels_of_groups,
            points_of_groups,
        }
    }

    /// Where a site is on the mesh.
    fn point(&self, site: usize) -> Option<&SurfacePoint> {
        match site.checked_sub(self.sites.pixel_count()) {
            None => self.sites.points[site].as_ref(),
            Some(group) => self.points_of_groups[group].as_ref(),
        }
    }

    fn pixel(&self, site: usize) -> usize {
        let group = site.checked_sub(self.sites.pixel_count());
        group.map_or(site, |group| self.pixels_of_groups[group] as usize)
    }

    /// What a site and those of the pixels around it that are alike have found.
    fn smoothed(&self, site: usize) -> Gathered {
        let own = &self.found[site];
        let Some(point) = self.point(site) else {
            return *own;
        };
        let pixel = self.pixel(site);
        let is_edge = self.sites.edges[pixel];
        if is_edge && site == pixel {
            return *own;
        }
        let [width, height] = self.size;
        let (x, y) = (pixel % width, pixel / width);
        let mut all = Plane::through([own.near, own.far, own.sky]);
        let mut wide = Plane::through([own.far, own.sky]);
        let mut spreads = [own.of_far, own.of_sky];
        for row in y.saturating_sub(REACH_PX)..(y + REACH_PX + 1).min(height) {
            for column in x.saturating_sub(REACH_PX)..(x + REACH_PX + 1).min(width) {
                let other = row * width + column;
                let there = self.point(other).filter(|_| other != site);
                let Some(there) = there.filter(|_| !self.sites.edges[other]) else {
                    continue;
                };
                let found = &self.found[other];
                let apart = Apart::of(point, there);
                let offset = [column as f32 - x as f32, row as f32 - y as f32];
                let likeness = apart.likeness([own.nearness, found.nearness]);
                all.add(likeness, offset, [found.near, found.far, found.sky]);
                let likeness = apart.likeness([own.nearness_of_far, found.nearness_of_far])
                    * likeness_of_open([own, found].map(|it| it.of_far.rays));
                wide.add(likeness, offset, [found.far, found.sky]);
                spreads[0].join(found.of_far.times(likeness));
                spreads[1].join(found.of_sky.times(likeness));
            }
        }
        let [near, far, sky] = all.value();
        let [wide_far, wide_sky] = wide.value();
        let [few_far, few_sky] = spreads.map(|it| it.by_few());
        Gathered {
            near,
            far: far + (wide_far - far) * few_far,
            sky: sky + (wide_sky - sky) * few_sky,
            ..*own
        }
    }
}

/// Values at pixels around one, by weighted least squares a linear function of the
/// offset (first-order regression: Bitterli et al., "Nonlinearly Weighted First-order
/// Regression for Denoising Monte Carlo Renderings", 2016): a mean would take those of
/// one side alone at the end of a surface.
struct Plane<const N: usize> {
    /// Sums of the weight, and of it times x, y, xx, xy and yy.
    weight: f32,
    first: [f32; 2],
    second: [f32; 3],
    /// Sums of the values by weight, and by it times x and y.
    values: [[Vec3; 3]; N],
}

impl<const N: usize> Plane<N> {
    /// Of a value at the pixel itself.
    fn through(values: [Vec3; N]) -> Self {
        Self {
            weight: 1.0,
            first: [0.0; 2],
            second: [LEVELLING, 0.0, LEVELLING],
            values: values.map(|value| [value, Vec3::ZERO, Vec3::ZERO]),
        }
    }

    fn add(&mut self, weight: f32, [x, y]: [f32; 2], values: [Vec3; N]) {
        if weight <= 0.0 {
            return;
        }
        self.weight += weight;
        self.first[0] += weight * x;
        self.first[1] += weight * y;
        self.second[0] += weight * x * x;
        self.second[1] += weight * x * y;
        self.second[2] += weight * y * y;
        for (sums, value) in self.values.iter_mut().zip(values) {
            sums[0] += value * weight;
            sums[1] += value * (weight * x);
            sums[2] += value * (weight * y);
        }
    }

    /// The plane at the pixel itself, not below zero unless the mean is.
    fn value(self) -> [Vec3; N] {
        let ([x, y], [xx, xy, yy]) = (self.first, self.second);
        // The first row of the inverse of [[w, x, y], [x, xx, xy], [y, xy, yy]].
        let row = [xx * yy - xy * xy, y * xy - x * yy, x * xy - y * xx];
        let determinant = self.weight * row[0] + x * row[1] + y * row[2];
        let row = row.map(|entry| entry / determinant);
        self.values.map(|[a, b, c]| {
            let plane = a * row[0] + b * row[1] + c * row[2];
            // Beyond its points a plane may fall below any of them.
            let lowest = a / self.weight;
            Vec3::from_array(std::array::from_fn(|i| {
                plane[i].at_least(lowest[i].at_most(0.0))
            }))
        })
    }
}

/// How the radiance of far rays is spread over them: sums of their number, of the
/// largest component of what they bring, and of its square.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Moments {
    rays: f32,
    first: f32,
    second: f32,
}

impl Moments {
    /// Adds a ray, of which so much counts as far.
    pub(super) fn add(&mut self, radiance: Vec3, far: f32) {
        let radiance = max_component(radiance);
        self.join(Self {
            rays: far,
            first: far * radiance,
            second: far * radiance * radiance,
        });
    }

    fn join(&mut self, other: Self) {
        self.rays += other.rays;
        self.first += other.first;
        self.second += other.second;
    }

    pub(super) fn times(self, factor: f32) -> Self {
        Self {
            rays: self.rays * factor,
            first: self.first * factor,
            second: self.second * factor,
        }
    }

    /// 0 where all rays bring some of the light, 1 where few bring most of it.
    fn by_few(self) -> f32 {
        let squared = (self.first * self.first).at_least(f32::MIN_POSITIVE);
        let peaked = self.second * self.rays / squared;
        ((peaked - BY_ALL) / (BY_FEW - BY_ALL))
            .at_least(0.0)
            .at_most(1.0)
    }
}

/// 1 where as much of what is far is open to two points, falling to 0 where something
/// near hides more of it from one of them.
fn likeness_of_open([a, b]: [f32; 2]) -> f32 {
    (1.0 - (a - b).abs() / OPEN_WITHIN).at_least(0.0)
}

/// How two points differ.
struct Apart {
    /// Placed units.
    distance: f32,
    /// Chord of the angle between their normals.
    turned: f32,
}

impl Apart {
    fn of(a: &SurfacePoint, b: &SurfacePoint) -> Self {
        let turned = (a.normal - b.normal).length();
        let folded = (a.flat_normal - b.flat_normal).length();
        Self {
            distance: (a.position - b.position).length(),
            turned: turned.at_least(folded),
        }
    }

    /// 1 for the same point, falling to 0 where another one may be lit otherwise, by
    /// what is so near to both.
    fn likeness(&self, [a, b]: [f32; 2]) -> f32 {
        let apart = self.distance * a.at_least(b);
        let off = apart / ALIKE_WITHIN + self.turned / NORMALS_WITHIN;
        (1.0 - off).at_least(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a plane makes of a function of the offset by some pixels around.
    fn found(offsets: &[[f32; 2]], value: impl Fn([f32; 2]) -> f32) -> f32 {
        let mut plane = Plane::through([Vec3::splat(value([0.0; 2]))]);
        for &offset in offsets {
            plane.add(0.5, offset, [Vec3::splat(value(offset))]);
        }
        plane.value()[0].y
    }

    #[test]
    fn light_that_grows_evenly_is_kept_at_the_end_of_a_surface() {
        let right: Vec<[f32; 2]> = (0..25)
            .map(|i| [(i % 5) as f32, (i / 5) as f32 - 2.0])
            .filter(|offset| *offset != [0.0; 2])
            .collect();
        let leaning = |[x, y]: [f32; 2]| 1.0 + 0.25 * x - 0.5 * y;
        // Levelling costs a ten thousandth of the lean.
        assert!((found(&right, leaning) - 1.0).abs() < 1e-3);
        // The mean of what is there is another.
        let mean = right.iter().copied().map(leaning).sum::<f32>() / right.len() as f32;
        assert!(mean > 1.4);
    }

    #[test]
    fn one_neighbour_or_none_changes_nothing_and_no_fit_falls_below_zero() {
        assert_eq!(found(&[], |_| 3.0), 3.0);
        let steep = |[x, _]: [f32; 2]| if x > 2.0 { 1.0 } else { 0.0 };
        assert!(found(&[[3.0, 0.0]], steep) < 0.01);
        // The line through 0, 0, 0, 1, 1 is -0.1 or so at its end.
        let ahead = [1.0, 2.0, 3.0, 4.0].map(|x| [x, 0.0]);
        assert_eq!(found(&ahead, steep), 0.0);
        let rings = found(&ahead, |_| -1.0);
        assert!((rings + 1.0).abs() < 1e-5, "what rings is left: {rings}");
    }

    #[test]
    fn light_by_few_rays_is_told_from_light_by_all() {
        let of = |rays: &[f32], far: f32| {
            let mut moments = Moments::default();
            for &radiance in rays {
                moments.add(Vec3::splat(radiance), far);
            }
            moments
        };
        let even = [1.0; 100];
        let mut patch = even;
        patch[7] = 50.0;
        assert_eq!(of(&even, 1.0).by_few(), 0.0);
        assert_eq!(of(&[0.0; 4], 1.0).by_few(), 0.0);
        assert_eq!(of(&patch, 1.0).by_few(), 1.0);
        // A pixel whose rays missed the patch is told by its neighbours.
        let mut missed = of(&even, 1.0);
        missed.join(of(&patch, 1.0));
        assert_eq!(missed.by_few(), 1.0);
        // A gap through which few rays pass is none: those that pass are alike.
        let mut gap = of(&even[..5], 1.0);
        gap.join(of(&[0.0; 95], 0.0));
        assert_eq!(gap.by_few(), 0.0);
    }

    #[test]
    fn a_ray_is_far_from_twice_the_reach_on() {
        let shares = [f32::INFINITY, 2.0, 1.0, 2.0 / 3.0, 0.5, 0.25, 0.0].map(far_share);
        assert_eq!(shares[..3], [0.0; 3]);
        assert!((shares[3] - 0.5).abs() < 1e-6);
        assert_eq!(shares[4..], [1.0; 3]);
    }
}
