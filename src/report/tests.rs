//! Reports with hostile texts and names; each writer's own tests are beside it.

use super::*;

const HOSTILE: &str = "</title></style><script>alert(\"1\")</script>&amp;'\u{1}\n,";

/// Elements of HTML that have no end.
const VOID: [&str; 5] = ["!DOCTYPE", "meta", "link", "img", "input"];

fn png() -> PngImage {
    let head = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\x02\0\0\0\x03";
    PngImage::new(head.to_vec()).unwrap()
}

fn labelled(side: &str) -> LabelledPicture {
    LabelledPicture {
        label: HOSTILE.to_owned(),
        image: png(),
        alt: HOSTILE.to_owned(),
        file_word: side.to_owned(),
    }
}

/// A report with one block of each kind and the same text everywhere.
fn report(text: &str) -> Report {
    let text = || text.to_owned();
    let axis = || Axis::linear(&text(), &text());
    Report {
        title: text(),
        summary: vec![Fact {
            label: text(),
            value: text(),
            note: text(),
        }],
        sections: vec![Section {
            heading: text(),
            anchor: "section".to_owned(),
            paragraphs: vec![text()],
            blocks: vec![
                Block::Table(Table {
                    name: "table".to_owned(),
                    caption: text(),
                    columns: vec![Column::number(&text(), &text(), 2)],
                    rows: vec![
                        Row::highlighted(vec![text().into()], &text()),
                        Row::plain(vec![f64::NAN.into()]),
                        Row::plain(vec![None.into()]),
                    ],
                }),
                Block::Plot(Plot {
                    name: "plot".to_owned(),
                    caption: text(),
                    x: axis(),
                    y: axis(),
                    series: vec![Series {
                        label: text(),
                        points: vec![(1.0, 2.0), (f64::NAN, 1.0)],
                        style: Style::Dashed,
                    }],
                    marks: vec![Mark {
                        label: text(),
                        x: 1.0,
                        y: 2.0,
                    }],
                }),
                Block::Picture(Picture {
                    name: "picture".to_owned(),
                    caption: text(),
                    image: png(),
                    alt: text(),
                }),
                Block::Comparison(Comparison {
                    name: "comparison".to_owned(),
                    caption: text(),
                    left: labelled("left"),
                    right: labelled("right"),
                    difference: None,
                    strip: Some(png()),
                }),
            ],
        }],
    }
}

fn file(report: &Report, path: &str) -> String {
    let files = report.files().unwrap();
    let file = files.into_iter().find(|file| file.path == path).unwrap();
    String::from_utf8(file.bytes).unwrap()
}

/// Names of all elements, after a check that each is closed where it must be.
fn elements(text: &str) -> Vec<String> {
    let (mut open, mut all): (Vec<&str>, Vec<String>) = (Vec::new(), Vec::new());
    let mut rest = text;
    while let Some(start) = rest.find('<') {
        rest = &rest[start + 1..];
        let name_end = rest.find([' ', '>']).unwrap();
        let name = &rest[..name_end];
        rest = &rest[end_of_tag(rest)..];
        if let Some(closed) = name.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closed), "{all:?}");
            continue;
        }
        all.push(name.to_owned());
        if name == "script" || name == "style" {
            rest = &rest[rest.find("</").unwrap()..];
        }
        if !VOID.contains(&name) {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?} stay open");
    all
}

/// Behind the `>` that ends a tag; one inside quotes does not.
fn end_of_tag(text: &str) -> usize {
    let mut is_quoted = false;
    let end = text.bytes().position(|byte| {
        is_quoted ^= byte == b'"';
        byte == b'>' && !is_quoted
    });
    end.unwrap() + 1
}

#[test]
fn no_text_becomes_markup() {
    let (plain, hostile) = (report("plain"), report(HOSTILE));
    for path in ["report.html", "plots/plot.svg"] {
        let text = file(&hostile, path);
        // The same elements in the same order, whatever the texts are.
        assert_eq!(elements(&text), elements(&file(&plain, path)), "{path}");
        assert!(!text.contains("alert(\""), "{path}");
        assert!(
            text.contains("&lt;script&gt;"),
            "{path}: the text is still there"
        );
    }
    let svg = file(&hostile, "plots/plot.svg");
    let is_forbidden = |it: char| it.is_control() && it != '\n';
    assert!(!svg.contains(is_forbidden), "XML has no control characters");
}

#[test]
fn the_page_needs_no_other_file() {
    let page = file(&report("plain"), "report.html");
    for attribute in page.split(" src=\"").skip(1) {
        assert!(
            attribute.starts_with("data:image/png;base64,"),
            "{attribute:.40}"
        );
    }
    for word in [
        "http:",
        "https:",
        "url(",
        "@import",
        "<link rel=\"stylesheet",
    ] {
        assert!(!page.contains(word), "{word}");
    }
}

#[test]
fn numbers_that_are_none_are_null_in_json() {
    let text = file(&report(HOSTILE), "report.json");
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["title"], HOSTILE);
    let blocks = &value["sections"][0]["blocks"];
    let cells: Vec<_> = (0..3)
        .map(|row| &blocks[0]["rows"][row]["cells"][0])
        .collect();
    assert_eq!(cells[0], HOSTILE);
    assert!(cells[1].is_null() && cells[2].is_null());
    assert_eq!(blocks[1]["series"][0]["points"][0][1], 2.0);
    assert!(blocks[1]["series"][0]["points"][1][0].is_null());
}

#[test]
fn names_are_slugs_and_unique() {
    let error = |change: &dyn Fn(&mut Report)| {
        let mut report = report("plain");
        change(&mut report);
        report
            .files()
            .map(|_| ())
            .map_err(|error| error.to_string())
    };
    let picture_named = |name: &'static str| {
        move |report: &mut Report| {
            let Block::Picture(picture) = &mut report.sections[0].blocks[2] else {
                panic!("the third block is the picture");
            };
            picture.name = name.to_owned();
        }
    };
    assert_eq!(error(&|_| ()), Ok(()));
    assert_eq!(error(&picture_named("other")), Ok(()));
    for name in ["../picture", "Picture", ""] {
        let error = error(&picture_named(name)).unwrap_err();
        assert!(error.contains("cannot name a part"), "{error}");
    }
    // Another block, the section, a file of the comparison, the page's own anchor.
    for name in [
        "table",
        "section",
        "comparison-left",
        "comparison-strip",
        "contents",
        "report",
    ] {
        let error = error(&picture_named(name)).unwrap_err();
        assert!(error.contains("two parts"), "{error}");
    }
}
