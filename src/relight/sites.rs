//! What a picture shades, as far as lights have no say in it: one site a pixel
//! that shows one surface, one for each surface of the others.

use super::frame::Effort;
use super::geometry::Geometry;
use super::raster::{
    CenterBuffer, Fragment, SampleBuffer, SurfaceGroup, edge_pixels, rasterize, rasterize_samples,
    surface_groups,
};
use super::reach::{SeenPoints, seen_points};
use super::shade::View;
use super::stages::Stages;
use crate::scene::{PlacedCamera, PlacedRectangle};

/// The sites of one view of one mesh. Number of a site: that of its pixel (row by
/// row) where the pixel shows one surface; beyond them those of the other pixels'
/// surfaces.
pub(super) struct Sites {
    made_for: (PlacedCamera, Vec<PlacedRectangle>, Effort),
    pub(super) geometry: Geometry,
    /// What the pixels' centres see, and the points of the mesh among it.
    pub(super) centers: CenterBuffer,
    pub(super) points: SeenPoints,
    /// Pixels of more than one surface, and their samples. None in a draft.
    pub(super) edges: Vec<bool>,
    pub(super) samples: SampleBuffer,
    /// Surfaces of the pixels in `samples`, those of pixel k from `starts[k]` on.
    groups: Vec<SurfaceGroup>,
    starts: Vec<u32>,
}

impl Sites {
    /// What a view shades; a draft takes every pixel for what its centre sees.
    /// `None` if it was stopped.
    pub(super) fn of(
        view: &View,
        stages: &mut Stages,
        go_on: &dyn Fn() -> Option<()>,
    ) -> Option<Self> {
        let geometry = Geometry::new(view.surface, &view.lights.rectangles);
        let mesh = geometry.mesh();
        let centers = stages.time("raster", || rasterize(&view.camera, &mesh));
        go_on()?;
        let edges = match view.effort {
            Effort::Draft => vec![false; centers.fragments.len()],
            Effort::Full => stages.time("edges", || edge_pixels(&view.camera, &mesh, &centers)),
        };
        go_on()?;
        let points = stages.time("points", || seen_points(view, &centers));
        go_on()?;
        let samples = stages.time("samples", || samples_of(view, &geometry, &edges));
        let (mut groups, mut starts) = (Vec::new(), vec![0]);
        let width = view.camera.width as usize;
        for pixel in (0..edges.len()).filter(|&pixel| edges[pixel]) {
            let at = [(pixel % width) as u32, (pixel / width) as u32];
            let samples = samples
                .pixel(pixel)
                .expect("a pixel of an edge has samples");
            groups.extend_from_slice(&surface_groups(samples, &mesh, &view.camera, at));
            starts.push(groups.len() as u32);
        }
        let rectangles = view.lights.rectangles.clone();
        Some(Self {
            made_for: (view.camera, rectangles, view.effort),
            geometry,
            centers,
            points,
            edges,
            samples,
            groups,
            starts,
        })
    }

    /// Whether a view shades just these.
    pub(super) fn serve(&self, view: &View) -> bool {
        let (camera, rectangles, effort) = &self.made_for;
        *camera == view.camera && *rectangles == view.lights.rectangles && *effort == view.effort
    }

    pub(super) fn pixel_count(&self) -> usize {
        self.edges.len()
    }

    /// All sites, also those of pixels that have others in their place.
    pub(super) fn len(&self) -> usize {
        self.pixel_count() + self.groups.len()
    }

    /// The surfaces of a pixel of more than one, each with the number of its site.
    pub(super) fn groups(&self, pixel: usize) -> impl Iterator<Item = (usize, SurfaceGroup)> {
        let place = self.samples.index[pixel] as usize;
        let range = self.starts[place] as usize..self.starts[place + 1] as usize;
        range.map(|group| (self.pixel_count() + group, self.groups[group]))
    }

    /// The pixel of every surface beyond the pixels' own sites.
    pub(super) fn pixels_of_groups(&self) -> Vec<u32> {
        let edges = (0..self.edges.len()).filter(|&pixel| self.edges[pixel]);
        let counts = self.starts.windows(2).map(|pair| pair[1] - pair[0]);
        let repeated = edges
            .zip(counts)
            .flat_map(|(pixel, count)| std::iter::repeat_n(pixel as u32, count as usize));
        repeated.collect()
    }

    /// A surface by its place behind the pixels' own sites.
    pub(super) fn group(&self, index: usize) -> SurfaceGroup {
        self.groups[index]
    }
}

/// Samples of the marked pixels; no work where there are none.
pub(super) fn samples_of(view: &View, geometry: &Geometry, pixels: &[bool]) -> SampleBuffer {
    if pixels.contains(&true) {
        return rasterize_samples(&view.camera, &geometry.mesh(), pixels);
    }
    SampleBuffer {
        index: vec![super::raster::NONE; pixels.len()],
        samples: Vec::new(),
    }
}

/// The samples that belong to a surface.
pub(super) fn members(
    group: SurfaceGroup,
    samples: &[Fragment; 16],
) -> impl Iterator<Item = &Fragment> + Clone {
    (0..16)
        .filter(move |k| group.members >> k & 1 == 1)
        .map(move |k| &samples[k])
}
