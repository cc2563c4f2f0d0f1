//! Plots as SVG.
//!
//! Comes in: a [`Plot`]. Goes out: SVG for the page or as a file of its own.
//! Written here because no plotting crate fits: `plotters` sets colours as
//! attributes, which cannot follow the reader's colour scheme, and has neither
//! tooltips nor an automatic placing of labels; `poloto` follows the scheme but
//! has no logarithmic axes; `charming` needs a script of a megabyte.

mod axis;
mod layout;
mod placing;
mod svg;

use maud::{Markup, PreEscaped, html};

use super::{Plot, colours};
use layout::{Layout, NARROW, WIDE};

/// Rules for everything inside a plot; the page has them once for all plots.
pub(super) const CSS: &str = include_str!("plot.css");

/// The plot as a file that follows the reader's colour scheme by itself.
pub(super) fn standalone(plot: &Plot) -> String {
    let style = html! { style { (PreEscaped(colours::css())) (PreEscaped(CSS)) } };
    let drawing = svg::draw(&Layout::new(plot, WIDE), Some(style));
    drawing.into_string() + "\n"
}

/// The plot twice, for wide and for narrow windows; the page shows one of them.
pub(super) fn inline(plot: &Plot) -> Markup {
    html! {
        div .wide { (svg::draw(&Layout::new(plot, WIDE), None)) }
        div .narrow { (svg::draw(&Layout::new(plot, NARROW), None)) }
    }
}

/// The plot's caption with the count of what is not in it.
pub(super) fn caption(plot: &Plot) -> String {
    let note = match layout::left_out(plot) {
        0 => return plot.caption.clone(),
        1 => "1 point is not drawn:".to_owned(),
        count => format!("{count} points are not drawn:"),
    };
    let caption = &plot.caption;
    format!("{caption} ({note} not finite, or not positive on a logarithmic axis.)")
        .trim_start()
        .to_owned()
}

#[cfg(test)]
mod tests;
