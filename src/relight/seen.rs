//! Which material each pixel of a picture shows, and how far away.

use super::sites::Sites;
use crate::surface::Surface;

/// What the centres of a picture's pixels show, row 0 on top.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SeenSurfaces {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Index of the material in the scene, a pixel each; `None` where no surface
    /// of the mesh is seen.
    pub materials: Vec<Option<u32>>,
    /// Distance along the view axis, scene units; infinite where nothing is seen.
    pub depths: Vec<f32>,
}

impl SeenSurfaces {
    pub(super) fn of(sites: &Sites, surface: &Surface) -> Self {
        let fragments = &sites.centers.fragments;
        let material = |triangle: u32| {
            let triangle = surface.mesh.triangles.get(triangle as usize);
            triangle.map(|triangle| triangle.material)
        };
        let scale = surface.placement.scale;
        Self {
            size: [sites.centers.width, sites.centers.height],
            materials: fragments.iter().map(|f| material(f.triangle)).collect(),
            depths: fragments
                .iter()
                .map(|f| (f64::from(f.depth) / scale) as f32)
                .collect(),
        }
    }
}
