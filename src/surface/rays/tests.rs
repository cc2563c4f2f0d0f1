use super::scenes::*;
use super::*;
use crate::maths::sampling::cosine_direction;
use crate::simd::Corners;
use crate::simd::ray::RaySetup;
use crate::simd::triangle::{Best, Interval};

const LEVELS: [Level; 3] = [Level::Scalar, Level::Sse2, Level::Avx2];

/// The definition of a hit: every triangle, in list order.
fn brute_force(corners: &[Corners], ray: &Ray) -> Option<Hit> {
    let setup = RaySetup::new(ray);
    let mut best = Best::none(&setup);
    for (index, corners) in corners.iter().enumerate() {
        if let Some(interval) = Interval::of_triangle(&setup, corners) {
            best.offer(&setup, corners, interval, || index as u32);
        }
    }
    best.hit(&setup)
}

fn bits(hit: Option<Hit>) -> Option<(u32, u32, [u32; 3])> {
    hit.map(|h| (h.triangle, h.t.to_bits(), h.barycentrics.map(f32::to_bits)))
}

/// All backends against brute force; returns the share of rays that hit.
fn assert_same(name: &str, mesh: &Mesh, rays: &[Ray]) -> f32 {
    let tree = RayTree::build(&mesh.positions, &mesh.triangles);
    let corners: Vec<Corners> = (0..mesh.triangles.len())
        .map(|triangle| Corners::new(mesh.corners(triangle)))
        .collect();
    let truth: Vec<Option<Hit>> = rays.iter().map(|ray| brute_force(&corners, ray)).collect();
    for level in LEVELS {
        let mut hits = vec![None; rays.len()];
        let mut occluded = vec![false; rays.len()];
        tree.closest_many(level, rays, &mut hits);
        tree.occluded_many(level, rays, &mut occluded);
        for (i, ray) in rays.iter().enumerate() {
            assert_eq!(bits(hits[i]), bits(truth[i]), "{name} {level:?} {ray:?}");
            assert_eq!(occluded[i], truth[i].is_some(), "{name} {level:?} {ray:?}");
        }
    }
    for (ray, truth) in rays.iter().zip(&truth) {
        assert_eq!(
            bits(tree.closest_obvhs(ray)),
            bits(*truth),
            "{name} obvhs {ray:?}"
        );
        assert_eq!(
            tree.occluded_obvhs(ray),
            truth.is_some(),
            "{name} obvhs {ray:?}"
        );
        assert_eq!(
            bits(tree.closest(Level::detect(), ray)),
            bits(*truth),
            "{name}"
        );
        assert_eq!(
            tree.occluded(Level::detect(), ray),
            truth.is_some(),
            "{name}"
        );
    }
    truth.iter().flatten().count() as f32 / rays.len() as f32
}

/// Rays of every kind that a scene has to get right: any place, length and end,
/// axis-parallel ones, and ones exactly at vertices, edges and in planes.
fn rays_for(mesh: &Mesh, seed: u32, count: usize) -> Vec<Ray> {
    let mut random = Uniforms::new(seed);
    (0..count)
        .map(|i| ray_of_kind(mesh, &mut random, i))
        .collect()
}

fn ray_of_kind(mesh: &Mesh, random: &mut Uniforms, kind: usize) -> Ray {
    let t_max = [f32::INFINITY, 1e30, 1.0, 0.5][(kind / 8) % 4];
    let origin = random.point();
    let corners = mesh.corners(random.below(mesh.triangles.len()));
    let vertex = corners[random.below(3)];
    let middle = (corners[0] + corners[1]) * 0.5;
    let axis = Vec3::AXES[random.below(3)] * [1.0, -1.0][random.below(2)];
    let length = [1.0, 1e-6, 1e6, 3.0][random.below(4)];
    let far = random.direction() * [5.0, 60.0, 1000.0, 1e5][random.below(4)];
    let (origin, direction) = match kind % 8 {
        0 => (origin, random.direction() * length),
        1 => (origin, vertex - origin),
        2 => (origin, middle - origin),
        3 => (vertex - axis, axis),
        4 => (vertex, axis * length),
        5 => (middle, random.direction()),
        6 => (far, vertex - far + random.point() * 0.1),
        _ => (far, random.direction() * length),
    };
    let direction = if direction.length() > 1e-9 {
        direction
    } else {
        axis
    };
    Ray {
        origin,
        direction,
        t_max,
    }
}

fn needles() -> Mesh {
    let mut random = Uniforms::new(5);
    let mut mesh = Mesh::default();
    for i in 0..400 {
        let [a, b] = [random.point() * 0.9, random.point() * 0.9];
        let width = [1e-2, 1e-4, 1e-6, 0.0][i % 4];
        mesh.push([a, b, b + random.point() * width]);
    }
    mesh
}

/// Each triangle three times, and larger ones in the planes of others.
fn coincident() -> Mesh {
    let mut mesh = soup(8, 100, 0.4);
    for _ in 0..2 {
        mesh.triangles.extend_from_within(..100);
    }
    mesh.push_grid(Vec3::new(-1.0, 0.25, -1.0), Vec3::X * 2.0, Vec3::Z * 2.0, 5);
    mesh.push_grid(Vec3::new(-0.5, 0.25, -0.5), Vec3::X, Vec3::Z, 7);
    mesh.push_grid(
        Vec3::new(-1.0, -1.0, -1.0),
        Vec3::new(2.0, 2.0, 0.0),
        Vec3::Z,
        3,
    );
    mesh.push_grid(
        Vec3::new(-0.5, -0.5, -1.0),
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::Z,
        3,
    );
    mesh
}

fn small_room() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.push_box(Vec3::ZERO, 1.0, 8);
    mesh.push_sphere(Vec3::new(0.25, -0.5, 0.25), 0.5, 5, 0.2);
    mesh.push_box(Vec3::new(-0.5, -0.75, 0.0), 0.25, 4);
    mesh
}

#[test]
fn every_backend_has_the_bits_of_brute_force() {
    for (name, mesh) in [
        ("soup", soup(1, 500, 0.3)),
        ("fine soup", soup(2, 2000, 0.03)),
        ("needles", needles()),
        ("coincident", coincident()),
        ("room", small_room()),
        ("one triangle", soup(3, 1, 0.9)),
        ("nine triangles", soup(4, 9, 0.7)),
    ] {
        let share = assert_same(name, &mesh, &rays_for(&mesh, 7, 6000));
        assert!(
            share > 0.05 && share <= 1.0,
            "{name}: {share} of the rays hit"
        );
    }
}

/// Rays from what is seen from random places.
fn bounce_rays(mesh: &Mesh, seed: u32, count: usize) -> Vec<Ray> {
    let tree = RayTree::build(&mesh.positions, &mesh.triangles);
    let seen = scattered_rays(Vec3::new(0.1, 0.95, 0.2), false, count);
    cosine_rays(&hit_points(mesh, &tree, &seen), seed)
}

#[test]
fn large_scenes_have_the_bits_of_brute_force() {
    for (name, mesh) in [("room", room()), ("blob", blob())] {
        let mut rays = rays_for(&mesh, 11, 64);
        rays.extend(bounce_rays(&mesh, 12, 64));
        let share = assert_same(name, &mesh, &rays);
        assert!(share > 0.2, "{name}: {share} of the rays hit");
    }
}

/// Large scenes against the second backend, since brute force is slow there.
#[test]
fn both_traversals_agree_on_large_scenes() {
    for mesh in [room(), blob()] {
        let tree = RayTree::build(&mesh.positions, &mesh.triangles);
        let mut rays = rays_for(&mesh, 13, 10_000);
        rays.extend(bounce_rays(&mesh, 14, 20_000));
        let mut hits = vec![None; rays.len()];
        tree.closest_many(Level::detect(), &rays, &mut hits);
        for (ray, hit) in rays.iter().zip(&hits) {
            assert_eq!(bits(*hit), bits(tree.closest_obvhs(ray)), "{ray:?}");
            assert_eq!(hit.is_some(), tree.occluded_obvhs(ray), "{ray:?}");
        }
    }
}

#[test]
fn an_empty_list_is_never_hit() {
    let tree = RayTree::build(&[], &[]);
    let ray = Ray {
        origin: Vec3::ZERO,
        direction: Vec3::X,
        t_max: f32::INFINITY,
    };
    for level in LEVELS {
        assert_eq!(tree.closest(level, &ray), None);
        assert!(!tree.occluded(level, &ray));
    }
    assert_eq!(tree.closest_obvhs(&ray), None);
    assert!(!tree.occluded_obvhs(&ray));
}

/// Clustering would make a chain of them: the fallback has to take over.
#[test]
fn a_thousand_equal_triangles_are_no_chain() {
    let mut mesh = soup(3, 20, 0.5);
    for _ in 0..1000 {
        mesh.triangles.push([0, 1, 2]);
    }
    mesh.triangles.extend([[4, 4, 4]; 300]);
    assert_same("equal triangles", &mesh, &rays_for(&mesh, 17, 300));
}

#[test]
fn building_is_deterministic_and_order_of_the_list_decides_ties() {
    let mut mesh = small_room();
    let again = RayTree::build(&mesh.positions, &mesh.triangles);
    let tree = RayTree::build(&mesh.positions, &mesh.triangles);
    assert_eq!(format!("{tree:?}"), format!("{again:?}"));

    let count = mesh.triangles.len() as u32;
    mesh.triangles.extend_from_within(..);
    let twice = RayTree::build(&mesh.positions, &mesh.triangles);
    for ray in rays_for(&mesh, 19, 2000) {
        let hit = twice.closest(Level::detect(), &ray);
        assert_eq!(bits(hit), bits(tree.closest(Level::detect(), &ray)));
        assert!(hit.is_none_or(|hit| hit.triangle < count));
    }
}

fn assert_no_leak(mesh: &Mesh, inside: impl Fn(&mut Uniforms) -> Vec3, count: usize) {
    let tree = RayTree::build(&mesh.positions, &mesh.triangles);
    let mut random = Uniforms::new(23);
    let rays: Vec<Ray> = (0..count)
        .map(|i| {
            let origin = inside(&mut random);
            let vertices = mesh.corners(random.below(mesh.triangles.len()));
            // Half of them at vertices and edges, where a leak would be.
            let target = match i % 4 {
                0 => vertices[0],
                1 => (vertices[1] + vertices[2]) * 0.5,
                2 => vertices[0].lerp(vertices[2], random.next()),
                _ => origin + random.direction(),
            };
            let direction = target - origin;
            Ray {
                origin,
                direction,
                t_max: f32::INFINITY,
            }
        })
        .collect();
    let mut hits = vec![None; count];
    tree.closest_many(Level::detect(), &rays, &mut hits);
    for (ray, hit) in rays.iter().zip(&hits) {
        assert!(hit.is_some(), "{ray:?} leaks");
    }
}

#[test]
fn nothing_leaks_out_of_closed_bodies() {
    let mut sphere = Mesh::default();
    sphere.push_sphere(Vec3::ZERO, 0.9, 40, 0.0);
    assert_no_leak(&sphere, |random| random.point() * 0.4, 100_000);

    let mut cube = Mesh::default();
    cube.push_box(Vec3::ZERO, 1.0, 37);
    assert_no_leak(&cube, |random| random.point() * 0.999, 100_000);

    // A box of rows of needles, 1,000 times longer than wide.
    let mut flat = Mesh::default();
    flat.push_box(Vec3::ZERO, 1.0, 9);
    for p in &mut flat.positions {
        p.y *= 1e-3;
    }
    let inside = |random: &mut Uniforms| random.point() * Vec3::new(0.999, 9e-4, 0.999);
    assert_no_leak(&flat, inside, 100_000);

    // A body that is turned against the axes.
    let mut turned = cube.clone();
    for p in &mut turned.positions {
        let (x, y) = (p.x * 0.6 - p.y * 0.8, p.x * 0.8 + p.y * 0.6);
        *p = Vec3::new(x * 0.8 - p.z * 0.6, y, x * 0.6 + p.z * 0.8) * 0.55;
    }
    assert_no_leak(&turned, |random| random.point() * 0.3, 100_000);
}

/// From far away a closed body still has no gap inside its outline.
#[test]
fn nothing_leaks_through_a_body_seen_from_far_away() {
    let mut mesh = Mesh::default();
    mesh.push_sphere(Vec3::ZERO, 0.9, 40, 0.0);
    for distance in [3.0, 30.0, 1000.0, 1e5] {
        let tree = RayTree::build(&mesh.positions, &mesh.triangles);
        let mut random = Uniforms::new(29);
        for _ in 0..20_000 {
            let origin = random.direction() * distance;
            let target = random.point() * 0.3;
            let direction = target - origin;
            let ray = Ray {
                origin,
                direction,
                t_max: 1.0,
            };
            assert!(tree.occluded(Level::detect(), &ray), "{ray:?} leaks");
        }
    }
}

/// Points of one plane in any place and orientation: a grid of small triangles
/// beside a large one.
fn plane_mesh(random: &mut Uniforms, kind: usize) -> Mesh {
    let normal = match kind % 3 {
        0 => Vec3::AXES[random.below(3)],
        1 => random.direction(),
        _ => (Vec3::AXES[random.below(3)] + random.point() * 1e-3).normalize(),
    };
    let u = normal.any_orthonormal_vector();
    let v = normal.cross(u);
    let size = [1.0, 0.1, 1e-3][(kind / 3) % 3] * 0.5;
    let corner = random.point() * 0.4 - (u + v) * (size * 0.5);
    let mut mesh = Mesh::default();
    mesh.push_grid(corner, u * size, v * size, 1 + (kind / 9 % 12) as u32);
    mesh
}

#[test]
fn a_ray_that_leaves_a_surface_does_not_hit_it() {
    let mut random = Uniforms::new(31);
    for kind in 0..400 {
        let mesh = plane_mesh(&mut random, kind);
        let tree = RayTree::build(&mesh.positions, &mesh.triangles);
        for _ in 0..500 {
            let triangle = random.below(mesh.triangles.len());
            let normal = mesh.normal(triangle) * [1.0, -1.0][random.below(2)];
            let steep = cosine_direction(normal, random.pair());
            // Grazing ones are the hard ones, down to parallel to the plane.
            let along = steep - normal * steep.dot(normal);
            let height = [0.0, 1e-6, 1e-4, 1e-2][random.below(4)];
            let direction = [steep, along + normal * height][random.below(2)];
            let point = mesh.point(triangle, random.pair());
            let origin = offset_origin(point, normal, direction);
            let ray = Ray {
                origin,
                direction,
                t_max: f32::INFINITY,
            };
            let hit = tree.closest(Level::detect(), &ray);
            assert_eq!(
                hit, None,
                "{ray:?} from triangle {triangle}, normal {normal}"
            );
        }
    }
}
