//! Functions end at the borders of partitions; light must not show it.

use glam::{DVec3, Vec3};

use super::{Baked, at_least, at_most, largest};
use crate::bake::{RunSettings, Study, VertexFields};
use crate::maths::order::Order;
use crate::scene::sample_scenes::{cube_room, point_light, room_with_blocks};
use crate::scene::{Bounces, Scene};

/// Largest jump of E across a border over the 99th percentile of the jumps
/// inside partitions.
const JUMP: f64 = 1.5;
/// Edges between normals farther apart than 10 degrees are creases: cosine.
const FLAT: f32 = 0.984_8;

/// Albedo and bounces of both rooms.
const ALBEDO: f32 = 0.7;
const BOUNCES: u32 = 4;
/// Rays a vertex of light that no basis touched, and of the bake beside it, and the
/// seed of the former. (By 512 and 1,024 noise alone makes 0.3 of a usual jump.)
const TRUE_RAYS: u32 = 2048;
const TRUE_SEED: u32 = 0xb0_4de5;
/// Largest jump at a border over that of the light itself: both have noise, of
/// 2 % of E.
const OF_LIGHT: f64 = 1.1;

/// Differences of E along the edges of the lit sides: across borders of
/// partitions, and inside them.
fn jumps(room: &Baked, irradiance: &[Vec3]) -> [Vec<f64>; 2] {
    let basis = room.bake.basis();
    let part = |v: u32| basis.row(basis.slot_of_vertex()[v as usize]).0;
    let (mut across, mut inside) = (Vec::new(), Vec::new());
    for triangle in 0..room.surface.mesh.triangles.len() as u32 {
        let corners = room.surface.vertices.of_triangle(triangle, true);
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            if room.normal(a as usize).dot(room.normal(b as usize)) >= FLAT {
                let jump = f64::from((irradiance[a as usize].x - irradiance[b as usize].x).abs());
                if part(a) == part(b) {
                    &mut inside
                } else {
                    &mut across
                }
                .push(jump);
            }
        }
    }
    [across, inside]
}

/// Figures of the jumps over the 99th percentile inside: the 99th percentile
/// and the largest across borders, and the largest inside.
fn relative_jumps(name: &str, scene: &Scene, position: DVec3) -> [f64; 3] {
    let room = Baked::new(scene);
    let irradiance = room.indirect(
        &[point_light(position, 1.0)],
        ALBEDO,
        Bounces::Count(BOUNCES),
    );
    let [across, inside] = jumps(&room, &irradiance);
    let count = across.len();
    assert!(count > 100, "{name}: {count} edges cross borders");
    let usual = percentile_99(&inside);
    [percentile_99(&across), largest(across), largest(inside)].map(|jump| jump / usual)
}

fn percentile_99(jumps: &[f64]) -> f64 {
    let mut jumps = jumps.to_vec();
    jumps.sort_by(f64::total_cmp);
    jumps[jumps.len() * 99 / 100]
}

/// An empty room with the light near a wall.
fn cube() -> (Scene, DVec3) {
    (cube_room(2.0, 0.1, 512), DVec3::new(0.5, 0.6, -0.3))
}

#[test]
fn usual_jumps_at_borders_are_like_those_inside() {
    let (scene, position) = cube();
    let [usual, largest, inside] = relative_jumps("cube", &scene, position);
    let what = format!(
        "jumps at borders, cube, largest {largest:.3}, largest inside {inside:.3}, 99th percentile"
    );
    at_most(&what, usual, JUMP);
    at_most("largest jump at a border, cube", largest, JUMP);
}

/// The same light by independent rays without a basis, by vertex.
fn by_rays(room: &Baked, source: &[Vec3], albedo: f32) -> Vec<Vec3> {
    let run = RunSettings::silent();
    let study = Study::new(&room.surface, &room.bake, &run).expect("nobody stops it");
    let arrivals = study
        .trace(TRUE_SEED, TRUE_RAYS, &run)
        .expect("nobody stops it");
    let mut received = vec![0.0; source.len()];
    for _ in 0..BOUNCES {
        let pairs = source.iter().zip(&received);
        let sent: Vec<f32> = pairs.map(|(own, e)| own.x + albedo * e).collect();
        received = study
            .bounce_by(&arrivals, &VertexFields::of_columns(&[sent]))
            .values;
    }
    received.into_iter().map(Vec3::splat).collect()
}

/// Below a block beside the light the light on this mesh itself jumps by 1.9 times
/// what is usual in it (by 512 to 4,096 rays, with 512 to 1,024 functions and
/// without any), and a border runs there. What is usual is there what the light
/// has at the same edge, where that is more.
#[test]
fn a_border_adds_no_jump_to_those_of_the_light() {
    let scene = room_with_blocks(true, 0.1, TRUE_RAYS);
    let lights = [point_light(DVec3::new(0.2, 0.7, 0.5), 1.0)];
    let room = Baked::new(&scene);
    let irradiance = room.indirect(&lights, ALBEDO, Bounces::Count(BOUNCES));
    let source: Vec<Vec3> = room.direct(&lights).iter().map(|&e| e * ALBEDO).collect();
    let truth = by_rays(&room, &source, ALBEDO);
    let [found, inside] = jumps(&room, &irradiance);
    let [of_light, inside_light] = jumps(&room, &truth);
    assert!(found.len() > 100, "{} edges cross borders", found.len());
    // Where the light jumps by less, the other test's form has to hold here too.
    let largest_of_light = largest(of_light.iter().copied());
    let premise = largest_of_light / percentile_99(&inside_light);
    at_least("largest jump of the light at a border", premise, JUMP);
    let usual = percentile_99(&inside);
    let ratios = found
        .iter()
        .zip(&of_light)
        .map(|(jump, light)| jump / usual.at_least(*light));
    let ratio = largest(ratios);
    at_most("jump at a border over what is usual there", ratio, JUMP);
    let all = largest(found.iter().copied()) / largest_of_light;
    at_most("largest jump at a border over the light's", all, OF_LIGHT);
}
