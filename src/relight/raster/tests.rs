//! The tiles against brute force, and against closed forms.

use glam::{DVec3, Vec3};

use super::centers::fragment_by_brute_force;
use super::samples::SAMPLE_COUNT;
use super::samples::SAMPLE_OFFSETS;
use super::screen::Screen;
use super::triangle::TriangleSetup;
use super::*;
use crate::maths::hash::{hash3, uniform};
use crate::maths::order::Order;
use crate::scene::{Camera, PlacedCamera, Placement};

/// A mesh that owns what a [`RasterMesh`] borrows.
#[derive(Default)]
pub(super) struct TestMesh {
    pub(super) positions: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) patches: Vec<u32>,
    pub(super) edges: Vec<MeshEdge>,
}

impl TestMesh {
    pub(super) fn view(&self) -> RasterMesh<'_> {
        RasterMesh {
            positions: &self.positions,
            triangles: &self.triangles,
            patches: &self.patches,
            edges: &self.edges,
        }
    }

    /// Triangles with corners of their own, each a patch.
    fn soup(corners: &[[Vec3; 3]]) -> Self {
        let mut mesh = Self::default();
        for (k, corners) in corners.iter().enumerate() {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(corners);
            mesh.triangles.push([first, first + 1, first + 2]);
            mesh.patches.push(k as u32);
        }
        mesh
    }

    /// Adds a parallelogram of `cells` x `cells` squares as one patch.
    fn add_sheet(&mut self, corner: Vec3, u: Vec3, v: Vec3, cells: u32) {
        let patch = self.patches.last().map_or(0, |patch| patch + 1);
        let first = self.positions.len() as u32;
        let at = |k: u32| k as f32 / cells as f32;
        for j in 0..=cells {
            for i in 0..=cells {
                self.positions.push(corner + u * at(i) + v * at(j));
            }
        }
        for j in 0..cells {
            for i in 0..cells {
                let a = first + j * (cells + 1) + i;
                let c = a + cells + 1;
                self.triangles.push([a, a + 1, c + 1]);
                self.triangles.push([a, c + 1, c]);
                self.patches.extend([patch; 2]);
            }
        }
    }

    /// Adds a box whose six sides are patches of their own.
    pub(super) fn add_box(&mut self, corner: Vec3, u: Vec3, v: Vec3, w: Vec3, cells: u32) {
        for (corner, u, v) in [
            (corner, v, u),
            (corner + w, u, v),
            (corner, w, v),
            (corner + u, v, w),
            (corner, u, w),
            (corner + v, w, u),
        ] {
            self.add_sheet(corner, u, v, cells);
        }
    }

    /// Fills in the edges: one between two triangles of a patch that share
    /// corners, creases elsewhere.
    pub(super) fn find_edges(&mut self) {
        let mut sides: Vec<([u32; 2], u32)> = Vec::new();
        for (k, triangle) in self.triangles.iter().enumerate() {
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let mut corners = [triangle[a], triangle[b]];
                corners.sort_unstable();
                sides.push((corners, k as u32));
            }
        }
        sides.sort_unstable();
        for pair in sides.chunk_by(|a, b| a.0 == b.0) {
            let second = pair.get(1).map_or(NONE, |side| side.1);
            self.edges.push(MeshEdge {
                corners: pair[0].0,
                triangles: [pair[0].1, second],
                crease: second == NONE,
            });
        }
    }
}

/// A camera at a point, in placed units, that looks along a direction.
pub(super) fn camera(
    position: DVec3,
    direction: DVec3,
    vfov_deg: f64,
    size: [u32; 2],
) -> PlacedCamera {
    let placement = Placement {
        center: DVec3::ZERO,
        scale: 1.0,
        extent: 1.0,
    };
    let up = if direction.y.abs() > 0.9 * direction.length() {
        DVec3::X
    } else {
        DVec3::Y
    };
    let target = position + direction;
    Camera {
        position,
        target,
        up,
        vfov_deg,
        size,
    }
    .place(&placement)
}

fn setups(camera: &PlacedCamera, mesh: &TestMesh) -> Vec<Option<TriangleSetup>> {
    let screen = Screen::new(camera);
    let corners = screen.project_all(&mesh.positions);
    let setup = |triangle: &[u32; 3]| TriangleSetup::new(triangle.map(|k| corners[k as usize]));
    mesh.triangles.iter().map(setup).collect()
}

/// Fragments at one place of every pixel, by asking every triangle.
fn brute_force(camera: &PlacedCamera, mesh: &TestMesh, offset: [f32; 2]) -> Vec<Fragment> {
    let setups = setups(camera, mesh);
    let mut fragments = Vec::new();
    for y in 0..camera.height {
        for x in 0..camera.width {
            let x = f64::from(x) + f64::from(offset[0]) - 0.5 * f64::from(camera.width);
            let y = f64::from(y) + f64::from(offset[1]) - 0.5 * f64::from(camera.height);
            fragments.push(fragment_by_brute_force(&setups, x, y));
        }
    }
    fragments
}

/// The tiles must give the bits of brute force, at centres and samples.
fn assert_equals_brute_force(camera: &PlacedCamera, mesh: &TestMesh) {
    let centers = rasterize(camera, &mesh.view());
    assert!(
        centers.fragments == brute_force(camera, mesh, [0.5, 0.5]),
        "centres differ"
    );
    let pixel_count = centers.fragments.len();
    let mask: Vec<bool> = (0..pixel_count as u32)
        .map(|k| hash3(5, k, 0).is_multiple_of(3))
        .collect();
    let buffer = rasterize_samples(camera, &mesh.view(), &mask);
    for (k, offset) in SAMPLE_OFFSETS.iter().enumerate() {
        let expected = brute_force(camera, mesh, *offset);
        for pixel in 0..pixel_count {
            let actual = buffer.pixel(pixel).map(|samples| samples[k]);
            let expected = mask[pixel].then_some(expected[pixel]);
            assert_eq!(actual, expected, "sample {k} of pixel {pixel}");
        }
    }
}

pub(super) fn random_point(seed: u32, index: u32, spread: f32) -> Vec3 {
    let coordinate = |axis| (uniform(seed, index, axis) - 0.5) * spread;
    Vec3::new(coordinate(0), coordinate(1), coordinate(2))
}

/// Triangles of many sizes about a camera in their middle: through its plane,
/// behind it, huge, tiny, slivers, points and lines.
fn random_soup(seed: u32) -> TestMesh {
    let mut corners = Vec::new();
    for k in 0..60 {
        let center = random_point(seed, 4 * k, 1.0);
        let size = [2.0, 0.5, 0.1, 0.01, 1e-4][(k % 5) as usize];
        let mut triangle = [1, 2, 3].map(|c| center + random_point(seed, 4 * k + c, size));
        match k % 12 {
            7 => triangle[2] = triangle[1],
            8 => triangle[2] = (triangle[0] + triangle[1]) * 0.5,
            9 => triangle = [triangle[0]; 3],
            10 => triangle[2] = triangle[1] + (triangle[0] - triangle[1]) * 1e-4,
            _ => {}
        }
        corners.push(triangle);
    }
    corners.push([Vec3::splat(f32::NAN), Vec3::X, Vec3::Y]);
    corners.push([Vec3::X, Vec3::splat(f32::INFINITY), Vec3::Y]);
    TestMesh::soup(&corners)
}

#[test]
fn tiles_have_the_bits_of_brute_force() {
    let mut covered = 0;
    for seed in 0..24 {
        let mesh = random_soup(seed);
        let eye = random_point(seed, 1000, 0.4).as_dvec3();
        let direction = random_point(seed, 1001, 1.0).as_dvec3();
        let vfov_deg = [20.0, 60.0, 110.0, 165.0][(seed % 4) as usize];
        let camera = camera(eye, direction, vfov_deg, [75, 41]);
        assert_equals_brute_force(&camera, &mesh);
        for fragment in rasterize(&camera, &mesh.view()).fragments {
            covered += usize::from(fragment.is_covered());
            if fragment.is_covered() {
                let sum: f32 = fragment.barycentrics.iter().sum();
                assert!((sum - 1.0).abs() < 1e-6, "{fragment:?}");
                assert!(fragment.barycentrics.iter().all(|&weight| weight >= 0.0));
                assert!(f64::from(fragment.depth) > 0.99 * NEAR && fragment.depth < 10.0);
            }
        }
    }
    assert!(covered > 24 * 75 * 41 / 3, "only {covered} pixels covered");
}

/// Number of triangles that take a sample, for every pixel centre.
fn coverage(camera: &PlacedCamera, mesh: &TestMesh) -> Vec<usize> {
    let setups = setups(camera, mesh);
    let mut counts = Vec::new();
    for y in 0..camera.height {
        for x in 0..camera.width {
            let x = f64::from(x) + 0.5 - 0.5 * f64::from(camera.width);
            let y = f64::from(y) + 0.5 - 0.5 * f64::from(camera.height);
            let takes = |setup: &&TriangleSetup| setup.inverse_depth_inside(x, y) > 0.0;
            counts.push(setups.iter().flatten().filter(takes).count());
        }
    }
    counts
}

#[test]
fn a_sheet_of_triangles_takes_every_sample_once() {
    // The cells are a whole number of pixels, an odd size puts a pixel centre
    // on the sheet's middle, so edges and corners run through centres.
    for (cells, size) in [(8, 63), (9, 63), (16, 64), (31, 64), (63, 64)] {
        let mut mesh = TestMesh::default();
        let corner = Vec3::new(-0.5, -0.5, 0.0);
        mesh.add_sheet(corner, Vec3::X, Vec3::Y, cells);
        // At distance 1 the picture is exactly the sheet but for a margin.
        let vfov_deg = 2.0 * 0.499_f64.atan_deg();
        let camera = camera(DVec3::Z, DVec3::NEG_Z, vfov_deg, [size; 2]);
        assert!(coverage(&camera, &mesh).iter().all(|&count| count == 1));
        assert_equals_brute_force(&camera, &mesh);
    }
}

trait AtanDeg {
    fn atan_deg(self) -> f64;
}

impl AtanDeg for f64 {
    /// Arc tangent in degrees, for angles below 90.
    fn atan_deg(self) -> f64 {
        let cosine = 1.0 / (1.0 + self * self).sqrt();
        crate::maths::functions::acos(cosine) * (180.0 / std::f64::consts::PI)
    }
}

#[test]
fn a_camera_whose_axes_are_exact_sees_no_crack_at_corners_on_centers() {
    // A pixel is 2^-6 at unit distance, so corners hit centres exactly; the
    // triangles have corners of their own at equal positions.
    let camera = PlacedCamera {
        eye: DVec3::ZERO,
        forward: DVec3::NEG_Z,
        right: DVec3::X / 64.0,
        down: DVec3::NEG_Y / 64.0,
        width: 63,
        height: 63,
    };
    let mut sheet = TestMesh::default();
    let corner = Vec3::new(-0.5, -0.5, -1.0);
    sheet.add_sheet(corner, Vec3::X, Vec3::Y, 32);
    let corners: Vec<[Vec3; 3]> = (sheet.triangles.iter())
        .map(|triangle| triangle.map(|k| sheet.positions[k as usize]))
        .collect();
    for mesh in [sheet, TestMesh::soup(&corners)] {
        assert!(coverage(&camera, &mesh).iter().all(|&count| count == 1));
    }
}

#[test]
fn a_fan_about_a_random_corner_takes_every_sample_once() {
    for seed in 0..40 {
        let count = 3 + seed % 9;
        let hub = Vec3::new(
            uniform(seed, 0, 0) * 0.2,
            uniform(seed, 0, 1) * 0.2,
            uniform(seed, 0, 2) * 0.2,
        );
        let rim = |k: u32| {
            let angle = f64::from(k % count) / f64::from(count) * std::f64::consts::TAU;
            let [x, y] = [
                crate::maths::functions::cos(angle),
                crate::maths::functions::sin(angle),
            ];
            Vec3::new(8.0 * x as f32, 8.0 * y as f32, uniform(seed, k % count, 3))
        };
        let corners: Vec<[Vec3; 3]> = (0..count).map(|k| [hub, rim(k), rim(k + 1)]).collect();
        let mesh = TestMesh::soup(&corners);
        // The hub's pixel is aimed at: its centre is the hub but for rounding.
        let eye = DVec3::new(0.3, -0.2, 3.0);
        let camera = camera(eye, hub.as_dvec3() - eye, 40.0, [41, 33]);
        assert!(
            coverage(&camera, &mesh).iter().all(|&count| count == 1),
            "seed {seed}"
        );
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let mesh = boxes();
    let camera = camera(
        DVec3::new(0.1, 0.2, 0.9),
        DVec3::new(-0.1, -0.3, -1.0),
        60.0,
        [200, 150],
    );
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let centers = rasterize(&camera, &mesh.view());
            let marks = edge_pixels(&camera, &mesh.view(), &centers);
            let samples = rasterize_samples(&camera, &mesh.view(), &marks);
            (centers, marks, samples)
        })
    };
    assert!(run(1) == run(3));
}

#[test]
fn equal_depths_go_to_the_lowest_index() {
    let corners = [
        Vec3::new(-9.0, -9.0, 0.1),
        Vec3::new(9.0, -9.0, -0.3),
        Vec3::new(0.0, 9.0, 0.2),
    ];
    let [a, b, c] = corners;
    let camera = camera(DVec3::new(0.1, 0.0, 2.0), DVec3::NEG_Z, 30.0, [70, 40]);
    // The same triangle, turned, and from its back.
    let mesh = TestMesh::soup(&[[b, c, a], [a, b, c], [c, b, a], [a, c, b]]);
    for fragment in rasterize(&camera, &mesh.view()).fragments {
        assert_eq!(fragment.triangle, 0);
        assert!(fragment.front);
    }
    let mesh = TestMesh::soup(&[[c, b, a], [a, b, c]]);
    for fragment in rasterize(&camera, &mesh.view()).fragments {
        assert_eq!((fragment.triangle, fragment.front), (0, false));
    }
}

#[test]
fn weights_and_depth_are_those_of_the_ray_through_the_pixel() {
    let mesh = random_soup(77);
    let camera = camera(
        DVec3::new(0.1, 0.2, 0.7),
        DVec3::new(-0.2, -0.3, -1.0),
        70.0,
        [97, 61],
    );
    let centers = rasterize(&camera, &mesh.view());
    let mut count = 0;
    for (pixel, fragment) in centers
        .fragments
        .iter()
        .enumerate()
        .filter(|(_, f)| f.is_covered())
    {
        let (x, y) = (pixel as u32 % camera.width, pixel as u32 / camera.width);
        let [a, b, c] = mesh.triangles[fragment.triangle as usize]
            .map(|corner| mesh.positions[corner as usize].as_dvec3());
        let ray = camera.forward
            + camera.right * (f64::from(x) + 0.5 - 48.5)
            + camera.down * (f64::from(y) + 0.5 - 30.5);
        let normal = (b - a).cross(c - a);
        let depth = (a - camera.eye).dot(normal) / ray.dot(normal);
        let hit = camera.eye + ray * depth;
        let [wa, wb, wc] = fragment.barycentrics.map(f64::from);
        let interpolated = a * wa + b * wb + c * wc;
        let size = (b - a).length() + (c - a).length();
        // Floats carry depth and weights; a plane seen at an angle magnifies
        // nothing, since the reference uses the same ray.
        assert!(
            (f64::from(fragment.depth) - depth).abs() < 2e-7 * depth,
            "{fragment:?}"
        );
        assert!(
            (interpolated - hit).length() < 1e-6 * size + 1e-12,
            "{fragment:?}"
        );
        assert_eq!(fragment.front, ray.dot(normal) < 0.0);
        count += 1;
    }
    assert!(count > 2000, "only {count} pixels covered");
}

#[test]
fn the_samples_are_a_net_with_the_mean_in_the_middle() {
    for shift in 0..=4 {
        let mut cells: Vec<[u32; 2]> = SAMPLE_OFFSETS
            .iter()
            .map(|[x, y]| {
                [
                    (x * (1 << shift) as f32) as u32,
                    (y * (16 >> shift) as f32) as u32,
                ]
            })
            .collect();
        cells.sort_unstable();
        cells.dedup();
        assert_eq!(cells.len(), SAMPLE_COUNT, "{} columns", 1 << shift);
    }
    for axis in 0..2 {
        let sum: f32 = SAMPLE_OFFSETS.iter().map(|offset| offset[axis]).sum();
        assert_eq!(sum / SAMPLE_COUNT as f32, 0.5);
    }
}

#[test]
fn samples_measure_the_area_beside_any_line() {
    let mut worst: f64 = 0.0;
    let mut squares = 0.0;
    for k in 0..400 {
        let angle = f64::from(k) * 0.1;
        let normal = [
            crate::maths::functions::cos(angle),
            crate::maths::functions::sin(angle),
        ];
        let distance = f64::from(uniform(3, k, 0)) - 0.5;
        let is_inside = |x: f64, y: f64| normal[0] * (x - 0.5) + normal[1] * (y - 0.5) < distance;
        let fine = 256;
        let at = |k: usize| (k as f64 + 0.5) / fine as f64;
        let area = (0..fine * fine)
            .filter(|&k| is_inside(at(k % fine), at(k / fine)))
            .count();
        let samples = SAMPLE_OFFSETS
            .iter()
            .filter(|[x, y]| is_inside(f64::from(*x), f64::from(*y)));
        let error = samples.count() as f64 / 16.0 - area as f64 / (fine * fine) as f64;
        worst = worst.at_least(error.abs());
        squares += error * error;
    }
    let rms = (squares / 400.0).sqrt();
    // Independent samples would be off by 0.1 in the mean; no 16 samples
    // are right to less than half a sample for all lines.
    assert!(
        rms < 0.04 && worst <= 0.125,
        "error of an area: {rms}, at worst {worst}"
    );
}

/// A room with boxes in it, one of which passes through another.
fn boxes() -> TestMesh {
    let mut mesh = TestMesh::default();
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z];
    mesh.add_box(Vec3::new(-0.5, -0.5, -0.5), y, x, z * 1.6, 8);
    mesh.add_box(Vec3::new(-0.3, -0.5, -0.3), x * 0.2, y * 0.5, z * 0.2, 6);
    let (u, v) = (Vec3::new(0.2, 0.0, 0.1), Vec3::new(-0.1, 0.0, 0.2));
    mesh.add_box(Vec3::new(0.1, -0.5, 0.0), u, y * 0.25, v, 5);
    mesh.add_box(Vec3::new(0.0, -0.4, 0.1), u * 1.5, y * 0.03, v * 0.3, 3);
    for k in 0..12 {
        let corner = random_point(9, k, 0.7);
        let [u, v, w] = [1, 2, 3].map(|c| random_point(9, 100 * c + k, 0.1));
        mesh.add_box(corner, u, v, w, 2);
    }
    mesh.find_edges();
    mesh
}

fn is_uniform(
    samples: &[Fragment; SAMPLE_COUNT],
    mesh: &RasterMesh,
    camera: &PlacedCamera,
    pixel: u32,
) -> bool {
    let place = [pixel % camera.width, pixel / camera.width];
    let groups = surface_groups(samples, mesh, camera, place);
    groups.len() == 1 && groups[0].members == u16::MAX || groups.is_empty()
}

#[test]
fn edge_pixels_are_found() {
    let mesh = boxes();
    let (mut mixed, mut found, mut marked, mut all) = (0, 0, 0, 0);
    for seed in 0..6 {
        let eye = DVec3::new(-0.3 + 0.1 * f64::from(seed), 0.2, 0.9);
        let camera = camera(eye, DVec3::new(0.05, -0.3, -1.0), 60.0, [160, 120]);
        let centers = rasterize(&camera, &mesh.view());
        let marks = edge_pixels(&camera, &mesh.view(), &centers);
        let every = vec![true; marks.len()];
        let buffer = rasterize_samples(&camera, &mesh.view(), &every);
        for (pixel, &is_marked) in marks.iter().enumerate() {
            let samples = buffer.pixel(pixel).unwrap();
            if !is_uniform(samples, &mesh.view(), &camera, pixel as u32) {
                mixed += 1;
                found += usize::from(is_marked);
            }
        }
        marked += marks.iter().filter(|&&is_marked| is_marked).count();
        all += marks.len();
    }
    let share = f64::from(found as u32) / f64::from(mixed);
    assert!(mixed > 1000 && share >= 0.999, "{found} of {mixed} found");
    assert!(marked < all / 3, "{marked} of {all} marked");
}

#[test]
fn groups_are_surfaces_with_central_representatives() {
    let mut mesh = TestMesh::default();
    // Two sheets that meet in a line, over one that lies behind.
    mesh.add_sheet(Vec3::new(-1.0, -1.0, 0.0), Vec3::X, Vec3::Y * 2.0, 7);
    mesh.add_sheet(Vec3::ZERO - Vec3::Y, Vec3::X, Vec3::Y * 2.0, 7);
    let camera = camera(DVec3::Z, DVec3::NEG_Z, 60.0, [9, 9]);
    let every = [true; 81];
    let buffer = rasterize_samples(&camera, &mesh.view(), &every);
    let samples = buffer.pixel(40).unwrap();
    let groups = surface_groups(samples, &mesh.view(), &camera, [4, 4]);
    assert_eq!(groups.len(), 2);
    assert_eq!(groups[0].members ^ groups[1].members, u16::MAX);
    assert!(groups[0].members.trailing_zeros() < groups[1].members.trailing_zeros());
    for group in groups.iter() {
        assert_eq!(group.members.count_ones(), 8);
        assert!(group.members >> group.representative & 1 == 1);
        let [x, y] = SAMPLE_OFFSETS[group.representative as usize];
        let middle = if x < 0.5 { 0.25 } else { 0.75 };
        assert!((x - middle).abs() < 0.2 && (y - 0.5).abs() < 0.2, "{x} {y}");
    }
    let empty = [Fragment::EMPTY; SAMPLE_COUNT];
    assert!(surface_groups(&empty, &mesh.view(), &camera, [4, 4]).is_empty());
}

#[test]
fn two_sheets_of_one_patch_behind_each_other_are_two_groups() {
    const MIDDLE: usize = 32 * 65 + 32;
    let mut mesh = TestMesh::default();
    mesh.add_sheet(Vec3::new(-1.0, -1.0, 0.0), Vec3::X, Vec3::Y * 2.0, 1);
    mesh.add_sheet(Vec3::new(-1.0, -1.0, -0.1), Vec3::X * 2.0, Vec3::Y * 2.0, 1);
    mesh.patches.fill(0);
    let camera = camera(DVec3::Z, DVec3::NEG_Z, 60.0, [65, 65]);
    let buffer = rasterize_samples(&camera, &mesh.view(), &[true; 65 * 65]);
    let groups = surface_groups(
        buffer.pixel(MIDDLE).unwrap(),
        &mesh.view(),
        &camera,
        [32, 32],
    );
    assert_eq!(groups.len(), 2);
    let marks = edge_pixels(&camera, &mesh.view(), &rasterize(&camera, &mesh.view()));
    assert!(marks[MIDDLE]);
}
