//! Triangle lists and rays for tests and measurements.

use super::{Hit, Level, Ray, RayTree, offset_origin};
use crate::maths::functions::sin_f32;
use crate::maths::hash::uniform;
use crate::maths::sampling::{cosine_direction, sphere_direction};
use glam::Vec3;

/// A list of triangles.
#[derive(Default, Clone)]
pub(super) struct Mesh {
    pub(super) positions: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Mesh {
    pub(super) fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|vertex| self.positions[vertex as usize])
    }

    /// Unit normal of a triangle, 0 where it has none.
    pub(super) fn normal(&self, triangle: usize) -> Vec3 {
        let [a, b, c] = self.corners(triangle).map(|p| p.as_dvec3());
        (b - a).cross(c - a).normalize_or_zero().as_vec3()
    }

    /// A point of a triangle from its barycentrics in f32, as a renderer has it.
    pub(super) fn point(&self, triangle: usize, u: [f32; 2]) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        let root = u[0].sqrt();
        let [x, y, z] = [1.0 - root, root * (1.0 - u[1]), root * u[1]];
        a * x + b * y + c * z
    }

    pub(super) fn push(&mut self, corners: [Vec3; 3]) {
        let first = self.positions.len() as u32;
        self.positions.extend(corners);
        self.triangles.push([first, first + 1, first + 2]);
    }

    /// A parallelogram of `n` x `n` cells with shared vertices.
    pub(super) fn push_grid(&mut self, corner: Vec3, u: Vec3, v: Vec3, n: u32) {
        let first = self.positions.len() as u32;
        for j in 0..=n {
            for i in 0..=n {
                let (s, t) = (i as f32 / n as f32, j as f32 / n as f32);
                self.positions.push(corner + u * s + v * t);
            }
        }
        for j in 0..n {
            for i in 0..n {
                let a = first + j * (n + 1) + i;
                let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
                self.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }

    /// A closed sphere of `n` x `n` cells on each face of a cube, with vertices
    /// that are equal where faces meet. `bumps` is the share that its radius varies.
    pub(super) fn push_sphere(&mut self, centre: Vec3, radius: f32, n: u32, bumps: f32) {
        let first = self.positions.len();
        self.push_box(Vec3::ZERO, 1.0, n);
        for p in &mut self.positions[first..] {
            let d = p.normalize();
            let waves = sin_f32(7.0 * d.x) + sin_f32(9.0 * d.y + 1.0) + sin_f32(8.0 * d.z + 2.0);
            *p = centre + d * (radius * (1.0 + bumps * waves / 3.0));
        }
    }

    /// A closed box whose six sides are grids.
    pub(super) fn push_box(&mut self, centre: Vec3, half_width: f32, n: u32) {
        for (axis, sign) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
            let unit = |k: usize| Vec3::AXES[k % 3] * half_width;
            let corner = unit(axis) * sign - unit(axis + 1) - unit(axis + 2);
            self.push_grid(
                centre + corner,
                unit(axis + 1) * 2.0,
                unit(axis + 2) * 2.0,
                n,
            );
        }
    }
}

/// A stream of uniform numbers for one test.
pub(super) struct Uniforms {
    seed: u32,
    index: u32,
}

impl Uniforms {
    pub(super) fn new(seed: u32) -> Self {
        Self { seed, index: 0 }
    }

    pub(super) fn next(&mut self) -> f32 {
        self.index += 1;
        uniform(self.seed, self.index, 0)
    }

    pub(super) fn pair(&mut self) -> [f32; 2] {
        [self.next(), self.next()]
    }

    pub(super) fn below(&mut self, count: usize) -> usize {
        ((self.next() * count as f32) as usize).min(count - 1)
    }

    /// A point of the cube of half width 1.
    pub(super) fn point(&mut self) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| self.next() * 2.0 - 1.0))
    }

    pub(super) fn direction(&mut self) -> Vec3 {
        sphere_direction(self.pair())
    }
}

/// A room of big tessellated grids with six spheres, about 70,000 triangles.
pub(super) fn room() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.push_box(Vec3::ZERO, 1.0, 64);
    for (x, y, z, radius) in [
        (-0.5, -0.7, 0.2, 0.3),
        (0.4, -0.8, -0.3, 0.2),
        (0.6, -0.6, 0.5, 0.25),
        (-0.2, 0.3, -0.6, 0.2),
        (0.1, -0.85, 0.7, 0.15),
    ] {
        mesh.push_sphere(Vec3::new(x, y, z), radius, 20, 0.0);
    }
    mesh
}

/// A bumpy blob of about 70,000 triangles.
pub(super) fn blob() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.push_sphere(Vec3::ZERO, 0.7, 76, 0.3);
    mesh
}

pub(super) fn soup(seed: u32, count: usize, size: f32) -> Mesh {
    let mut random = Uniforms::new(seed);
    let mut mesh = Mesh::default();
    for _ in 0..count {
        let centre = random.point() * (1.0 - size);
        mesh.push(std::array::from_fn(|_| centre + random.point() * size));
    }
    mesh
}

/// Rays of a pinhole at `eye` that looks at `target`, row by row.
pub(super) fn pinhole_rays(eye: Vec3, target: Vec3, width: u32, height: u32) -> Vec<Ray> {
    let forward = (target - eye).normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let up = right.cross(forward);
    let pixel = |i: u32, n: u32| (i as f32 + 0.5) * 2.0 / n as f32 - 1.0;
    let aspect = width as f32 / height as f32;
    (0..width * height)
        .map(|i| Ray {
            origin: eye,
            direction: forward + right * (0.7 * aspect * pixel(i % width, width))
                - up * (0.7 * pixel(i / width, height)),
            t_max: f32::INFINITY,
        })
        .collect()
}

/// Rays in random directions from `eye`, or from a sphere of its distance
/// toward points near the middle.
pub(super) fn scattered_rays(eye: Vec3, inside: bool, count: usize) -> Vec<Ray> {
    let mut random = Uniforms::new(41);
    (0..count)
        .map(|_| {
            let around = random.direction() * eye.length();
            let (origin, direction) = if inside {
                (eye, random.direction())
            } else {
                (around, random.point() * 0.6 - around)
            };
            Ray {
                origin,
                direction,
                t_max: f32::INFINITY,
            }
        })
        .collect()
}

/// Where rays hit, with the unit normal on the side they come from.
pub(super) fn hit_points(mesh: &Mesh, tree: &RayTree, rays: &[Ray]) -> Vec<(Vec3, Vec3)> {
    let mut hits = vec![None; rays.len()];
    tree.closest_many(Level::detect(), rays, &mut hits);
    rays.iter()
        .zip(hits)
        .filter_map(|(ray, hit)| {
            let hit: Hit = hit?;
            let [a, b, c] = mesh.corners(hit.triangle as usize);
            let [x, y, z] = hit.barycentrics;
            let normal = mesh.normal(hit.triangle as usize);
            let side = if normal.dot(ray.direction) > 0.0 {
                -normal
            } else {
                normal
            };
            Some((a * x + b * y + c * z, side))
        })
        .collect()
}

/// Rays from surface points to a point light, t from 0 to 1.
pub(super) fn shadow_rays(points: &[(Vec3, Vec3)], light: Vec3) -> Vec<Ray> {
    points
        .iter()
        .map(|&(point, normal)| {
            let origin = offset_origin(point, normal, light - point);
            Ray {
                origin,
                direction: light - origin,
                t_max: 1.0,
            }
        })
        .collect()
}

/// A cosine-distributed ray from each surface point.
pub(super) fn cosine_rays(points: &[(Vec3, Vec3)], seed: u32) -> Vec<Ray> {
    let mut random = Uniforms::new(seed);
    points
        .iter()
        .map(|&(point, normal)| {
            let direction = cosine_direction(normal, random.pair());
            Ray {
                origin: offset_origin(point, normal, direction),
                direction,
                t_max: f32::INFINITY,
            }
        })
        .collect()
}
