//! Reports: tables, plots and pictures as one folder that a person reads in a
//! browser and a program reads as JSON and CSV.
//!
//! Comes in: a [`Report`], filled by whoever measured. Goes out: named files as
//! bytes ([`Report::files`]); nothing is written here. Pictures come as PNG, so
//! that no image is encoded here either.
//!
//! | file | what it is |
//! |---|---|
//! | `report.html` | everything on one page that needs no other file |
//! | `report.json` | everything but the pixels |
//! | `tables/NAME.csv` | the numbers of each table and of each plot |
//! | `plots/NAME.svg` | each plot by itself |
//! | `pictures/NAME.png` | each picture by itself, as it was given |
//!
//! The same report gives the same bytes on every machine: no dates, no paths,
//! elementary functions from `maths`.

mod colours;
mod csv;
mod error;
mod json;
mod model;
mod names;
mod number;
mod page;
mod plot;
mod png;

pub use self::png::PngImage;
pub use error::ReportError;
pub use model::{
    Axis, Block, Cell, Column, Comparison, Fact, LabelledPicture, Mark, Picture, Plot, Report, Row,
    Scale, Section, Series, Style, Table,
};

/// One file of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReportFile {
    /// Path below the report's folder, with `/` between the parts.
    pub path: String,
    /// What it holds.
    pub bytes: Vec<u8>,
}

impl Report {
    /// All files of the report, `report.html` last: when it is there, so is
    /// what it links to.
    ///
    /// # Errors
    /// If a name is no slug or names two things, or a row does not fit its
    /// table's columns.
    pub fn files(&self) -> Result<Vec<ReportFile>, ReportError> {
        names::check(self)?;
        let mut files: Vec<ReportFile> = self.blocks().flat_map(files_of).collect();
        files.push(text_file("report.json".to_owned(), json::write(self)));
        files.push(text_file("report.html".to_owned(), page::write(self)));
        Ok(files)
    }

    fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.sections.iter().flat_map(|section| &section.blocks)
    }
}

fn files_of(block: &Block) -> Vec<ReportFile> {
    match block {
        Block::Table(table) => vec![text_file(table_path(&table.name), csv::table(table))],
        Block::Plot(plot) => vec![
            text_file(table_path(&plot.name), csv::plot(plot)),
            text_file(plot_path(&plot.name), plot::standalone(plot)),
        ],
        Block::Picture(picture) => vec![png_file(&picture.name, &picture.image)],
        Block::Comparison(comparison) => comparison
            .named_images()
            .map(|(name, image)| png_file(&name, image))
            .collect(),
    }
}

fn text_file(path: String, text: String) -> ReportFile {
    ReportFile {
        path,
        bytes: text.into_bytes(),
    }
}

fn png_file(name: &str, image: &PngImage) -> ReportFile {
    ReportFile {
        path: picture_path(name),
        bytes: image.bytes().to_vec(),
    }
}

fn table_path(name: &str) -> String {
    format!("tables/{name}.csv")
}

fn plot_path(name: &str) -> String {
    format!("plots/{name}.svg")
}

fn picture_path(name: &str) -> String {
    format!("pictures/{name}.png")
}

#[cfg(test)]
mod tests;
