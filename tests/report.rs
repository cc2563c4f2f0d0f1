//! A full report through the public API: its files, the page and the folder.
//! With `RELUME_REPORT_FOLDER` set, the folder stays there to be looked at:
//! `RELUME_REPORT_FOLDER=/tmp/report cargo test --test report`.

use std::path::PathBuf;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use relume::report::{
    Axis, Block, Cell, Column, Comparison, Fact, LabelledPicture, Mark, Picture, Plot, PngImage,
    Report, Row, Section, Series, Style, Table,
};
use relume::write_folder;

/// A picture of a shaded ball, shifted and tinted so that two of them differ.
fn ball(width: u32, height: u32, shift: f64, tint: [f64; 3]) -> PngImage {
    let radius = 0.38 * f64::from(height);
    let level = |x: u32, y: u32, tint: f64| {
        let across = (f64::from(x) - 0.5 * f64::from(width) - shift) / radius;
        let down = (f64::from(y) - 0.5 * f64::from(height)) / radius;
        let inside = 1.0 - across * across - down * down;
        let light = match inside > 0.0 {
            true => 0.15 + 0.8 * (0.6 * inside.sqrt() - 0.5 * across - 0.5 * down).clamp(0.0, 1.0),
            false => 0.25 + 0.3 * f64::from(y) / f64::from(height),
        };
        (255.0 * (light * tint).clamp(0.0, 1.0)) as u8
    };
    let mut levels = Vec::new();
    for y in 0..height {
        for x in 0..width {
            levels.extend(tint.map(|tint| level(x, y, tint)));
        }
    }
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(&levels, width, height, ExtendedColorType::Rgb8)
        .expect("a small picture can be encoded");
    PngImage::new(bytes).expect("the encoder writes PNG")
}

fn series(label: &str, style: Style, scale: f64, power: f64) -> Series {
    let errors = [0.2, 0.1, 0.05, 0.025, 0.012, 0.006];
    let points = errors.map(|error: f64| (error, scale * libm::pow(error, -power)));
    Series {
        label: label.to_owned(),
        points: points.to_vec(),
        style,
    }
}

fn speed_plot() -> Plot {
    let mut all = vec![
        series("relume, basis 64", Style::Line, 1.2, 0.4),
        series("relume, basis 256", Style::Line, 2.0, 0.7),
        series("path tracer, 4 bounces", Style::Dashed, 0.9, 2.0),
        series("direct light alone", Style::Dots, 0.5, 0.1),
        series("lightmaps", Style::Line, 3.0, 0.3),
        series("instant radiosity", Style::Line, 0.5, 1.4),
        series("low rank", Style::Dots, 0.7, 1.1),
        series("no compression", Style::Dashed, 4.0, 0.9),
    ];
    all[0].points.push((f64::NAN, 3.0));
    all[3].points[2].1 = -1.0;
    Plot {
        name: "speed-error".to_owned(),
        caption: "Time of a frame against its error; lower left is better.".to_owned(),
        x: Axis::log("relative error", "RMS"),
        y: Axis::log("time of a frame", "ms"),
        marks: vec![
            Mark {
                label: "default".to_owned(),
                x: 0.05,
                y: 2.0 * libm::pow(0.05, -0.7),
            },
            Mark {
                label: "256 paths a pixel".to_owned(),
                x: 0.006,
                y: 0.9 * libm::pow(0.006, -2.0),
            },
        ],
        series: all,
    }
}

fn bounce_plot() -> Plot {
    let curve = |label: &str, albedo: f64| Series {
        label: label.to_owned(),
        points: (0..=100)
            .map(|step| 0.1 * f64::from(step))
            .map(|bounces| (bounces, (1.0 - libm::pow(albedo, bounces)) / (1.0 - albedo)))
            .collect(),
        style: Style::Line,
    };
    Plot {
        name: "bounces".to_owned(),
        caption: "Light in a furnace after so many bounces.".to_owned(),
        x: Axis::linear("bounces", ""),
        y: Axis::linear("radiosity", "W/m²"),
        series: vec![curve("albedo 0.5", 0.5), curve("albedo 0.8", 0.8)],
        marks: vec![Mark {
            label: "four bounces".to_owned(),
            x: 4.0,
            y: (1.0 - libm::pow(0.8, 4.0)) / 0.2,
        }],
    }
}

fn settings_table() -> Table {
    let number = Column::number;
    let mut rows: Vec<Row> = (0..6)
        .map(|index| {
            let size = 32.0 * f64::from(1 << index);
            Row::plain(vec![
                format!("basis of {size}").into(),
                size.into(),
                (0.4 * size).into(),
                (1e6 / size).into(),
                (2.5 / size).into(),
                (index > 1).then_some(3.5 * size).into(),
                (1e-7 * size).into(),
                "courtyard, the camera at the gate".into(),
            ])
        })
        .collect();
    rows[3].highlight = Some("default".to_owned());
    rows[5].cells[4] = f64::NAN.into();
    Table {
        name: "settings".to_owned(),
        caption: "What each setting costs and gives.".to_owned(),
        columns: vec![
            Column::text("setting"),
            number("functions", "", 0),
            number("bake", "s", 1),
            number("rays", "1/s", 0),
            number("error", "RMS", 3),
            number("bake file", "MB", 0),
            number("loss", "", 3),
            Column::text("scene and view"),
        ],
        rows,
    }
}

fn labelled(label: &str, image: PngImage) -> LabelledPicture {
    LabelledPicture {
        label: label.to_owned(),
        image,
        alt: format!("A ball, {label}"),
        file_word: label.to_lowercase(),
    }
}

fn comparison() -> Comparison {
    Comparison {
        name: "courtyard".to_owned(),
        caption: "The courtyard at noon.".to_owned(),
        left: labelled("Expected", ball(640, 400, 0.0, [1.0, 0.9, 0.8])),
        right: labelled("Actual", ball(640, 400, 6.0, [0.9, 0.9, 1.0])),
        difference: Some(labelled("Difference", ball(640, 400, 3.0, [1.0, 0.2, 0.1]))),
        strip: Some(ball(1920, 400, 3.0, [1.0, 0.9, 0.8])),
    }
}

fn picture(name: &str, width: u32, height: u32) -> Block {
    Block::Picture(Picture {
        name: name.to_owned(),
        caption: format!("{width} x {height} pixels."),
        image: ball(width, height, 0.0, [0.8, 0.9, 1.0]),
        alt: "A ball".to_owned(),
    })
}

fn section(heading: &str, anchor: &str, text: &str, blocks: Vec<Block>) -> Section {
    Section {
        heading: heading.to_owned(),
        anchor: anchor.to_owned(),
        paragraphs: vec![text.to_owned()],
        blocks,
    }
}

fn fact(label: &str, value: &str, note: &str) -> Fact {
    Fact {
        label: label.to_owned(),
        value: value.to_owned(),
        note: note.to_owned(),
    }
}

fn demonstration() -> Report {
    Report {
        title: "Speed against error: courtyard <4 bounces & sky>".to_owned(),
        summary: vec![
            fact("Frame", "3.4 ms", "640 x 400, one thread"),
            fact("Error", "4.8 %", "RMS against 4,096 paths a pixel"),
            fact("Bake", "12.5 s", "basis of 256"),
            fact("Bake file", "38 MB", ""),
        ],
        sections: vec![
            section(
                "Speed against error",
                "speed",
                "Each point is one setting; a line joins the settings of one method, from the \
                 coarsest to the finest. The time is the median of 31 frames.",
                vec![Block::Plot(speed_plot()), Block::Table(settings_table())],
            ),
            section(
                "Bounces",
                "furnace",
                "Closed form.",
                vec![Block::Plot(bounce_plot())],
            ),
            section(
                "Pictures",
                "views",
                "Views of the settings above.",
                vec![
                    picture("small", 160, 100),
                    picture("wide", 640, 200),
                    picture("tall", 200, 300),
                    Block::Comparison(comparison()),
                    picture("large", 2400, 1500),
                ],
            ),
        ],
    }
}

#[test]
fn a_report_is_one_folder() {
    let files = demonstration().files().unwrap();
    let paths: Vec<&str> = files.iter().map(|file| file.path.as_str()).collect();
    assert_eq!(
        paths,
        [
            "tables/speed-error.csv",
            "plots/speed-error.svg",
            "tables/settings.csv",
            "tables/bounces.csv",
            "plots/bounces.svg",
            "pictures/small.png",
            "pictures/wide.png",
            "pictures/tall.png",
            "pictures/courtyard-expected.png",
            "pictures/courtyard-actual.png",
            "pictures/courtyard-difference.png",
            "pictures/courtyard-strip.png",
            "pictures/large.png",
            "report.json",
            "report.html",
        ]
    );
    let made = tempfile::tempdir().unwrap();
    let kept = std::env::var_os("RELUME_REPORT_FOLDER").map(PathBuf::from);
    let folder = kept.unwrap_or_else(|| made.path().join("new/report"));
    // Twice: a folder that is there is written over.
    for _ in 0..2 {
        write_folder(&folder, &files).unwrap();
    }
    for file in &files {
        let written = std::fs::read(folder.join(&file.path)).unwrap();
        assert_eq!(written, file.bytes, "{}", file.path);
    }
}

#[test]
fn files_outside_the_folder_are_refused() {
    let made = tempfile::tempdir().unwrap();
    let folder = made.path().join("inside");
    let mut files = demonstration().files().unwrap();
    for path in ["../outside.csv", "/outside.csv", "a/../../outside.csv"] {
        files[0].path = path.to_owned();
        assert!(write_folder(&folder, &files).is_err(), "{path}");
    }
    assert!(!made.path().join("outside.csv").exists());
}

#[test]
fn the_same_report_gives_the_same_bytes() {
    assert_eq!(
        demonstration().files().unwrap(),
        demonstration().files().unwrap()
    );
}

#[test]
fn the_json_holds_every_number() {
    let files = demonstration().files().unwrap();
    let json = files
        .iter()
        .find(|file| file.path == "report.json")
        .unwrap();
    let value: serde_json::Value = serde_json::from_slice(&json.bytes).unwrap();
    let table = &value["sections"][0]["blocks"][1];
    assert_eq!(table["kind"], "table");
    assert_eq!(table["csv"], "tables/settings.csv");
    assert_eq!(table["columns"][2]["unit"], "s");
    assert_eq!(table["rows"][0]["cells"][2], 12.8);
    assert_eq!(table["rows"][0]["cells"][5], serde_json::Value::Null);
    assert_eq!(table["rows"][5]["cells"][4], serde_json::Value::Null);
    assert_eq!(table["rows"][3]["highlight"], "default");
    let plot = &value["sections"][0]["blocks"][0];
    assert_eq!(plot["series"][0]["points"][6][0], serde_json::Value::Null);
    assert_eq!(plot["x"]["scale"], "log");
    let difference = &value["sections"][2]["blocks"][3]["difference"]["image"];
    assert_eq!(difference["file"], "pictures/courtyard-difference.png");
    assert_eq!(difference["width"], 640);
}

#[test]
fn a_row_must_fit_its_table() {
    let mut table = settings_table();
    table.rows[2].cells.push(Cell::Missing);
    let sections = vec![section("A", "a", "", vec![Block::Table(table)])];
    let report = Report {
        sections,
        ..Report::default()
    };
    let error = report.files().unwrap_err().to_string();
    assert!(error.contains("settings, row 3: 9 cells for 8"), "{error}");
}
