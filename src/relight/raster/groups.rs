//! The surfaces among the samples of a pixel, so that shading runs once for
//! each of them and not once a sample.

use super::samples::{SAMPLE_COUNT, SAMPLE_OFFSETS};
use super::screen::Screen;
use super::triangle::Plane;
use super::{Fragment, RasterMesh, surface_of};
use crate::scene::PlacedCamera;

/// Samples that see one smooth surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct SurfaceGroup {
    /// The member to shade: the one closest to the members' mean place.
    pub(crate) representative: u32,
    /// Bit k is set if sample k is a member.
    pub(crate) members: u16,
}

/// The surfaces of a pixel, in the order of their first samples.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SurfaceGroups {
    groups: [SurfaceGroup; SAMPLE_COUNT],
    count: usize,
}

impl std::ops::Deref for SurfaceGroups {
    type Target = [SurfaceGroup];

    fn deref(&self) -> &[SurfaceGroup] {
        &self.groups[..self.count]
    }
}

/// Groups the samples of a pixel (column, row): one group holds the samples of
/// one side of one patch whose depths fit the plane of the group's first
/// sample. Samples that see nothing are in no group.
pub(crate) fn surface_groups(
    samples: &[Fragment; SAMPLE_COUNT],
    mesh: &RasterMesh,
    camera: &PlacedCamera,
    pixel: [u32; 2],
) -> SurfaceGroups {
    let view = PixelView {
        samples,
        mesh,
        screen: Screen::new(camera),
        pixel,
    };
    let mut groups = SurfaceGroups::default();
    let mut left = view.covered();
    while left != 0 {
        let members = view.members_with_first(left);
        left &= !members;
        groups.groups[groups.count] = SurfaceGroup {
            representative: most_central(members),
            members,
        };
        groups.count += 1;
    }
    groups
}

struct PixelView<'a> {
    samples: &'a [Fragment; SAMPLE_COUNT],
    mesh: &'a RasterMesh<'a>,
    screen: Screen,
    pixel: [u32; 2],
}

impl PixelView<'_> {
    /// Samples that see something.
    fn covered(&self) -> u16 {
        let bits = self.samples.iter().enumerate();
        bits.fold(0, |mask, (k, sample)| {
            mask | (u16::from(sample.is_covered()) << k)
        })
    }

    /// The samples among `candidates` (at least one) that lie on one surface
    /// with the first of them.
    fn members_with_first(&self, candidates: u16) -> u16 {
        let first = &self.samples[candidates.trailing_zeros() as usize];
        let surface = surface_of(first, self.mesh);
        // Not needed where all samples see one triangle, the usual case.
        let mut plane = None;
        let mut members = 0;
        for k in bits(candidates) {
            let sample = &self.samples[k];
            let is_member = sample.triangle == first.triangle
                || surface_of(sample, self.mesh) == surface && {
                    let plane = plane.get_or_insert_with(|| self.plane(first.triangle));
                    plane.is_some_and(|plane: Plane| self.holds(&plane, k))
                };
            members |= u16::from(is_member) << k;
        }
        members
    }

    fn plane(&self, triangle: u32) -> Option<Plane> {
        let corners = self.mesh.triangles[triangle as usize];
        let positions = corners.map(|corner| self.mesh.positions[corner as usize]);
        Plane::new(&positions.map(|position| self.screen.project(position)))
    }

    fn holds(&self, plane: &Plane, sample: usize) -> bool {
        let [x, y] = SAMPLE_OFFSETS[sample];
        plane.holds(
            f64::from(self.pixel[0]) + f64::from(x) - self.screen.half_width,
            f64::from(self.pixel[1]) + f64::from(y) - self.screen.half_height,
            1.0 / f64::from(self.samples[sample].depth),
            self.screen.depth_tolerance(),
        )
    }
}

/// The member closest to the mean place of all members, the first of equals.
fn most_central(members: u16) -> u32 {
    let count = members.count_ones() as f32;
    let mut mean = [0.0; 2];
    for k in bits(members) {
        mean[0] += SAMPLE_OFFSETS[k][0] / count;
        mean[1] += SAMPLE_OFFSETS[k][1] / count;
    }
    let mut best = (f32::INFINITY, 0);
    for k in bits(members) {
        let [x, y] = SAMPLE_OFFSETS[k];
        let distance = (x - mean[0]) * (x - mean[0]) + (y - mean[1]) * (y - mean[1]);
        if distance < best.0 {
            best = (distance, k as u32);
        }
    }
    best.1
}

/// Positions of the set bits, ascending.
fn bits(mask: u16) -> impl Iterator<Item = usize> {
    (0..SAMPLE_COUNT).filter(move |&k| mask >> k & 1 == 1)
}
