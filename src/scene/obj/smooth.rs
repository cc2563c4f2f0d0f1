//! `normals = "smooth"`.

use std::collections::HashMap;

use glam::DVec3;

use crate::scene::Mesh;
use crate::scene::file::fields::unit;

/// Share of the summed areas below which the sum of face normals is rounding:
/// the faces cancel, as those of a sheet with two sides do.
const CANCELLED: f64 = 1e-9;

/// Gives every triangle the area-weighted mean of the face normals that meet
/// at each corner, over equal positions within one material. A triangle stays
/// flat where the normals of a corner cancel.
pub(super) fn smooth(mesh: &mut Mesh) {
    // Only looked up, never iterated, so its order says nothing.
    let mut group_of: HashMap<([u64; 3], u32), u32> = HashMap::new();
    let mut sums: Vec<(DVec3, f64)> = Vec::new();
    let mut groups = Vec::with_capacity(mesh.triangles.len());
    for triangle in &mesh.triangles {
        let corners = triangle.corners.map(|c| mesh.positions[c as usize]);
        let twice_area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        groups.push(corners.map(|position| {
            // Adding zero makes the two zeros equal.
            let bits = (position + DVec3::ZERO).to_array().map(f64::to_bits);
            let next = sums.len() as u32;
            let group = *group_of.entry((bits, triangle.material)).or_insert(next);
            if group == next {
                sums.push((DVec3::ZERO, 0.0));
            }
            let (sum, area) = &mut sums[group as usize];
            *sum += twice_area;
            *area += twice_area.length();
            group
        }));
    }
    let normals: Vec<Option<DVec3>> = sums
        .iter()
        .map(|&(sum, area)| unit(sum).filter(|_| sum.length() > CANCELLED * area))
        .collect();
    for (triangle, group) in mesh.triangles.iter_mut().zip(groups) {
        let complete = group.iter().all(|&g| normals[g as usize].is_some());
        triangle.normals = complete.then_some(group);
    }
    // Cancelled sums keep a place so that the indices stay; no triangle has it.
    mesh.normals = normals
        .into_iter()
        .map(|normal| normal.unwrap_or(DVec3::Z))
        .collect();
}
