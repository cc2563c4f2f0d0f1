//! A few rays of a bake that is not made yet: what they meet, and how long the
//! others will take.

use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::RunSettings;
use super::transfer::{GROUP, Sampling, Scratch, row_rays, sample_group};
use crate::maths::cube_cells::cell_of;
use crate::simd::Level;
use crate::surface::{NONE, Surface};

/// Rays of a survey in all. At the share of 1e-4 that makes a scene open, 13 of
/// them escape; four times as many take a quarter of a second.
const SURVEY_RAYS: usize = 1 << 17;
/// Rays of a survey from each vertex, at least. 64 from a quarter of the vertices
/// were no closer to the bytes of five bakes.
const LEAST_RAYS: u32 = 16;
/// A pilot's rows are begun for so long.
const PILOT_TIME: Duration = Duration::from_millis(250);
/// Rows of a pilot, at most.
const MOST_ROWS: usize = 2_000;
/// Rays of a row of a pilot, at most; a longer row takes as much more time.
const MOST_RAYS_A_ROW: u32 = 4_096;
/// 2^32 over the golden ratio: multiples of it, modulo 2^32, are spread evenly
/// however many there are.
const GOLDEN_STEP: u32 = 0x9e37_79b9;

/// What the first rays of one group of receivers met.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct GroupView {
    /// Receivers, at most [`GROUP`].
    pub(super) receivers: usize,
    /// Sum over the receivers of the share of rays that escaped, of those that
    /// met no inside of a body.
    pub(super) escaped: f64,
    /// Different vertices that rays arrived at, times the rays of a row over
    /// those of the survey: more than a whole row meets.
    pub(super) most_senders: f64,
    /// Different cells of the sky that rays escaped to, likewise.
    pub(super) most_cells: f64,
    /// Functions of the components that rays arrived at.
    pub(super) functions: usize,
}

/// What the first rays of all vertices, or of vertices spread evenly, meet.
pub(super) struct Survey {
    pub(super) groups: Vec<GroupView>,
    /// Seconds that a ray took on the threads of the current pool.
    pub(super) seconds_a_ray: f64,
}

/// What a survey asks of a bake.
pub(super) struct SurveyJob<'a> {
    pub(super) surface: &'a Surface,
    pub(super) level: Level,
    /// Receivers, a group at a time.
    pub(super) groups: &'a [Vec<u32>],
    /// Rays of a row of the bake.
    pub(super) rays: u32,
    /// Component of each vertex.
    pub(super) component_of: &'a [u32],
    /// Basis functions of each component.
    pub(super) functions_of_component: &'a [usize],
}

impl SurveyJob<'_> {
    /// Traces the rays: always the same for a scene.
    pub(super) fn survey(&self) -> Survey {
        let affordable = (SURVEY_RAYS / (GROUP * self.groups.len().max(1))) as u32;
        let rays = affordable.max(LEAST_RAYS).min(self.rays.max(1));
        let stride = (self.groups.len() * GROUP * rays as usize).div_ceil(SURVEY_RAYS);
        let start = Instant::now();
        let groups: Vec<GroupView> = self
            .groups
            .par_iter()
            .step_by(stride.max(1))
            .map(|group| self.view(group, rays))
            .collect();
        let receivers: usize = groups.iter().map(|group| group.receivers).sum();
        let traced = (receivers * rays as usize).max(1);
        Survey {
            groups,
            seconds_a_ray: start.elapsed().as_secs_f64() / traced as f64,
        }
    }

    fn view(&self, group: &[u32], rays: u32) -> GroupView {
        let mut view = GroupView {
            receivers: group.len(),
            ..GroupView::default()
        };
        let (mut senders, mut cells) = (Vec::new(), Vec::new());
        for &vertex in group {
            let (mut escaped, mut inside) = (0_u32, 0_u32);
            for (_, (direction, hit)) in row_rays(self.surface, self.level, vertex, rays) {
                let Some(hit) = hit else {
                    escaped += 1;
                    cells.push(cell_of(direction));
                    continue;
                };
                let corners = self.surface.vertices.of_triangle(hit.triangle, hit.front);
                inside += u32::from(corners == [NONE; 3]);
                senders.extend(corners.into_iter().filter(|&corner| corner != NONE));
            }
            view.escaped += f64::from(escaped) / f64::from((rays - inside).max(1));
        }
        let whole_rows = f64::from(self.rays) / f64::from(rays);
        view.most_senders = count_distinct(&mut senders) as f64 * whole_rows;
        view.most_cells = count_distinct(&mut cells) as f64 * whole_rows;
        let component = |vertex: u32| self.component_of[vertex as usize] as usize;
        let mut components: Vec<usize> = senders.into_iter().map(component).collect();
        count_distinct(&mut components);
        let functions = components.iter().map(|&c| self.functions_of_component[c]);
        view.functions = functions.sum();
        view
    }
}

/// Leaves each item once, and returns how many there are.
fn count_distinct<T: Ord>(items: &mut Vec<T>) -> usize {
    items.sort_unstable();
    items.dedup();
    items.len()
}

/// Share of the rays of front sides that escape, 0 to 1: the same for a scene
/// with and without back sides.
pub(crate) fn escaped_share_of_fronts(surface: &Surface, level: Level) -> f64 {
    let fronts = surface.vertices.front_count();
    let count = fronts.min(SURVEY_RAYS / LEAST_RAYS as usize);
    let rays = (SURVEY_RAYS / count.max(1)).min(MOST_RAYS_A_ROW as usize) as u32;
    let escapes = |place: usize| {
        let vertex = (place * fronts / count) as u32;
        let row = row_rays(surface, level, vertex, rays);
        row.filter(|(_, (_, hit))| hit.is_none()).count()
    };
    let escaped: Vec<usize> = (0..count).into_par_iter().map(escapes).collect();
    let escaped: usize = escaped.into_iter().sum();
    escaped as f64 / (count * rays as usize).max(1) as f64
}

/// Seconds that sampling a row takes on the threads of the current pool, the
/// mean over vertices spread evenly: as the bake does it, with the rays aimed at
/// windows too, where some rows take ten times as long as others.
pub(super) fn seconds_a_row(surface: &Surface, rays: u32, run: &RunSettings) -> f64 {
    let vertex_count = surface.vertices.len();
    let slot_of_vertex: Vec<u32> = (0..vertex_count as u32).collect();
    let sampling = Sampling {
        surface,
        level: run.level,
        slot_of_vertex: &slot_of_vertex,
        rays: rays.min(MOST_RAYS_A_ROW),
    };
    let vertex_of_row = |row: usize| {
        let place = (row as u32).wrapping_mul(GOLDEN_STEP);
        ((u64::from(place) * vertex_count as u64) >> 32) as u32
    };
    let start = Instant::now();
    let times: Vec<Duration> = (0..MOST_ROWS.min(vertex_count))
        .into_par_iter()
        .map_init(
            || Scratch::new(vertex_count),
            |scratch, row| {
                // One row is timed in any case: a busy machine may take longer to begin.
                let is_late = row > 0 && start.elapsed() > PILOT_TIME;
                if is_late || run.progress.cancelled() {
                    return None;
                }
                let row_start = Instant::now();
                sample_group(&sampling, &[vertex_of_row(row)], scratch);
                Some(row_start.elapsed())
            },
        )
        .flatten_iter()
        .collect();
    let mean = times.iter().sum::<Duration>().as_secs_f64() / times.len().max(1) as f64;
    let whole_rows = f64::from(rays) / f64::from(sampling.rays.max(1));
    // More threads than processors make each row take longer.
    #[allow(
        clippy::disallowed_methods,
        reason = "a forecast of seconds; no bit of a bake depends on it"
    )]
    let threads = rayon::current_num_threads();
    mean * whole_rows / threads as f64
}
