//! Maps on surfaces: what they are on average, and that tiles of an atlas keep
//! to themselves. Read through scene, MTL and image files.

use glam::Vec3;

use super::{Deviation, at_most, frame_of, largest};
use crate::maths::sobol::ScrambledSobol;
use crate::relight::Component;
use crate::relight::vertex_albedo;
use crate::scene::Scene;
use crate::scene::sample_scenes::{scene_of_files, tga};
use crate::surface::{Detail, Surface};
use crate::texture::TextureFilter;

/// Mean of a picture against Kd x mean colour.
const PICTURE_MEAN: f64 = 2e-3;
/// Mean over a vertex's hat of fields far smaller than it, and of any fields
/// over all vertices.
const VERTEX: f64 = 0.01;
/// One vertex on fields of its own size, black or white: the borders of fields
/// that run through its 64 pieces; measured 0.112.
const VERTEX_OF_COARSE: f64 = 0.15;
/// The same, root mean square.
const VERTEX_OF_COARSE_RMS: f64 = 0.03;
/// Colour of another tile in a pixel: none, beyond an unused border of one texel.
/// (Of half a texel, where bilinear interpolation ends, 0.15 % is left at 0.75
/// texels a pixel: samples at the seam stand for an eighth of a pixel beyond it.)
const BLEED: f64 = 1e-6;
/// ... and in a vertex, whose pieces lie across the seam by half their width:
/// share of the tile's own colour at the vertices on the seam.
const VERTEX_BLEED: f64 = 0.1;
/// Points of a vertex's area in the mean that a vertex should have.
const MANY_POINTS: u32 = 1 << 14;

/// A floor of 2 m seen from straight above by a camera that shows all of it.
const TOML: &str = "mesh = \"a.obj\"\n[camera]\nposition = [0, 1, 0]\ntarget = [0, 0, 0]\n\
                    up = [0, 0, -1]\nvfov = 90\nsize = [40, 40]\n[bake]\nmax_edge = 0.25\nrays = 64\n";
const FLOOR: &str = "mtllib a.mtl\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\n\
                     vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl floor\nf 1/1 2/2 3/3 4/4\n";
const KD: Vec3 = Vec3::new(0.8, 0.4, 0.2);

fn scene(filter: TextureFilter, mesh: &str, image: &[u8]) -> Scene {
    let name = match filter {
        TextureFilter::Bilinear => "bilinear",
        TextureFilter::Nearest => "nearest",
    };
    let toml = format!("texture_filter = \"{name}\"\n{TOML}");
    let mtl = "newmtl floor\nKd 0.8 0.4 0.2\nmap_Kd a.tga\n";
    scene_of_files(&[
        ("s.toml", toml.as_bytes()),
        ("a.obj", mesh.as_bytes()),
        ("a.mtl", mtl.as_bytes()),
        ("a.tga", image),
    ])
}

/// A checker of so many fields a side, a texel each, white at the lower left.
fn checker(fields: u16) -> Vec<u8> {
    tga([fields; 2], |x, y| [255 * ((x + y) % 2) as u8; 3])
}

const FILTERS: [TextureFilter; 2] = [TextureFilter::Bilinear, TextureFilter::Nearest];

#[test]
fn a_picture_of_a_checker_has_its_mean() {
    for (filter, fields) in FILTERS
        .into_iter()
        .flat_map(|f| [8, 30, 256].map(|n| (f, n)))
    {
        let scene = scene(filter, FLOOR, &checker(fields));
        let image = frame_of(&scene, Component::Albedo);
        let mean = image
            .pixels()
            .iter()
            .map(|p| p.as_dvec3())
            .sum::<glam::DVec3>()
            / 1600.0;
        let off = (mean / (KD.as_dvec3() * 0.5) - 1.0).abs().max_element();
        let what = format!("picture of {fields} fields, {filter:?}, mean");
        at_most(&what, off, PICTURE_MEAN);
    }
}

/// Albedo of the vertices of a scene, and the surface.
fn at_vertices(scene: &Scene) -> (Surface, Vec<Vec3>) {
    let surface = Surface::fronts(scene, &Detail::of_keys(&scene.bake));
    let albedo = vertex_albedo(scene, &surface);
    (surface, albedo)
}

#[test]
fn bounced_light_sees_the_mean_of_a_map() {
    // Fine: every vertex sees the mean of the whole.
    let (_, fine) = at_vertices(&scene(TextureFilter::Bilinear, FLOOR, &checker(256)));
    let off = fine.iter().map(|a| f64::from((a.x / 0.4 - 1.0).abs()));
    at_most("vertices on 256 fields", largest(off), VERTEX);
    // Coarse: fields of 0.25 m, as long as the edges.
    let (surface, coarse) = at_vertices(&scene(TextureFilter::Nearest, FLOOR, &checker(8)));
    let wanted = |vertex: usize| {
        let points = ScrambledSobol::new(3, vertex as u32);
        let white = |k: &u32| {
            let placed = surface.sample_point(vertex, points.point2(*k)).position;
            let place = surface.placement.file_from_placed(placed);
            let field = |x: f64| ((x + 1.0) * 4.0).floor() as i64;
            // The lowest row of the image is the nearest to the viewer, z = 1;
            // its first texel is (0, 7).
            (field(place.x) + field(place.z)) % 2 != 0
        };
        (0..MANY_POINTS).filter(white).count() as f64 / f64::from(MANY_POINTS)
    };
    let areas = surface.vertices.areas();
    let found = Deviation::of((0..coarse.len()).map(|v| {
        let weight = f64::from(areas[v]);
        (weight, f64::from(coarse[v].x) / 0.8, wanted(v))
    }));
    let what = "vertices on 8 fields";
    at_most(&format!("{what}, mean"), found.mean.abs(), VERTEX);
    at_most(&format!("{what}, rms"), found.rms, VERTEX_OF_COARSE_RMS);
    at_most(&format!("{what}, worst"), found.worst, VERTEX_OF_COARSE);
}

/// Two halves of the floor: the left one shows the first of four tiles of the
/// image, the right one the last; `inset` texels of 16 stay unused at the tiles'
/// borders.
fn atlas(filter: TextureFilter, inset: f64) -> Scene {
    let at = |texel: f64| texel / 64.0;
    let u = [inset, 16.0 - inset, 48.0 + inset, 64.0 - inset].map(at);
    let mesh = format!(
        "mtllib a.mtl\nv -1 0 1\nv 0 0 1\nv 0 0 -1\nv -1 0 -1\nv 1 0 1\nv 1 0 -1\n\
         vt {} 0\nvt {} 0\nvt {} 1\nvt {} 1\nvt {} 0\nvt {} 0\nvt {} 1\nvt {} 1\n\
         usemtl floor\nf 1/1 2/2 3/3 4/4\nf 2/5 5/6 6/7 3/8\n",
        u[0], u[1], u[1], u[0], u[2], u[3], u[3], u[2]
    );
    let image = tga([64, 16], |x, _| match x / 16 {
        0 => [255, 0, 0],
        3 => [0, 255, 0],
        _ => [0, 0, 255],
    });
    scene(filter, &mesh, &image)
}

#[test]
fn tiles_of_an_atlas_do_not_bleed_into_pixels() {
    for (filter, inset) in [
        (TextureFilter::Bilinear, 1.0),
        (TextureFilter::Nearest, 0.5),
    ] {
        // 40 columns: the seam between two; 41: within one.
        for size in [[40, 40], [41, 40], [200, 200]] {
            let mut scene = atlas(filter, inset);
            scene.camera.size = size;
            scene.camera.target.x = 1e-3;
            let image = frame_of(&scene, Component::Albedo);
            let blue = image.pixels().iter().map(|p| f64::from(p.z));
            let what = format!("atlas, {filter:?}, {size:?}, other tiles");
            at_most(&what, largest(blue), BLEED);
            let [red, green] = [0, 1].map(|channel| {
                let sum: f32 = image
                    .pixels()
                    .iter()
                    .map(|p| p[channel] / KD[channel])
                    .sum();
                f64::from(sum) / image.pixels().len() as f64
            });
            assert!((red - 0.5).abs() < 0.02, "{red} of the picture is red");
            assert!((green - 0.5).abs() < 0.02, "{green} of it is green");
        }
    }
}

#[test]
fn tiles_of_an_atlas_hardly_bleed_into_vertices() {
    for (filter, inset) in [
        (TextureFilter::Bilinear, 1.0),
        (TextureFilter::Nearest, 0.5),
    ] {
        let (surface, albedo) = at_vertices(&atlas(filter, inset));
        let own = |v: usize| {
            let x = surface
                .placement
                .file_from_placed(surface.vertices.positions()[v])
                .x;
            x.abs() > 0.01 && x.abs() < 0.99
        };
        let blue = |v: usize| f64::from(albedo[v].z / KD.z);
        let worst = |inner: bool| {
            let which = (0..albedo.len()).filter(|&v| own(v) == inner);
            largest(which.map(blue))
        };
        let what = format!("atlas, {filter:?}, other tiles at vertices");
        at_most(&format!("{what} inside"), worst(true), VERTEX);
        at_most(&format!("{what} on the seam"), worst(false), VERTEX_BLEED);
    }
}
