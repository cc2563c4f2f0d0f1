//! Noise of the rays taken out of a partition's factors by averaging over
//! neighbouring receivers.
//!
//! What a component brings to a receiver changes slowly over the surface, but
//! for contacts and the edges of shadows, while the noise of the rays is
//! independent from receiver to receiver. So every component's column of U is
//! averaged over neighbours as many times as pays: after s steps F of averaging,
//! with u the sampled column and d a sample of its noise alone,
//!
//!   |F u - u|^2 + 2 <d, F d> - |d|^2
//!
//! estimates what F u is off by (Mallows 1973, Stein 1981, with the covariance
//! from d), and the number of steps with the least is taken. The same estimate
//! tells what a component is worth; one that is worth nothing goes.
//!
//! d is half the difference between the first and the last half of the rays. Were
//! the halves independent, the estimate would be without bias; as points of one
//! scrambled set they are not, and d has 0.4 to 4.4 times the energy of the noise
//! (toy rows: some 0.5 at 2,048 rays, 3 at 1,024, 4 at 3,072, where
//! it counts half for that, `NOISE_COUNTS` of `part`). Halves that were
//! scrambled each for itself made all of it worse, since one set of 3,072 points
//! is so much better than two of 1,536: error of one bounce 1.53 for 1.37 % in
//! cornell, 3.12 for 2.75 % (95th percentile 11.2 for 7.0) in the window's room,
//! under lights that bakes stated their error by at the time.
//!
//! Error of one bounce in per cent without and with averaging, at 1,024 rays and
//! 21,000 vertices of the window's room: all lights 5.0 and 4.3, suns 9.4 and 7.6,
//! skies 7.0 and 3.8. At 3,072 rays (the table of methods, means of five scenes) 2.49
//! and 2.41, at the 95th percentile 6.8 and 6.0.

use super::factor::{Factors, Matrix};
use crate::bake::basis::Basis;
use crate::bake::graph::VertexGraph;

/// Steps of averaging at most; those tried are 0 and the powers of 2. (256
/// changed no figure by more than a hundredth.)
const MOST_STEPS: u32 = 64;

/// Who is next to whom among the receivers of a partition.
pub(super) struct Neighbours {
    offsets: Vec<usize>,
    receivers: Vec<u32>,
}

impl Neighbours {
    /// Neighbours inside a part, by their place in it.
    pub(super) fn of_part(graph: &VertexGraph, basis: &Basis, part: u32) -> Self {
        let slots = basis.slot_range(part);
        let (mut offsets, mut receivers) = (vec![0], Vec::new());
        for &vertex in &basis.vertex_of_slot()[slots.clone()] {
            let beside = graph.neighbours(vertex).iter();
            let beside = beside.map(|&v| basis.slot_of_vertex()[v as usize] as usize);
            receivers.extend(
                beside
                    .filter(|slot| slots.contains(slot))
                    .map(|slot| (slot - slots.start) as u32),
            );
            offsets.push(receivers.len());
        }
        Self { offsets, receivers }
    }

    fn of(&self, receiver: usize) -> &[u32] {
        &self.receivers[self.offsets[receiver]..self.offsets[receiver + 1]]
    }

    /// One step: half of a receiver's values, and half of its neighbours' mean.
    fn averaged(&self, values: &Matrix) -> Matrix {
        let mut out = Matrix::zero(values.rows, values.columns);
        let rows = out.values.chunks_exact_mut(values.columns);
        for (receiver, sums) in rows.enumerate() {
            let own = values.row(receiver);
            let beside = self.of(receiver);
            if beside.is_empty() {
                sums.copy_from_slice(own);
                continue;
            }
            for &other in beside {
                for (sum, value) in sums.iter_mut().zip(values.row(other as usize)) {
                    *sum += value;
                }
            }
            let share = 0.5 / beside.len() as f32;
            for (sum, value) in sums.iter_mut().zip(own) {
                *sum = *sum * share + 0.5 * value;
            }
        }
        out
    }
}

/// Averages the columns of U, sets what each component is worth, and sorts them
/// by it. `noise` is a sample of the noise in U alone; both hold values times
/// `roots_of_area`.
pub(super) fn smooth(
    factors: &mut Factors,
    noise: &Matrix,
    roots_of_area: &[f32],
    neighbours: &Neighbours,
) {
    let rank = factors.left.columns;
    let mut columns = Columns::new(&factors.left, noise, roots_of_area);
    let mut best = Best::new(rank, factors.left.rows);
    for step in 0..=MOST_STEPS {
        if step == 0 || step.is_power_of_two() {
            best.take(&columns);
        }
        if step < MOST_STEPS {
            columns.now = neighbours.averaged(&columns.now);
        }
    }
    let worth = |(component, energy): (usize, &f64)| {
        let gain = columns.energy(component) - best.risks[component];
        if gain > 0.0 { energy * gain } else { 0.0 }
    };
    let energies: Vec<f64> = factors.energies.iter().enumerate().map(worth).collect();
    for (row, root) in best
        .columns
        .values
        .chunks_exact_mut(rank.max(1))
        .zip(roots_of_area)
    {
        row.iter_mut().for_each(|value| *value *= root);
    }
    factors.left = best.columns;
    sort_by_energy(factors, energies);
}

/// U and its noise side by side, a value a receiver (without the area).
struct Columns {
    /// Square of each root: the areas that errors are weighted by.
    areas: Vec<f64>,
    start: Matrix,
    now: Matrix,
}

impl Columns {
    fn new(left: &Matrix, noise: &Matrix, roots_of_area: &[f32]) -> Self {
        let rank = left.columns;
        let mut start = Matrix::zero(left.rows, 2 * rank);
        let rows = start.values.chunks_exact_mut((2 * rank).max(1));
        for (receiver, row) in rows.enumerate() {
            let root = roots_of_area[receiver];
            for component in 0..rank {
                row[component] = left.row(receiver)[component] / root;
                row[rank + component] = noise.row(receiver)[component] / root;
            }
        }
        let square = |&root: &f32| f64::from(root) * f64::from(root);
        Self {
            areas: roots_of_area.iter().map(square).collect(),
            now: start.clone(),
            start,
        }
    }

    fn rank(&self) -> usize {
        self.start.columns / 2
    }

    /// |u|^2 of a component.
    fn energy(&self, component: usize) -> f64 {
        let terms = self.areas.iter().enumerate().map(|(receiver, area)| {
            let value = f64::from(self.start.row(receiver)[component]);
            area * value * value
        });
        terms.sum()
    }

    /// |F u - u|^2 + 2 <d, F d> of every component. (|d|^2 is the same for
    /// every F.)
    fn risks(&self) -> Vec<f64> {
        let rank = self.rank();
        let mut risks = vec![0.0; rank];
        for (receiver, area) in self.areas.iter().enumerate() {
            let (now, start) = (self.now.row(receiver), self.start.row(receiver));
            for (component, risk) in risks.iter_mut().enumerate() {
                let change = f64::from(now[component]) - f64::from(start[component]);
                let kept = f64::from(now[rank + component]) * f64::from(start[rank + component]);
                *risk += area * (change * change + 2.0 * kept);
            }
        }
        risks
    }
}

/// The averages with the least risk so far.
struct Best {
    risks: Vec<f64>,
    columns: Matrix,
}

impl Best {
    fn new(rank: usize, rows: usize) -> Self {
        Self {
            risks: vec![f64::INFINITY; rank],
            columns: Matrix::zero(rows, rank),
        }
    }

    fn take(&mut self, columns: &Columns) {
        let risks = columns.risks();
        let is_better: Vec<bool> = risks.iter().zip(&self.risks).map(|(a, b)| a < b).collect();
        let rank = risks.len().max(1);
        let rows = self.columns.values.chunks_exact_mut(rank).enumerate();
        for (receiver, row) in rows {
            let now = &columns.now.row(receiver)[..rank];
            for ((best, value), better) in row.iter_mut().zip(now).zip(&is_better) {
                if *better {
                    *best = *value;
                }
            }
        }
        for (best, risk) in self.risks.iter_mut().zip(risks) {
            if risk < *best {
                *best = risk;
            }
        }
    }
}

/// Puts the components that are worth most first.
fn sort_by_energy(factors: &mut Factors, energies: Vec<f64>) {
    let mut order: Vec<usize> = (0..energies.len()).collect();
    order.sort_by(|&a, &b| energies[b].total_cmp(&energies[a]).then(a.cmp(&b)));
    let sorted = |matrix: &Matrix| Matrix {
        values: matrix
            .values
            .chunks_exact(matrix.columns.max(1))
            .flat_map(|row| order.iter().map(|&component| row[component]))
            .collect(),
        ..*matrix
    };
    factors.left = sorted(&factors.left);
    factors.right = sorted(&factors.right);
    factors.noise_of_right = sorted(&factors.noise_of_right);
    factors.energies = order.iter().map(|&component| energies[component]).collect();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::uniform;

    /// A ring of receivers.
    fn ring(count: usize) -> Neighbours {
        let beside = |i: usize| [(i + count - 1) % count, (i + 1) % count];
        Neighbours {
            offsets: (0..=count).map(|i| 2 * i).collect(),
            receivers: (0..count).flat_map(beside).map(|i| i as u32).collect(),
        }
    }

    /// A component of `signal` over a ring, with noise of +-`noise`; returns its
    /// root mean square errors before and after, and what it is worth.
    fn errors(signal: impl Fn(usize) -> f32, noise: f32) -> ([f32; 2], f64) {
        let count = 200;
        let half = |which: u32, i: usize| noise * (2.0 * uniform(which, i as u32, 0) - 1.0);
        let column = |value: &dyn Fn(usize) -> f32| Matrix {
            rows: count,
            columns: 1,
            values: (0..count).map(value).collect(),
        };
        let left = column(&|i| signal(i) + half(1, i) + half(2, i));
        let sample = column(&|i| half(1, i) - half(2, i));
        let mut factors = Factors {
            right: column(&|_| 1.0),
            left: left.clone(),
            energies: vec![1.0],
            noise_of_right: column(&|_| 0.0),
        };
        smooth(&mut factors, &sample, &[1.0; 200], &ring(count));
        let error = |found: &Matrix| {
            let values = found.values.iter().enumerate();
            let off = values.map(|(i, v)| v - signal(i));
            let squares: f32 = off.map(|off| off * off).sum();
            (squares / count as f32).sqrt()
        };
        ([error(&left), error(&factors.left)], factors.energies[0])
    }

    #[test]
    fn what_changes_slowly_loses_most_of_its_noise() {
        let slow = |i: usize| 1.0 + 0.5 * crate::maths::functions::sin_f32(i as f32 / 32.0);
        let ([before, after], worth) = errors(slow, 0.2);
        assert!(after < 0.4 * before, "{before} to {after}");
        assert!(worth > 0.0);
    }

    #[test]
    fn an_edge_is_not_washed_out() {
        let edge = |i: usize| if i < 100 { 1.0 } else { 0.0 };
        let ([before, after], _) = errors(edge, 0.02);
        assert!(after <= before, "{before} to {after}");
    }

    #[test]
    fn without_noise_nothing_changes_and_noise_alone_is_worth_little() {
        let jagged = |i: usize| uniform(9, i as u32, 0);
        let ([_, after], worth) = errors(jagged, 0.0);
        assert_eq!(after, 0.0);
        let (_, of_noise) = errors(|_| 0.0, 1.0);
        assert!(of_noise < 0.1 * worth, "{of_noise} of {worth}");
    }

    #[test]
    fn components_are_sorted_by_worth() {
        let mut factors = Factors {
            left: Matrix {
                rows: 1,
                columns: 3,
                values: vec![1.0, 2.0, 3.0],
            },
            right: Matrix {
                rows: 2,
                columns: 3,
                values: vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
            },
            ..Factors::default()
        };
        sort_by_energy(&mut factors, vec![1.0, 0.0, 5.0]);
        assert_eq!(factors.left.values, [3.0, 1.0, 2.0]);
        assert_eq!(factors.right.values, [3.0, 1.0, 2.0, 6.0, 4.0, 5.0]);
        assert_eq!(factors.energies, [5.0, 1.0, 0.0]);
    }
}
