//! Which vertices lie within an edge length of a contact: a line on which something
//! stands, where light changes within less than a triangle.

use glam::Vec3;
use rayon::prelude::*;

use crate::maths::order::Order;
use crate::surface::Surface;

/// Whether each of some vertices is no farther from a contact than the longest edge
/// that was left whole.
pub(super) fn are_near(surface: &Surface, vertices: &[u32]) -> Vec<bool> {
    let reach = (surface.max_edge * surface.placement.scale) as f32;
    let ends = |&corners: &[u32; 2]| corners.map(|i| surface.mesh.positions[i as usize]);
    let contacts: Vec<[Vec3; 2]> = surface.mesh.contacts.iter().map(ends).collect();
    let positions = surface.vertices.positions();
    let is_near = |&vertex: &u32| {
        let position = positions[vertex as usize];
        let near = |ends: &[Vec3; 2]| squared_distance(position, *ends) <= reach * reach;
        contacts.iter().any(near)
    };
    vertices.par_iter().map(is_near).collect()
}

/// Square of the distance between a point and a segment.
fn squared_distance(point: Vec3, [from, to]: [Vec3; 2]) -> f32 {
    let along = to - from;
    let length = along.length_squared();
    let place = if length > 0.0 {
        ((point - from).dot(along) / length)
            .at_least(0.0)
            .at_most(1.0)
    } else {
        0.0
    };
    point.distance_squared(from + along * place)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::scene::sample_scenes::{BOX_SIDES, Facing, SampleMesh};
    use crate::surface::Detail;

    #[test]
    fn a_segment_ends() {
        let segment = [Vec3::ZERO, Vec3::X];
        let distances = [Vec3::new(0.5, 2.0, 0.0), Vec3::new(-3.0, 4.0, 0.0), Vec3::X]
            .map(|point| squared_distance(point, segment));
        assert_eq!(distances, [4.0, 25.0, 0.0]);
        assert_eq!(squared_distance(Vec3::Y, [Vec3::ZERO; 2]), 1.0);
    }

    #[test]
    fn vertices_around_a_box_are_near_its_contacts_and_the_ceiling_is_not() {
        let mut mesh = SampleMesh::default();
        let room = [DVec3::NEG_ONE, DVec3::ONE];
        mesh.box_sides(room, Facing::Inward, &BOX_SIDES, 0);
        let standing = [DVec3::new(-0.4, -1.0, -0.3), DVec3::new(0.3, -0.2, 0.4)];
        let others: Vec<_> = BOX_SIDES
            .into_iter()
            .filter(|side| *side != (1, false))
            .collect();
        mesh.box_sides(standing, Facing::Outward, &others, 0);
        let scene = mesh.scene(&[0.5], 0.3, 64);
        let surface = Surface::fronts(&scene, &Detail::of_keys(&scene.bake));
        let contacts = surface.mesh.contacts.iter().flatten();
        let contacts = contacts.map(|&i| surface.mesh.positions[i as usize]);
        let on_contacts: Vec<Vec3> = contacts.collect();
        assert!(!on_contacts.is_empty(), "the box stands on the floor");
        let all: Vec<u32> = (0..surface.vertices.len() as u32).collect();
        let near = are_near(&surface, &all);
        let (mut found, mut far) = (0, 0);
        for (position, is_near) in surface.vertices.positions().iter().zip(&near) {
            if on_contacts.contains(position) {
                assert!(is_near, "{position} is on a contact");
                found += 1;
            }
            far += u32::from(!is_near);
        }
        assert!(found > 0, "no vertex is on a contact");
        assert!(
            far as usize > all.len() / 2,
            "{far} of {} are far",
            all.len()
        );
    }
}
