//! What a report holds. Texts are plain: whatever stands in them is shown as it
//! is, never read as markup.

use super::PngImage;

/// A whole report.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// Title of the page.
    pub title: String,
    /// What matters most, above everything else.
    pub summary: Vec<Fact>,
    /// The parts, each with an entry in the table of contents.
    pub sections: Vec<Section>,
}

/// One figure of the summary.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Fact {
    /// What was measured.
    pub label: String,
    /// The figure with its unit, as it is to be read.
    pub value: String,
    /// Under what conditions; may be empty.
    pub note: String,
}

/// A heading with what stands below it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// Text of the heading.
    pub heading: String,
    /// Slug by which links find the section; unique in the report.
    pub anchor: String,
    /// Text between heading and blocks.
    pub paragraphs: Vec<String>,
    /// Tables, plots and pictures, from top to bottom.
    pub blocks: Vec<Block>,
}

/// One table, plot or picture. Pictures in a row share lines where there is space.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// Rows and columns.
    Table(Table),
    /// Curves and points.
    Plot(Plot),
    /// A picture.
    Picture(Picture),
    /// Two pictures of the same thing.
    Comparison(Comparison),
}

/// Rows and columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Slug that names its files; unique in the report.
    pub name: String,
    /// Text above the table; may be empty.
    pub caption: String,
    /// Heads of the columns.
    pub columns: Vec<Column>,
    /// Rows, each with as many cells as there are columns.
    pub rows: Vec<Row>,
}

/// Head of a column.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Column {
    /// What the column holds.
    pub label: String,
    /// Unit of its numbers; empty if there is none.
    pub unit: String,
    /// Decimals of its numbers on the page; CSV and JSON have all digits.
    pub decimals: usize,
}

impl Column {
    /// A column of texts.
    pub fn text(label: &str) -> Self {
        Self::number(label, "", 0)
    }

    /// A column of numbers.
    pub fn number(label: &str, unit: &str, decimals: usize) -> Self {
        Self {
            label: label.to_owned(),
            unit: unit.to_owned(),
            decimals,
        }
    }
}

/// One row of a table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Row {
    /// One cell a column.
    pub cells: Vec<Cell>,
    /// Why the row stands out ("default"); none for most rows.
    pub highlight: Option<String>,
}

impl Row {
    /// A row like any other.
    pub fn plain(cells: Vec<Cell>) -> Self {
        Self {
            cells,
            highlight: None,
        }
    }

    /// A row that stands out, with the word that says why.
    pub fn highlighted(cells: Vec<Cell>, why: &str) -> Self {
        Self {
            cells,
            highlight: Some(why.to_owned()),
        }
    }
}

/// One cell of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A text.
    Text(String),
    /// A number in its column's unit; null in JSON if it is not finite.
    Number(f64),
    /// Not measured.
    Missing,
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::Missing, Self::Number)
    }
}

/// Curves and points over two axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Slug that names its files; unique in the report.
    pub name: String,
    /// Text below the plot; points that cannot be drawn are counted behind it.
    pub caption: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// What is drawn. Colours repeat after eight.
    pub series: Vec<Series>,
    /// Points with a label beside them.
    pub marks: Vec<Mark>,
}

/// One axis of a plot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    /// What the axis measures.
    pub label: String,
    /// Its unit; empty if there is none.
    pub unit: String,
    /// How values become places.
    pub scale: Scale,
}

impl Axis {
    /// An axis of equal steps.
    pub fn linear(label: &str, unit: &str) -> Self {
        Self {
            label: label.to_owned(),
            unit: unit.to_owned(),
            scale: Scale::Linear,
        }
    }

    /// An axis of equal factors.
    pub fn log(label: &str, unit: &str) -> Self {
        Self {
            scale: Scale::Log,
            ..Self::linear(label, unit)
        }
    }
}

/// How an axis turns values into places.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps are equally long.
    Linear,
    /// Equal factors are equally long; values at or below 0 cannot be drawn.
    Log,
}

/// Points that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its entry in the legend.
    pub label: String,
    /// Points in the order in which a line joins them; one that cannot be
    /// drawn breaks the line.
    pub points: Vec<(f64, f64)>,
    /// How they are drawn.
    pub style: Style,
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Points joined by a line.
    Line,
    /// Points alone.
    Dots,
    /// Points joined by a dashed line: a limit, a model, the other way.
    Dashed,
}

/// A point with a label beside it.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Text beside the point.
    pub label: String,
    /// Place on the horizontal axis.
    pub x: f64,
    /// Place on the vertical axis.
    pub y: f64,
}

/// A picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Slug that names its file; unique in the report.
    pub name: String,
    /// Text below the picture; may be empty.
    pub caption: String,
    /// The pixels.
    pub image: PngImage,
    /// What is to be seen, for those who do not see it.
    pub alt: String,
}

/// Two pictures of the same view, to be looked at beside each other, across a
/// movable edge, or one in place of the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Slug that begins the names of its files; unique in the report.
    pub name: String,
    /// Text below the pictures; may be empty.
    pub caption: String,
    /// The one, for example what is expected.
    pub left: LabelledPicture,
    /// The other, for example what came out.
    pub right: LabelledPicture,
    /// How they differ, for example a heat map.
    pub difference: Option<LabelledPicture>,
    /// All in one picture, which is a file beside the page but not on it.
    pub strip: Option<PngImage>,
}

/// One picture of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelledPicture {
    /// Short name that stands on its button and below it.
    pub label: String,
    /// The pixels.
    pub image: PngImage,
    /// What is to be seen, for those who do not see it.
    pub alt: String,
    /// Slug that ends the name of its file; another in each picture of a
    /// comparison, and not "strip".
    pub file_word: String,
}

impl Comparison {
    /// The pictures, each with the side on which it stands.
    pub(super) fn pictures(&self) -> impl Iterator<Item = (&'static str, &LabelledPicture)> {
        let both = [("left", &self.left), ("right", &self.right)];
        let difference = self.difference.iter().map(|it| ("difference", it));
        both.into_iter().chain(difference)
    }

    /// The names of all files, each with its pixels.
    pub(super) fn named_images(&self) -> impl Iterator<Item = (String, &PngImage)> {
        let pictures = self
            .pictures()
            .map(|(_, it)| (it.file_word.as_str(), &it.image));
        let strip = self.strip.iter().map(|image| ("strip", image));
        let named = pictures.chain(strip);
        named.map(|(word, image)| (self.file_name(word), image))
    }

    pub(super) fn file_name(&self, word: &str) -> String {
        format!("{}-{word}", self.name)
    }
}

impl Block {
    pub(super) fn name(&self) -> &str {
        match self {
            Self::Table(table) => &table.name,
            Self::Plot(plot) => &plot.name,
            Self::Picture(picture) => &picture.name,
            Self::Comparison(comparison) => &comparison.name,
        }
    }
}
