use super::sampled::{Sampling, Scratch, sample};
use crate::bake::transfer;
use crate::maths::order::Order;
use crate::maths::spherical_harmonics::CONSTANT;
use crate::scene::sample_scenes::room_with_blocks;
use crate::simd::Level;
use crate::surface::Surface;

/// The first slice is T times a constant: sums of the same weights, in another
/// order of additions.
#[test]
fn the_first_slice_is_the_transfer() {
    let scene = room_with_blocks(true, 0.5, 256);
    let surface = Surface::both_sides(&scene);
    let level = Level::detect();
    let count = surface.vertices.len();
    let slots: Vec<u32> = (0..count as u32).collect();
    let rows = transfer::Sampling {
        surface: &surface,
        level,
        slot_of_vertex: &slots,
        rays: 256,
    };
    let slices = Sampling {
        surface: &surface,
        level,
        slot_of_vertex: &slots,
        rays: 256,
    };
    let mut scratch = Scratch::new(count);
    let mut row_scratch = transfer::Scratch::new(count);
    let mut compared = 0;
    for vertex in slots.iter().copied().step_by(7) {
        let row = transfer::sample_group(&rows, &[vertex], &mut row_scratch);
        let slices = sample(&slices, vertex, &mut scratch);
        assert_eq!(row.entries.len(), slices.entries.len(), "vertex {vertex}");
        for ((sender, weights), (other, slice)) in row.entries.iter().zip(&slices.entries) {
            assert_eq!(sender, other);
            let off = (slice[0] - CONSTANT * weights[0]).abs();
            assert!(
                off <= 1e-6 * weights[0].at_least(1e-3),
                "{vertex} {sender}: {off:e}"
            );
            compared += 1;
        }
    }
    assert!(compared > 1000, "{compared} entries");
}
