//! Least squares with solutions that are not negative: the active-set method of Lawson and Hanson
//! (*Solving Least Squares Problems*, 1974, chapter 23).

use nalgebra::{DMatrix, DVector};

/// The x >= 0 that makes |A x - b| smallest. `None` if a number is not finite.
pub fn solve(matrix: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    if matrix.nrows() != right.len() || matrix.iter().chain(right.iter()).any(|v| !v.is_finite()) {
        return None;
    }
    // Columns of length 1: counts differ by orders of magnitude, and a gradient compares them.
    let lengths: Vec<f64> = matrix
        .column_iter()
        .map(|column| column.norm())
        .map(|length| if length > 0.0 { length } else { 1.0 })
        .collect();
    let scaled = DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |row, column| {
        matrix[(row, column)] / lengths[column]
    });
    let mut x = DVector::zeros(matrix.ncols());
    let mut free = vec![false; matrix.ncols()];
    let least = 1e-11 * right.norm().max(f64::MIN_POSITIVE);
    // Each round ends at a better x. A handful is enough; the limit ends a cycle that rounding
    // might cause.
    for _ in 0..10 * (matrix.ncols() + 1) {
        let gradient = scaled.tr_mul(&(right - &scaled * &x));
        let uphill = (0..free.len()).filter(|&k| !free[k] && gradient[k] > least);
        let Some(best) = uphill.max_by(|&a, &b| gradient[a].total_cmp(&gradient[b])) else { break };
        free[best] = true;
        while free.contains(&true) {
            let wanted = solve_free(&scaled, &free, right)?;
            let blocked = (0..free.len()).filter(|&k| free[k] && wanted[k] <= 0.0);
            // As far towards it as nothing becomes negative.
            let step = blocked.map(|k| x[k] / (x[k] - wanted[k])).fold(f64::INFINITY, f64::min);
            if step.is_infinite() {
                x = wanted;
                break;
            }
            let step = if step.is_finite() { step.clamp(0.0, 1.0) } else { 0.0 };
            x = &x + (wanted.clone() - &x) * step;
            for k in 0..free.len() {
                if free[k] && wanted[k] <= 0.0 && x[k] <= 1e-14 {
                    (free[k], x[k]) = (false, 0.0);
                }
            }
        }
    }
    Some(DVector::from_fn(matrix.ncols(), |k, _| x[k] / lengths[k]))
}

/// The unconstrained solution in the free columns; zero in the others.
fn solve_free(matrix: &DMatrix<f64>, free: &[bool], right: &DVector<f64>) -> Option<DVector<f64>> {
    let columns: Vec<usize> = (0..free.len()).filter(|&k| free[k]).collect();
    let part = matrix.select_columns(&columns);
    let solution = part.svd(true, true).solve(right, 1e-10).ok()?;
    let mut all = DVector::zeros(free.len());
    columns.iter().zip(solution.iter()).for_each(|(&k, &value)| all[k] = value);
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solved(rows: &[[f64; 3]], right: &[f64]) -> Vec<f64> {
        let matrix = DMatrix::from_fn(rows.len(), 3, |row, column| rows[row][column]);
        solve(&matrix, &DVector::from_row_slice(right)).unwrap().iter().copied().collect()
    }

    const ROWS: [[f64; 3]; 5] =
        [[1.0, 2.0, 1e6], [3.0, 1.0, 1e6], [0.0, 4.0, 5e6], [2.0, 2.0, 2e6], [5.0, 0.0, 1e6]];

    fn product(x: [f64; 3]) -> Vec<f64> {
        ROWS.iter().map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum()).collect()
    }

    #[test]
    fn a_solution_that_is_not_negative_is_found() {
        for x in [[1.0, 2.0, 3e-6], [0.0, 2.0, 0.0], [0.0, 0.0, 0.0], [7.0, 0.0, 1e-6]] {
            let found = solved(&ROWS, &product(x));
            for (found, x) in found.iter().zip(x) {
                assert!((found - x).abs() <= 1e-9 * x.max(1e-6), "{found} is not {x}");
            }
        }
    }

    #[test]
    fn a_negative_one_is_replaced_by_the_best_at_the_border() {
        let right = product([1.0, -2.0, 3e-6]);
        let found = solved(&ROWS, &right);
        assert!(found.iter().all(|&x| x >= 0.0) && found[1] == 0.0, "{found:?}");
        // Where it is free the gradient vanishes, elsewhere it points outwards: the conditions of
        // Kuhn and Tucker.
        let residual: Vec<f64> = product([found[0], found[1], found[2]])
            .iter()
            .zip(&right)
            .map(|(a, b)| b - a)
            .collect();
        for k in 0..3 {
            let gradient: f64 = ROWS.iter().zip(&residual).map(|(row, r)| row[k] * r).sum::<f64>();
            let scale: f64 = ROWS.iter().map(|row| row[k] * row[k]).sum::<f64>().sqrt();
            assert!(
                if found[k] > 0.0 {
                    gradient.abs() < 1e-8 * scale
                } else {
                    gradient < 1e-8 * scale
                },
                "{k}: {gradient}"
            );
        }
    }

    #[test]
    fn odd_systems_have_an_end() {
        assert_eq!(solved(&[[0.0; 3]; 2], &[1.0, 1.0]), [0.0; 3]);
        // Equal columns: any split is right, the sum is not.
        let found = solved(&[[1.0, 1.0, 0.0], [2.0, 2.0, 0.0]], &[3.0, 6.0]);
        assert!((found[0] + found[1] - 3.0).abs() < 1e-9, "{found:?}");
        let matrix = DMatrix::from_element(1, 1, f64::NAN);
        assert_eq!(solve(&matrix, &DVector::from_element(1, 1.0)), None);
    }
}
