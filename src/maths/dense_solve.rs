//! Small dense systems of linear equations.

/// Solves A x = b for several right sides by elimination with partial pivoting
/// (Golub and Van Loan, "Matrix Computations", section 3.4): `N` equations, the
/// solutions in place of the right sides, each a column given as a row here.
///
/// The matrix must be regular; a singular one gives numbers that are not finite.
pub(crate) fn solve<const N: usize>(mut matrix: [[f64; N]; N], right_sides: &mut [[f64; N]]) {
    for column in 0..N {
        let pivot = largest_below(&matrix, column);
        matrix.swap(column, pivot);
        right_sides.iter_mut().for_each(|b| b.swap(column, pivot));
        for row in column + 1..N {
            let factor = matrix[row][column] / matrix[column][column];
            for k in column..N {
                matrix[row][k] -= factor * matrix[column][k];
            }
            right_sides
                .iter_mut()
                .for_each(|b| b[row] -= factor * b[column]);
        }
    }
    for b in right_sides {
        for row in (0..N).rev() {
            let known: f64 = (row + 1..N).map(|k| matrix[row][k] * b[k]).sum();
            b[row] = (b[row] - known) / matrix[row][row];
        }
    }
}

/// The row from the diagonal on with the largest magnitude in a column, the first
/// of equal ones.
fn largest_below<const N: usize>(matrix: &[[f64; N]; N], column: usize) -> usize {
    let magnitude = |row: usize| matrix[row][column].abs();
    (column + 1..N).fold(column, |best, row| {
        if magnitude(row) > magnitude(best) {
            row
        } else {
            best
        }
    })
}

/// The inverse of a regular matrix.
pub(crate) fn inverse<const N: usize>(matrix: [[f64; N]; N]) -> [[f64; N]; N] {
    let mut columns = [[0.0; N]; N];
    (0..N).for_each(|k| columns[k][k] = 1.0);
    solve(matrix, &mut columns);
    std::array::from_fn(|row| std::array::from_fn(|column| columns[column][row]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::uniform;
    use crate::maths::order::Order;

    /// Largest magnitude of A x - b, for tests of what was solved.
    fn residual<const N: usize>(matrix: &[[f64; N]; N], x: &[f64; N], b: &[f64; N]) -> f64 {
        let row = |row: usize| {
            let sum: f64 = (0..N).map(|k| matrix[row][k] * x[k]).sum();
            (sum - b[row]).abs()
        };
        (0..N).map(row).fold(0.0, |a, b| a.at_least(b))
    }

    #[test]
    fn solutions_satisfy_their_equations() {
        for seed in 0..50 {
            let value = |k: usize| f64::from(uniform(seed, k as u32, 0)) - 0.5;
            let matrix: [[f64; 7]; 7] =
                std::array::from_fn(|i| std::array::from_fn(|k| value(i * 7 + k)));
            let sides: [[f64; 7]; 2] =
                std::array::from_fn(|i| std::array::from_fn(|k| value(100 + i * 7 + k)));
            let mut solved = sides;
            solve(matrix, &mut solved);
            for (x, b) in solved.iter().zip(&sides) {
                assert!(residual(&matrix, x, b) < 1e-11, "seed {seed}");
            }
        }
    }

    #[test]
    fn a_pivot_of_zero_is_swapped_away() {
        let inverse = inverse([[0.0, 2.0], [4.0, 0.0]]);
        assert_eq!(inverse, [[0.0, 0.25], [0.5, 0.0]]);
    }
}
