//! Sampled transfer: which vertices a vertex receives light from.
//!
//! T_ij of the design (equation 1 of the paper with its missing 1/pi and area):
//! N cosine-weighted rays from N points of vertex i's area; a ray that arrives
//! on a side with vertices adds its barycentric coordinates / N to the three
//! corners. Rows sum to at most 1 by construction, corners and contacts need no
//! special case, and nothing divides by a squared distance.
//!
//! A ray that meets a surface from the other side of its shading normal brings the light
//! of its vertices like any other. Of direct light that is too much: there a light is on
//! one side of the normal and the ray on the other. To bring nothing is as wrong the
//! other way, since bounced light is seen from both sides: in a room whose walls share
//! smooth normals (14,920 vertices, 2,048 rays, four bounces) a lamp, a spot and a sun
//! are off paths by 2.8, 10.0 and 5.8 %, in the mean by +0.9, +2.2 and +2.3 %; with such
//! rays empty by 2.3, 16.6 and 6.8 %, in the mean by -1.0, -3.4 and -2.3 %. It would
//! take two operators, one of direct and one of bounced light.

use glam::Vec3;
use rayon::prelude::*;

use super::run::Progress;
use super::window::{Escape, aimed_shares, needs_aim, open_cells};
use crate::maths::cube_cells::{CELL_COUNT, cell_of};
use crate::maths::sampling::{cosine_direction, mirrored_above};
use crate::maths::sobol::ScrambledSobol;
use crate::simd::Level;
use crate::surface::{Arrival, KeptArrivals, Surface};

/// Receivers that share one index list: the lanes of a row kernel.
pub(crate) const GROUP: usize = 8;
/// Vertices whose rays one task of [`trace_arrivals`] traces.
const VERTICES_PER_TASK: usize = 32;
/// Seed of the transfer's rays.
pub(super) const SEED: u32 = 0x7a45;
/// A row whose first rays have all escaped, so many, has no more of them: the
/// outsides of walls, nearly half of the vertices of a room with a window, would
/// take as many rays as its inside. One that still sees a surface sees less than
/// a percent of it (of 512 rays none arrives at a share of 0.9 % with a chance
/// of one in a hundred).
const RAYS_INTO_NOTHING: u32 = 512;

/// (Sender, what each receiver of a group gets of it).
type Entries = Vec<(u32, [f32; GROUP])>;

/// Transfer to one group of receivers, a lane each.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct GroupTransfer {
    /// (sender, its T_ij per receiver), ascending by sender; senders are slots.
    pub(crate) entries: Vec<(u32, [f32; GROUP])>,
    /// Half the difference of each entry between the first and the second half of
    /// the rays: noise like that of the entries, and nothing else.
    pub(crate) noise: Vec<[f32; GROUP]>,
    /// r_i: share of the receiver's rays that arrived at a vertex.
    pub(crate) arrived: [f64; GROUP],
    /// Share of the receiver's rays that escaped.
    pub(crate) escaped: [f64; GROUP],
    /// X_im: (cell of the sky, share of the rays that escape into it per
    /// receiver), ascending by cell.
    pub(crate) sky: Vec<(u32, [f32; GROUP])>,
}

impl GroupTransfer {
    /// Whether no ray of the group arrived anywhere.
    pub(crate) fn sees_only_sky(&self) -> bool {
        self.entries.is_empty()
    }
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

/// One worker's memory: a dense row per lane, linear in the vertices, and one
/// over the cells of the sky.
pub(crate) struct Scratch {
    senders: Dense,
    cells: Dense,
    /// Rays of each row in work that escaped.
    escapes: [Vec<Escape>; GROUP],
}

impl Scratch {
    pub(crate) fn new(vertex_count: usize) -> Self {
        Self {
            senders: Dense::new(vertex_count),
            cells: Dense::new(CELL_COUNT),
            escapes: Default::default(),
        }
    }
}

/// Dense rows of a group, a lane each, that remember where they are not empty.
struct Dense {
    dense: Vec<[f32; GROUP]>,
    /// The same of the first half of the rays less the second.
    noise: Vec<[f32; GROUP]>,
    touched: Vec<u32>,
}

impl Dense {
    fn new(length: usize) -> Self {
        Self {
            dense: vec![[0.0; GROUP]; length],
            noise: vec![[0.0; GROUP]; length],
            touched: Vec::new(),
        }
    }

    fn add(&mut self, slot: u32, lane: usize, weight: f32, is_first_half: bool) {
        let entry = &mut self.dense[slot as usize];
        if *entry == [0.0; GROUP] {
            self.touched.push(slot);
        }
        entry[lane] += weight;
        self.noise[slot as usize][lane] += if is_first_half { weight } else { -weight };
    }

    /// Takes the entries and their noise out, scaled lane by lane, and leaves the
    /// scratch empty.
    fn drain(&mut self, scales: &[f32; GROUP]) -> (Entries, Vec<[f32; GROUP]>) {
        self.touched.sort_unstable();
        self.touched.dedup();
        let (dense, noise) = (&mut self.dense, &mut self.noise);
        self.touched
            .drain(..)
            .map(|slot| {
                let scaled = |values: &mut [f32; GROUP]| {
                    let mut values = std::mem::take(values);
                    let lanes = values.iter_mut().zip(scales);
                    lanes.for_each(|(w, scale)| *w *= scale);
                    values
                };
                let weights = scaled(&mut dense[slot as usize]);
                ((slot, weights), scaled(&mut noise[slot as usize]))
            })
            .filter(|((_, weights), _)| *weights != [0.0; GROUP])
            .unzip()
    }
}

/// Samples the rows of up to eight receivers (vertices).
pub(crate) fn sample_group(
    sampling: &Sampling,
    receivers: &[u32],
    scratch: &mut Scratch,
) -> GroupTransfer {
    let mut counts = [RayCounts::default(); GROUP];
    scratch.escapes.iter_mut().for_each(Vec::clear);
    for (lane, &vertex) in receivers.iter().enumerate() {
        counts[lane] = sample_row(sampling, vertex, lane, scratch);
    }
    let open = open_cells(sampling.rays, &scratch.escapes);
    for (lane, &vertex) in receivers.iter().enumerate() {
        add_sky(sampling, (vertex, lane), counts[lane], &open, scratch);
    }
    let scales = counts.map(|count| 1.0 / count.in_the_open() as f32);
    let (entries, noise) = scratch.senders.drain(&scales);
    let (sky, _) = scratch.cells.drain(&scales);
    let mut arrived = [0.0; GROUP];
    for (_, weights) in &entries {
        for lane in 0..GROUP {
            arrived[lane] += f64::from(weights[lane]);
        }
    }
    let share = |count: RayCounts| f64::from(count.escaped) / f64::from(count.in_the_open());
    GroupTransfer {
        entries,
        noise,
        arrived,
        escaped: counts.map(share),
        sky,
    }
}

/// What became of a row's rays.
#[derive(Debug, Clone, Copy, Default)]
struct RayCounts {
    traced: u32,
    escaped: u32,
    /// Arrived at the inside of a closed body.
    inside: u32,
}

impl RayCounts {
    /// Rays that count. A vertex at a contact has part of its area inside a
    /// body; nobody sees that part, so its value is the mean over the rest.
    /// (With the hidden part counted as black, contacts of boxes and floor
    /// darkened the Cornell box by 0.4 % in the mean.)
    fn in_the_open(self) -> u32 {
        (self.traced - self.inside).max(1)
    }

    /// Whether further rays would find nothing either.
    fn sees_nothing(self) -> bool {
        self.traced == RAYS_INTO_NOTHING && self.escaped == self.traced
    }
}

/// The first rays of a vertex's row, numbered: the direction of each and where
/// it arrives (`None`: it escapes).
pub(super) fn row_rays(
    surface: &Surface,
    level: Level,
    vertex: u32,
    count: u32,
) -> impl Iterator<Item = (u32, (Vec3, Option<Arrival>))> {
    vertex_rays(surface, level, [SEED, vertex], count)
}

/// The same rays of another seed: [seed, vertex].
pub(super) fn vertex_rays(
    surface: &Surface,
    level: Level,
    [seed, vertex]: [u32; 2],
    count: u32,
) -> impl Iterator<Item = (u32, (Vec3, Option<Arrival>))> {
    let points = ScrambledSobol::new(seed, vertex);
    (0..count).map(move |index| {
        let u = points.point(index);
        let from = surface.sample_point(vertex as usize, [u[0], u[1]]);
        let direction = mirrored_above(
            cosine_direction(from.normal, [u[2], u[3]]),
            from.flat_normal,
        );
        (index, (direction, surface.arrival(level, &from, direction)))
    })
}

/// Adds one receiver's hits to its lane.
fn sample_row(sampling: &Sampling, vertex: u32, lane: usize, scratch: &mut Scratch) -> RayCounts {
    let surface = sampling.surface;
    let mut counts = RayCounts::default();
    if let Some(kept) = kept_row(surface, sampling.rays) {
        for hit in kept.of_vertex(vertex, sampling.rays) {
            add_arrival(sampling, hit, lane, scratch, &mut counts);
            if counts.sees_nothing() {
                break;
            }
        }
        return counts;
    }
    for (index, (direction, hit)) in row_rays(surface, sampling.level, vertex, sampling.rays) {
        if hit.is_none() {
            scratch.escapes[lane].push((index, cell_of(direction) as u16));
        }
        add_arrival(sampling, hit, lane, scratch, &mut counts);
        if counts.sees_nothing() {
            break;
        }
    }
    counts
}

/// Adds where the next ray of a receiver arrives to its lane.
fn add_arrival(
    sampling: &Sampling,
    arrival: Option<Arrival>,
    lane: usize,
    scratch: &mut Scratch,
    counts: &mut RayCounts,
) {
    let is_first_half = counts.traced < sampling.rays / 2;
    counts.traced += 1;
    let Some(hit) = arrival else {
        counts.escaped += 1;
        return;
    };
    let Some(met) = sampling.surface.vertices.met(&hit) else {
        counts.inside += 1;
        return;
    };
    for (sender, weight) in met {
        let slot = sampling.slot_of_vertex[sender as usize];
        scratch.senders.add(slot, lane, weight, is_first_half);
    }
}

/// Arrivals that a study has kept, where they are enough.
fn kept_row(surface: &Surface, rays: u32) -> Option<&KeptArrivals> {
    let kept = surface.kept_arrivals.as_ref();
    kept.filter(|kept| kept.rays() >= rays)
}

/// Traces rays of every vertex of a seed, to keep them; `None`: the seed of the
/// rows. Returns `None` if the job was stopped.
pub(super) fn trace_arrivals(
    surface: &Surface,
    level: Level,
    (seed, rays): (Option<u32>, u32),
    progress: &dyn Progress,
) -> Option<KeptArrivals> {
    let seed = seed.unwrap_or(SEED);
    let vertices: Vec<u32> = (0..surface.vertices.len() as u32).collect();
    let mut kept = KeptArrivals::untraced(rays, vertices.len());
    let tasks = vertices.par_chunks(VERTICES_PER_TASK);
    tasks
        .zip(kept.rows_mut(VERTICES_PER_TASK))
        .try_for_each(|(vertices, rows)| {
            if progress.cancelled() {
                return None;
            }
            let rays_of = |&vertex| vertex_rays(surface, level, [seed, vertex], rays);
            let all = vertices.iter().flat_map(rays_of);
            rows.fill(all.map(|(_, (_, hit))| hit));
            progress.advance(vertices.len() as u64);
            Some(())
        })?;
    Some(kept)
}

/// Adds a row's rays that escaped to the cells of the sky, or what rays aimed at
/// the cells that are `open` to its group say of them where they are few.
fn add_sky(
    sampling: &Sampling,
    (vertex, lane): (u32, usize),
    counts: RayCounts,
    open: &[u16],
    scratch: &mut Scratch,
) {
    if kept_row(sampling.surface, sampling.rays).is_some() {
        // A study looks at what surfaces exchange; nobody asks its rows for the sky.
        return;
    }
    let share = f64::from(counts.escaped) / f64::from(counts.in_the_open());
    let escapes = &scratch.escapes[lane];
    if needs_aim(sampling, escapes, share) {
        for (cell, share) in aimed_shares(sampling, vertex, escapes, open) {
            let weight = share * sampling.rays as f32;
            scratch.cells.add(cell, lane, weight, true);
        }
    } else {
        for &(_, cell) in escapes {
            scratch.cells.add(u32::from(cell), lane, 1.0, true);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::sample_scenes::room_with_blocks;

    #[test]
    fn only_rows_that_see_nothing_stop_early() {
        let scene = room_with_blocks(true, 0.5, 64);
        let surface = Surface::both_sides(&scene);
        let level = Level::detect();
        let count = surface.vertices.len();
        let slots: Vec<u32> = (0..count as u32).collect();
        let sampling = Sampling {
            surface: &surface,
            level,
            slot_of_vertex: &slots,
            rays: 4 * RAYS_INTO_NOTHING,
        };
        let mut scratch = Scratch::new(count);
        let mut stopped = 0;
        for vertex in slots.iter().copied() {
            let counts = sample_row(&sampling, vertex, 0, &mut scratch);
            if counts.traced == sampling.rays {
                assert!(counts.escaped < counts.traced, "vertex {vertex}");
            } else {
                let nothing = (RAYS_INTO_NOTHING, RAYS_INTO_NOTHING);
                assert_eq!((counts.traced, counts.escaped), nothing, "vertex {vertex}");
                stopped += 1;
            }
        }
        assert!(0 < stopped && stopped < count, "{stopped} of {count}");
    }
}
