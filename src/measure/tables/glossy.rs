//! Table of the chapter of glossy surfaces.

use super::{in_percent, percent, table};
use crate::measure::glossy::GlossyError;
use crate::report::{Block, Cell, Column, Row};

/// Errors of the slices by roughness.
pub(in crate::measure) fn glossy_errors(errors: &[GlossyError]) -> Block {
    let row = |it: &GlossyError| {
        let mut cells = vec![Cell::Number(f64::from(it.roughness))];
        cells.extend([it.relative_rmse, it.noise, it.bias].map(in_percent));
        Row::plain(cells)
    };
    let columns = vec![
        Column::number("roughness", "", 1),
        percent("relRMSE", 2),
        percent("noise of the reference", 2),
        percent("bias", 2),
    ];
    let rows = errors.iter().map(row).collect();
    table(
        "glossy-errors",
        "The final glossy bounce by 16 slices against paths.",
        columns,
        rows,
    )
}
