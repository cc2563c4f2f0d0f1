//! How many eigenvalues of a Laplacian lie below a number.

use super::dense::dot;
use super::laplacian::Laplacian;

/// A vertex with more neighbours than this is eliminated last: in the middle
/// of the order it would widen the envelope of all that follow. Meshes have 6
/// in the mean; caps of cylinders have hundreds.
const HUB_DEGREE: usize = 24;

/// Number of eigenvalues of `laplacian` below `sigma`, which must not be one.
///
/// Sylvester's law of inertia: L - sigma I = F D F^T has as many negative
/// pivots in D as it has negative eigenvalues. F is stored by rows from the
/// first entry of the row of L on (George and Liu 1981, chapter 4), in an
/// order that keeps those rows short.
pub(crate) fn eigenvalues_below(laplacian: &Laplacian, sigma: f64) -> usize {
    let envelope = Envelope::new(laplacian);
    envelope.negative_pivots(laplacian, sigma)
}

/// Lower triangle in a new order, row i from column `first[i]` to i.
struct Envelope {
    /// Old index by new index.
    order: Vec<u32>,
    /// New index by old index.
    rank: Vec<u32>,
    first: Vec<usize>,
    /// Start of each row in the list of entries.
    starts: Vec<usize>,
}

impl Envelope {
    fn new(laplacian: &Laplacian) -> Self {
        let order = elimination_order(laplacian);
        let mut rank = vec![0; order.len()];
        for (new, &old) in order.iter().enumerate() {
            rank[old as usize] = new as u32;
        }
        let first: Vec<usize> = order
            .iter()
            .enumerate()
            .map(|(new, &old)| {
                let ranks = laplacian.neighbours(old as usize).iter();
                ranks.fold(new, |first, &other| {
                    first.min(rank[other as usize] as usize)
                })
            })
            .collect();
        let mut starts = vec![0];
        for (new, &first) in first.iter().enumerate() {
            starts.push(starts[new] + new - first);
        }
        Self {
            order,
            rank,
            first,
            starts,
        }
    }

    /// Factorises row by row; only D is kept for counting.
    fn negative_pivots(&self, laplacian: &Laplacian, sigma: f64) -> usize {
        let size = self.order.len();
        let mut entries = vec![0.0; self.starts[size]];
        let mut pivots = Vec::with_capacity(size);
        for new in 0..size {
            let old = self.order[new] as usize;
            let (done, row) = entries.split_at_mut(self.starts[new]);
            let row = &mut row[..new - self.first[new]];
            for &other in laplacian.neighbours(old) {
                let column = self.rank[other as usize] as usize;
                if column < new {
                    row[column - self.first[new]] = -1.0;
                }
            }
            pivots.push(self.eliminate(done, row, &pivots, laplacian.degree(old) - sigma));
        }
        pivots.iter().filter(|&&pivot| pivot < 0.0).count()
    }

    /// Turns a row of L - sigma I into the row of F; returns its pivot.
    fn eliminate(&self, done: &[f64], row: &mut [f64], pivots: &[f64], diagonal: f64) -> f64 {
        let first = pivots.len() - row.len();
        // Entry by entry: row[c] becomes F[c] D[c].
        for column in first..pivots.len() {
            let above = &done[self.starts[column]..self.starts[column + 1]];
            let from = first.max(self.first[column]);
            let own = &row[from - first..column - first];
            row[column - first] -= dot(own, &above[from - self.first[column]..]);
        }
        let mut pivot = diagonal;
        for (entry, &above) in row.iter_mut().zip(&pivots[first..]) {
            let scaled = *entry / above;
            pivot -= scaled * *entry;
            *entry = scaled;
        }
        // A pivot of 0 would end the count; the smallest step away from it is
        // far below the gap that sigma lies in.
        if pivot == 0.0 { f64::EPSILON } else { pivot }
    }
}

/// Reverse Cuthill-McKee order (George and Liu 1981) with the hubs last.
fn elimination_order(laplacian: &Laplacian) -> Vec<u32> {
    let size = laplacian.size() as u32;
    let is_hub = |vertex: u32| laplacian.neighbours(vertex as usize).len() > HUB_DEGREE;
    let mut placed: Vec<bool> = (0..size).map(is_hub).collect();
    let mut order = Vec::with_capacity(size as usize);
    for start in 0..size {
        if !placed[start as usize] {
            let end = *levels(laplacian, start, &mut placed.clone())
                .last()
                .unwrap_or(&start);
            order.extend(levels(laplacian, end, &mut placed));
        }
    }
    order.reverse();
    order.extend((0..size).filter(|&vertex| is_hub(vertex)));
    order
}

/// Vertices that can be reached from `start`, breadth first, those of low
/// degree first.
fn levels(laplacian: &Laplacian, start: u32, placed: &mut [bool]) -> Vec<u32> {
    let mut order = vec![start];
    placed[start as usize] = true;
    let mut visited = 0;
    while visited < order.len() {
        let mut next: Vec<u32> = laplacian.neighbours(order[visited] as usize).to_vec();
        next.retain(|&vertex| !placed[vertex as usize]);
        next.sort_by_key(|&vertex| (laplacian.neighbours(vertex as usize).len(), vertex));
        next.iter()
            .for_each(|&vertex| placed[vertex as usize] = true);
        order.extend(next);
        visited += 1;
    }
    order
}

#[cfg(test)]
mod tests {
    use super::super::sample_graphs;
    use super::*;
    use crate::maths::functions::sin;

    #[test]
    fn counts_the_spectrum_of_a_path() {
        let laplacian = Laplacian::of_graph(&sample_graphs::path(30));
        // Eigenvalue k is 4 sin^2(pi k / 2n).
        let half_root = |k: usize| sin(std::f64::consts::PI * k as f64 / 60.0);
        let eigenvalue = |k: usize| 4.0 * half_root(k) * half_root(k);
        for count in 1..30 {
            let sigma = 0.5 * (eigenvalue(count - 1) + eigenvalue(count));
            assert_eq!(eigenvalues_below(&laplacian, sigma), count);
        }
    }

    #[test]
    fn hubs_and_pieces_are_counted() {
        // A star of 100 leaves has 0, 99 times 1, and 101.
        let star = Laplacian::of_graph(&sample_graphs::star(100));
        assert_eq!(eigenvalues_below(&star, 0.5), 1);
        assert_eq!(eigenvalues_below(&star, 50.0), 100);
        let boxes = Laplacian::of_graph(&sample_graphs::boxes(9));
        assert_eq!(eigenvalues_below(&boxes, 0.1), 9);
    }

    #[test]
    fn the_envelope_of_a_grid_is_narrow() {
        let laplacian = Laplacian::of_graph(&sample_graphs::triangle_grid(40, 20));
        let widest = *Envelope::new(&laplacian).starts.last().unwrap() / 800;
        assert!(widest <= 40, "mean row of {widest} entries");
    }
}
