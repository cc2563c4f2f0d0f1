//! Tables of the chapter of vertices.

use super::{BOUNCE_NAMES, in_percent, percent, table};
use crate::bake::{LIGHTS, LightErrors, Scheme, TestKind};
use crate::measure::run::{SchemeResult, Vertices};
use crate::measure::statistics::over_lights;
use crate::measure::vertices::{EXTREMES, test_lights};
use crate::report::{Block, Cell, Column, Row};

const EXTREME_NAMES: [&str; EXTREMES] =
    ["lamp 0.02 extents from a corner", "patch with a hard edge"];
const KINDS: [TestKind; 4] = [
    TestKind::Point,
    TestKind::Spot,
    TestKind::Sun,
    TestKind::Sky,
];

/// The columns of [`light_cells`].
fn light_columns() -> [Column; 4] {
    [
        percent("mean", 2),
        percent("95th percentile", 2),
        percent("worst", 2),
        percent("signed mean", 3),
    ]
}

fn light_cells(errors: LightErrors) -> [Cell; 4] {
    let cell = match errors.lights {
        0 => |_| Cell::Missing,
        _ => in_percent,
    };
    [errors.mean, errors.p95, errors.worst, errors.signed].map(cell)
}

/// Errors over the test lights.
pub(in crate::measure) fn vertex_errors(found: &Vertices) -> Block {
    let noise = found
        .truth
        .noise()
        .map(|it| over_lights(&test_lights(&it), |_| true));
    let mut rows = Vec::new();
    for scheme in &found.schemes {
        for which in 0..2 {
            let mut cells = name_cells(scheme, which);
            cells.extend(light_cells(scheme.errors.all(which)));
            let of_mean = scheme.errors.standard_error(which);
            cells.push(Cell::from(of_mean.map(|it| it * 100.0)));
            cells.push(in_percent(noise[which].mean));
            cells.push(Cell::Number(scheme.point.bytes_per_vertex));
            rows.push(Row::plain(cells));
        }
    }
    let mut columns = vec![Column::text("scheme"), Column::text("bounces")];
    columns.extend(light_columns());
    columns.push(percent("standard error of the mean error", 2));
    columns.push(percent("noise of the truth", 2));
    columns.push(Column::number("operator", "B/vertex", 0));
    table(
        "vertex-errors",
        "Relative error of indirect light at the vertices, over the test lights; the noise of the \
         truth is taken off in quadrature.",
        columns,
        rows,
    )
}

fn name_cells(scheme: &SchemeResult, which: usize) -> Vec<Cell> {
    vec![
        scheme.settings.scheme.name().into(),
        BOUNCE_NAMES[which].into(),
    ]
}

/// The same by kind of light.
pub(in crate::measure) fn errors_by_kind(found: &Vertices) -> Block {
    let mut rows = Vec::new();
    for kind in KINDS {
        let is_kind = |light: usize| found.truth.lights[light].kind == kind;
        if !(0..LIGHTS).any(is_kind) {
            continue;
        }
        for scheme in &found.schemes {
            for which in 0..2 {
                let errors = over_lights(&test_lights(&scheme.errors.by_bounces[which]), is_kind);
                let mut cells = vec![kind.name().into(), Cell::Number(errors.lights as f64)];
                cells.extend(name_cells(scheme, which));
                cells.extend(light_cells(errors));
                rows.push(Row::plain(cells));
            }
        }
    }
    let mut columns = vec![
        Column::text("lights"),
        Column::number("that arrive", "", 0),
        Column::text("scheme"),
        Column::text("bounces"),
    ];
    columns.extend(light_columns());
    table(
        "vertex-errors-by-kind",
        "The same by kind of light.",
        columns,
        rows,
    )
}

/// The same near contacts and away from them; nothing where nothing stands on
/// anything.
pub(in crate::measure) fn errors_by_contact(found: &Vertices) -> Option<Block> {
    let near = found.truth.share_near_contacts();
    if near == 0.0 {
        return None;
    }
    let places = [("within an edge length", near), ("elsewhere", 1.0 - near)];
    let mut rows = Vec::new();
    for (place, (name, share)) in places.into_iter().enumerate() {
        for scheme in &found.schemes {
            let mut cells = vec![name.into(), in_percent(share)];
            cells.push(scheme.settings.scheme.name().into());
            cells.extend(light_cells(scheme.errors.by_contact[place]));
            rows.push(Row::plain(cells));
        }
    }
    let mut columns = vec![
        Column::text("from a contact"),
        percent("of the area", 1),
        Column::text("scheme"),
    ];
    columns.extend(light_columns());
    Some(table(
        "vertex-errors-by-contact",
        "The same after one bounce near contacts, where walls and bodies stand on something, \
         each relative to the light that arrives there.",
        columns,
        rows,
    ))
}

/// An error that is more than the truth's own noise, if that is known.
fn known([error, _]: [f64; 2], noise: Option<f64>) -> Option<f64> {
    Some(error).filter(|&error| error > noise.unwrap_or(0.0))
}

/// The two extremes.
pub(in crate::measure) fn extremes(found: &Vertices) -> Block {
    let noise = found.truth.noise();
    let mut rows = Vec::new();
    for (number, name) in EXTREME_NAMES.into_iter().enumerate() {
        for scheme in &found.schemes {
            for which in 0..2 {
                let light = LIGHTS + number;
                let error = scheme.errors.by_bounces[which][light];
                let mut cells = vec![name.into()];
                cells.extend(name_cells(scheme, which));
                let noise = noise[which][light].map(|e| e[0]);
                let figures = [error.and_then(|e| known(e, noise)), error.map(|e| e[1])];
                let figures = figures.into_iter().chain([noise]);
                cells.extend(figures.map(|it| Cell::from(it.map(|it| it * 100.0))));
                rows.push(Row::plain(cells));
            }
        }
    }
    let columns = vec![
        Column::text("light"),
        Column::text("scheme"),
        Column::text("bounces"),
        percent("error", 2),
        percent("signed", 3),
        percent("noise of the truth", 2),
    ];
    table(
        "extreme-lights",
        "Lights beyond what the defaults are for, apart from the means above; an error is empty \
         where the truth's noise is as large.",
        columns,
        rows,
    )
}

/// Where the error after one bounce comes from.
pub(in crate::measure) fn parts(found: &Vertices) -> Block {
    let sampling = found.truth.vertex_sampling();
    let mut rows = Vec::new();
    for scheme in &found.schemes {
        let parts = &scheme.parts;
        for (what, errors) in [
            ("total", scheme.errors.all(0)),
            ("noise of the sampled rows", parts.noise),
            ("basis", parts.basis),
            ("compression", parts.compression),
        ] {
            let mut cells = vec![scheme.settings.scheme.name().into(), what.into()];
            cells.extend(light_cells(errors));
            rows.push(Row::plain(cells));
        }
    }
    let mut cells = vec!["both".into(), "vertex sampling".into()];
    cells.extend(light_cells(sampling));
    rows.push(Row::plain(cells));
    let mut columns = vec![Column::text("scheme"), Column::text("part")];
    columns.extend(light_columns());
    table(
        "error-parts",
        "Parts of the error after one bounce. They do not sum up: a low-rank product takes off a \
         good part of the noise.",
        columns,
        rows,
    )
}

/// Some vertices against the path tracer.
pub(in crate::measure) fn paths(found: &Vertices) -> Block {
    let mut rows = Vec::new();
    for light in &found.paths {
        for (scheme, light) in Scheme::ALL.iter().zip(light) {
            let mut cells = vec![light.kind.name().into(), scheme.name().into()];
            let figures = match &light.found {
                Some(it) => [
                    Some(it.error),
                    Some(it.noise[0]),
                    it.corrected(),
                    light.vertex_sampling,
                    Some(it.signed),
                    Some(it.noise[1]),
                ],
                None => [None; 6],
            };
            cells.extend(figures.map(|it| Cell::from(it.map(|it| it * 100.0))));
            rows.push(Row::plain(cells));
        }
    }
    let columns = vec![
        Column::text("light"),
        Column::text("scheme"),
        percent("found", 2),
        percent("standard error of the paths", 2),
        percent("error without it", 2),
        percent("vertex sampling", 2),
        percent("signed", 3),
        percent("standard error of their sum", 3),
    ];
    table(
        "vertices-against-paths",
        "Indirect light of four bounces in the scene's colours at random vertices, against paths; \
         their standard error is taken off in quadrature; empty where it hides the error. Vertex \
         sampling is the part of one bounce.",
        columns,
        rows,
    )
}
