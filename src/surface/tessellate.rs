//! Conforming tessellation of coarse input.
//!
//! An edge is halved if it is longer than a limit. The rule and the midpoint
//! depend on nothing but the two end positions and are symmetric in them, so
//! two triangles that share an edge cut it in the same places, whatever their
//! other corners are: no T-junction is made. Edges inside a source triangle
//! follow the same rule.

use glam::Vec3;

/// Edges up to this much longer than the limit stay whole, so that rounding
/// (a room far from the origin) does not decide about edges of exactly the
/// limit's length.
const LENGTH_SLACK: f32 = 1.0 + 1e-4;

/// A corner of a piece: its position and where it lies in the source triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PieceCorner {
    /// Placed units.
    pub(super) position: Vec3,
    /// Barycentric coordinates in the source triangle (dyadic and exact, unless
    /// it is cut along contacts).
    pub(super) source_barycentrics: Vec3,
}

/// Cuts one triangle until no edge is longer than `max_edge` (placed units)
/// and hands over the pieces, which have the orientation of the source.
pub(super) fn tessellate(
    corners: [Vec3; 3],
    max_edge: f32,
    emit: &mut impl FnMut([PieceCorner; 3]),
) {
    let unit = [Vec3::X, Vec3::Y, Vec3::Z];
    let piece = [0, 1, 2].map(|k| PieceCorner {
        position: corners[k],
        source_barycentrics: unit[k],
    });
    tessellate_piece(piece, max_edge, emit);
}

/// The same for a piece of a triangle.
pub(super) fn tessellate_piece(
    piece: [PieceCorner; 3],
    max_edge: f32,
    emit: &mut impl FnMut([PieceCorner; 3]),
) {
    split(piece, limit_squared(max_edge), emit);
}

/// Hands over the points at which tessellation cuts an edge, in its direction.
pub(super) fn halve(
    from: PieceCorner,
    to: PieceCorner,
    max_edge: f32,
    emit: &mut impl FnMut(PieceCorner),
) {
    if is_long(from.position, to.position, limit_squared(max_edge)) {
        let middle = middle(from, to);
        halve(from, middle, max_edge, emit);
        emit(middle);
        halve(middle, to, max_edge, emit);
    }
}

fn limit_squared(max_edge: f32) -> f32 {
    let limit = max_edge * LENGTH_SLACK;
    limit * limit
}

/// Whether tessellation would cut the edge between two positions.
fn is_long(a: Vec3, b: Vec3, limit_squared: f32) -> bool {
    (a - b).length_squared() > limit_squared
}

fn middle(a: PieceCorner, b: PieceCorner) -> PieceCorner {
    PieceCorner {
        position: (a.position + b.position) * 0.5,
        source_barycentrics: (a.source_barycentrics + b.source_barycentrics) * 0.5,
    }
}

fn split(piece: [PieceCorner; 3], limit_squared: f32, emit: &mut impl FnMut([PieceCorner; 3])) {
    let long = [0, 1, 2].map(|k| {
        is_long(
            piece[k].position,
            piece[(k + 1) % 3].position,
            limit_squared,
        )
    });
    match long.iter().filter(|&&l| l).count() {
        0 => emit(piece),
        1 => {
            let k = long.iter().position(|&l| l).expect("one edge is long");
            let [a, b, c] = rotated(piece, k);
            let m = middle(a, b);
            split([a, m, c], limit_squared, emit);
            split([m, b, c], limit_squared, emit);
        }
        2 => {
            // Start at the end of the short edge: the long ones follow it.
            let short = long.iter().position(|&l| !l).expect("one edge is short");
            let [a, b, c] = rotated(piece, (short + 1) % 3);
            let (ab, bc) = (middle(a, b), middle(b, c));
            split([ab, b, bc], limit_squared, emit);
            let to_c = (ab.position - c.position).length_squared();
            let to_a = (bc.position - a.position).length_squared();
            if to_c < to_a {
                split([a, ab, c], limit_squared, emit);
                split([ab, bc, c], limit_squared, emit);
            } else {
                split([a, ab, bc], limit_squared, emit);
                split([a, bc, c], limit_squared, emit);
            }
        }
        _ => {
            let [a, b, c] = piece;
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            for part in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                split(part, limit_squared, emit);
            }
        }
    }
}

fn rotated(piece: [PieceCorner; 3], first: usize) -> [PieceCorner; 3] {
    [piece[first], piece[(first + 1) % 3], piece[(first + 2) % 3]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::order::Order;

    fn pieces(corners: [Vec3; 3], max_edge: f32) -> Vec<[PieceCorner; 3]> {
        let mut out = Vec::new();
        tessellate(corners, max_edge, &mut |p| out.push(p));
        out
    }

    #[test]
    fn a_fine_triangle_stays_as_it_is() {
        let t = [Vec3::ZERO, Vec3::X * 0.1, Vec3::Y * 0.1];
        assert_eq!(pieces(t, 0.2).len(), 1);
    }

    #[test]
    fn pieces_keep_area_and_orientation_and_are_short() {
        for t in [
            [Vec3::ZERO, Vec3::X, Vec3::Y],
            [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 0.01, 0.0)],
            [
                Vec3::ZERO,
                Vec3::new(0.7, 0.1, 0.0),
                Vec3::new(-0.9, 0.4, 0.0),
            ],
        ] {
            let cross = |p: &[Vec3; 3]| (p[1] - p[0]).cross(p[2] - p[0]).z;
            let whole = cross(&t);
            let mut sum = 0.0;
            for p in pieces(t, 0.11) {
                let p = p.map(|c| c.position);
                assert!(cross(&p) > 0.0, "a piece is turned over");
                sum += cross(&p);
                for k in 0..3 {
                    assert!((p[k] - p[(k + 1) % 3]).length() <= 0.11 * LENGTH_SLACK * 1.001);
                }
            }
            assert!(
                (sum - whole).abs() < 1e-5 * whole.at_least(0.1),
                "{sum} {whole}"
            );
        }
    }

    #[test]
    fn a_shared_edge_is_cut_in_the_same_places_from_both_sides() {
        let (a, b) = (Vec3::new(0.1, 0.7, 0.3), Vec3::new(-0.6, 0.2, 0.9));
        let on_edge = |t: [Vec3; 3]| {
            let mut found: Vec<[u32; 3]> = pieces(t, 0.07)
                .iter()
                .flatten()
                .filter(|c| c.source_barycentrics.z == 0.0)
                .map(|c| c.position.to_array().map(f32::to_bits))
                .collect();
            found.sort_unstable();
            found.dedup();
            found
        };
        let left = on_edge([a, b, Vec3::new(0.9, 0.9, 0.9)]);
        let right = on_edge([b, a, Vec3::new(-0.3, -0.9, 0.1)]);
        assert!(left.len() > 10);
        assert_eq!(left, right);
    }
}
