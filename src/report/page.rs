//! `report.html`: the whole report on one page that needs no other file and no
//! network. Without scripts everything but the slider works.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::number::readable;
use super::{
    Block, Cell, Comparison, Fact, LabelledPicture, Picture, Plot, PngImage, Report, Row, Section,
    Table, colours, picture_path, plot, plot_path, table_path,
};

/// Anchors that the page itself has.
pub(super) const RESERVED_ANCHORS: [&str; 3] = ["contents", "report", "summary"];

const CSS: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");
/// Nothing is loaded from anywhere, whatever stands in the report.
const POLICY: &str = "default-src 'none'; img-src data:; \
                      style-src 'unsafe-inline'; script-src 'unsafe-inline'";

/// Pictures of a comparison that are less wide are shown larger, pixel by pixel.
const LEAST_WIDTH: u32 = 320;

/// The page.
pub(super) fn write(report: &Report) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                title { (report.title) }
                link rel="icon" href="data:,";
                style { (PreEscaped(colours::css())) (PreEscaped(CSS)) (PreEscaped(plot::CSS)) }
            }
            body {
                a .skip href="#report" { "Skip to the report" }
                (contents(report))
                main #report {
                    h1 { (report.title) }
                    @if !report.summary.is_empty() { (summary(&report.summary)) }
                    @for section in &report.sections { (draw_section(section)) }
                }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    page.into_string() + "\n"
}

fn contents(report: &Report) -> Markup {
    html! {
        nav #contents aria-label="Contents" {
            h2 { "Contents" }
            ul {
                @if !report.summary.is_empty() {
                    li { a href="#summary" { "Summary" } }
                }
                @for section in &report.sections {
                    li { a href={ "#" (section.anchor) } { (breakable(&section.heading)) } }
                }
            }
        }
    }
}

/// A text whose lines may break behind slashes, as those of paths should: a space
/// of no width stands there.
fn breakable(text: &str) -> String {
    text.replace('/', "/\u{200b}")
}

fn summary(facts: &[Fact]) -> Markup {
    html! {
        section #summary aria-label="Summary" {
            dl .facts {
                @for fact in facts {
                    div {
                        dt { (fact.label) }
                        dd .value { (fact.value) }
                        @if !fact.note.is_empty() { dd .note { (fact.note) } }
                    }
                }
            }
        }
    }
}

fn draw_section(section: &Section) -> Markup {
    let are_pictures =
        |a: &Block, b: &Block| matches!((a, b), (Block::Picture(_), Block::Picture(_)));
    html! {
        section #(section.anchor) {
            h2 {
                (section.heading) " "
                a .here href={ "#" (section.anchor) } aria-label="Link to this section" { "#" }
            }
            @for paragraph in &section.paragraphs { p { (paragraph) } }
            @for blocks in section.blocks.chunk_by(are_pictures) {
                @if blocks.len() > 1 {
                    div .gallery { @for block in blocks { (draw_block(block)) } }
                } @else {
                    @for block in blocks { (draw_block(block)) }
                }
            }
        }
    }
}

fn draw_block(block: &Block) -> Markup {
    match block {
        Block::Table(table) => draw_table(table),
        Block::Plot(plot) => draw_plot(plot),
        Block::Picture(picture) => draw_picture(picture),
        Block::Comparison(comparison) => draw_comparison(comparison),
    }
}

fn draw_table(table: &Table) -> Markup {
    let is_number: Vec<bool> = (0..table.columns.len())
        .map(|column| holds_numbers(table, column))
        .collect();
    let name = match table.caption.is_empty() {
        true => &table.name,
        false => &table.caption,
    };
    html! {
        figure .table #(table.name) {
            figcaption { (table.caption) " " (files(&[("CSV", table_path(&table.name))])) }
            // A wide table scrolls by itself; with a tab stop, by keyboard too.
            div .scroll role="region" tabindex="0" aria-label=(name) {
                table {
                    thead {
                        tr {
                            @for (column, is_number) in table.columns.iter().zip(&is_number) {
                                th scope="col" .number[*is_number] {
                                    (column.label)
                                    @if !column.unit.is_empty() {
                                        " " span .unit { (column.unit) }
                                    }
                                }
                            }
                        }
                    }
                    tbody {
                        @for row in &table.rows { (draw_row(table, row, &is_number)) }
                    }
                }
            }
        }
    }
}

/// Whether a column is set to the right: at least one number and no text.
fn holds_numbers(table: &Table, column: usize) -> bool {
    let mut cells = table.rows.iter().filter_map(|row| row.cells.get(column));
    let has_number = cells.clone().any(|cell| matches!(cell, Cell::Number(_)));
    has_number && !cells.any(|cell| matches!(cell, Cell::Text(_)))
}

fn draw_row(table: &Table, row: &Row, is_number: &[bool]) -> Markup {
    let cells = row.cells.iter().zip(&table.columns).zip(is_number);
    html! {
        tr .highlight[row.highlight.is_some()] {
            @for (index, ((cell, column), is_number)) in cells.enumerate() {
                td .number[*is_number] {
                    @match cell {
                        Cell::Text(text) => (text),
                        Cell::Number(value) => (readable(*value, column.decimals)),
                        Cell::Missing => span .missing title="not measured" { "–" },
                    }
                    @if let (0, Some(why)) = (index, &row.highlight) {
                        " " span .badge { (why) }
                    }
                }
            }
        }
    }
}

fn draw_plot(plot: &Plot) -> Markup {
    let links = files(&[
        ("SVG", plot_path(&plot.name)),
        ("CSV", table_path(&plot.name)),
    ]);
    html! {
        figure .drawing #(plot.name) {
            (plot::inline(plot))
            figcaption { (plot::caption(plot)) " " (links) }
        }
    }
}

fn draw_picture(picture: &Picture) -> Markup {
    html! {
        figure .picture #(picture.name) {
            (img(&picture.image, &picture.alt))
            figcaption { (picture.caption) " " (files(&[("PNG", picture_path(&picture.name))])) }
        }
    }
}

/// All pictures are there once; the chosen view, a radio button, decides by
/// style alone which of them stand where.
fn draw_comparison(comparison: &Comparison) -> Markup {
    let name = &comparison.name;
    let labels = comparison.pictures().map(|(_, it)| it.label.as_str());
    let files_named = comparison.named_images();
    let links: Vec<(&str, String)> = labels
        .chain(comparison.strip.iter().map(|_| "Strip"))
        .zip(files_named.map(|(name, _)| picture_path(&name)))
        .collect();
    let button = |view: &'static str, label: &str| {
        html! {
            label {
                input type="radio" name={ (name) "-view" } value=(view) checked[view == "all"];
                span { (label) }
            }
        }
    };
    html! {
        figure .comparison .small[comparison.left.image.width() < LEAST_WIDTH] #(name) {
            fieldset {
                legend { "View" }
                (button("all", "Side by side"))
                span .script-only { (button("slider", "Slider")) }
                (button("blink", "Blink"))
                @for (side, picture) in comparison.pictures() { (button(side, &picture.label)) }
                span .script-only .hint { "S swaps, N next, P previous" }
            }
            div .stage {
                @for (side, picture) in comparison.pictures() { (draw_side(side, picture)) }
            }
            label .cut {
                span { (comparison.left.label) }
                input type="range" min="0" max="100" step="0.5" value="50"
                    aria-label={ "Edge between " (comparison.left.label) " and "
                        (comparison.right.label) };
                span { (comparison.right.label) }
            }
            figcaption { (comparison.caption) " " (files(&links)) }
        }
    }
}

fn draw_side(side: &str, picture: &LabelledPicture) -> Markup {
    html! {
        div class={ "side " (side) } {
            (img(&picture.image, &picture.alt))
            div .name { (picture.label) }
        }
    }
}

fn img(image: &PngImage, alt: &str) -> Markup {
    let source = format!("data:image/png;base64,{}", STANDARD.encode(image.bytes()));
    html! { img src=(source) width=(image.width()) height=(image.height()) alt=(alt); }
}

/// Links to the loose files beside the page.
fn files(links: &[(&str, String)]) -> Markup {
    html! {
        span .files {
            @for (label, path) in links { a href=(path) { (label) } " " }
        }
    }
}
