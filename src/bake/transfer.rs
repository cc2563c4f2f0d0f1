//! Sampled transfer: which vertices a vertex receives light from.
//!
//! T_ij of the design (equation 1 of the paper with its missing 1/pi and area):
//! N cosine-weighted rays from N points of vertex i's area; a ray that arrives
//! on a side with vertices adds its barycentric coordinates / N to the three
//! corners. Rows sum to at most 1 by construction, corners and contacts need no
//! special case, and nothing divides by a squared distance.

use glam::Vec3;

use crate::maths::sampling::cosine_direction;
use crate::maths::sobol::ScrambledSobol;
use crate::simd::Level;
use crate::surface::{NONE, Surface};

/// Receivers that share one index list: the lanes of a row kernel.
pub(crate) const GROUP: usize = 8;
/// Seed of the transfer's rays.
const SEED: u32 = 0x7a45;

/// Transfer to one group of receivers, a lane each.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct GroupTransfer {
    /// (sender, its T_ij per receiver), ascending by sender; senders are slots.
    pub(crate) entries: Vec<(u32, [f32; GROUP])>,
    /// r_i: share of the receiver's rays that arrived at a vertex.
    pub(crate) arrived: [f64; GROUP],
    /// Share of the receiver's rays that escaped.
    pub(crate) escaped: [f64; GROUP],
}

/// What sampling needs to know.
#[derive(Clone, Copy)]
pub(crate) struct Sampling<'a> {
    pub(crate) surface: &'a Surface,
    pub(crate) level: Level,
    /// Slot of each vertex.
    pub(crate) slot_of_vertex: &'a [u32],
    /// Rays a vertex.
    pub(crate) rays: u32,
}

/// One worker's memory: a dense row per lane, linear in the vertices.
pub(crate) struct Scratch {
    dense: Vec<[f32; GROUP]>,
    touched: Vec<u32>,
}

impl Scratch {
    pub(crate) fn new(vertex_count: usize) -> Self {
        Self {
            dense: vec![[0.0; GROUP]; vertex_count],
            touched: Vec::new(),
        }
    }

    fn add(&mut self, slot: u32, lane: usize, weight: f32) {
        let entry = &mut self.dense[slot as usize];
        if *entry == [0.0; GROUP] {
            self.touched.push(slot);
        }
        entry[lane] += weight;
    }

    /// Takes the entries out, scaled, and leaves the scratch empty.
    fn drain(&mut self, scale: f32) -> Vec<(u32, [f32; GROUP])> {
        self.touched.sort_unstable();
        self.touched.dedup();
        let dense = &mut self.dense;
        self.touched
            .drain(..)
            .map(|slot| {
                (
                    slot,
                    std::mem::take(&mut dense[slot as usize]).map(|x| x * scale),
                )
            })
            .filter(|(_, weights)| *weights != [0.0; GROUP])
            .collect()
    }
}

/// Samples the rows of up to eight receivers (vertices).
pub(crate) fn sample_group(
    sampling: &Sampling,
    receivers: &[u32],
    scratch: &mut Scratch,
) -> GroupTransfer {
    let mut escaped = [0_u32; GROUP];
    for (lane, &vertex) in receivers.iter().enumerate() {
        escaped[lane] = sample_row(sampling, vertex, lane, scratch);
    }
    let entries = scratch.drain(1.0 / sampling.rays as f32);
    let mut arrived = [0.0; GROUP];
    for (_, weights) in &entries {
        for lane in 0..GROUP {
            arrived[lane] += f64::from(weights[lane]);
        }
    }
    GroupTransfer {
        entries,
        arrived,
        escaped: escaped.map(|count| f64::from(count) / f64::from(sampling.rays)),
    }
}

/// Adds one receiver's hits to its lane; returns how many rays escaped.
fn sample_row(sampling: &Sampling, vertex: u32, lane: usize, scratch: &mut Scratch) -> u32 {
    let surface = sampling.surface;
    let points = ScrambledSobol::new(SEED, vertex);
    let mut escaped = 0;
    for index in 0..sampling.rays {
        let u = points.point(index);
        let from = surface.sample_point(vertex as usize, [u[0], u[1]]);
        let direction = above(
            cosine_direction(from.normal, [u[2], u[3]]),
            from.flat_normal,
        );
        let Some(hit) = surface.arrival(sampling.level, &from, direction) else {
            escaped += 1;
            continue;
        };
        let corners = surface.vertices.of_triangle(hit.triangle, hit.front);
        for (corner, weight) in corners.into_iter().zip(hit.barycentrics) {
            if corner != NONE && weight > 0.0 {
                scratch.add(sampling.slot_of_vertex[corner as usize], lane, weight);
            }
        }
    }
    escaped
}

/// Mirrors a direction at the flat triangle if it points below it: the shading
/// normal's hemisphere reaches there, and the row keeps its sum.
fn above(direction: Vec3, flat_normal: Vec3) -> Vec3 {
    let height = direction.dot(flat_normal);
    if height < 0.0 {
        direction - flat_normal * (2.0 * height)
    } else {
        direction
    }
}
