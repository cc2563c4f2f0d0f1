//! Scripts: what a person would do, frame by frame, as lines of text.
//!
//! A line is `FRAME EVENT`; `#` starts a comment. Events are those of [`EVENTS`].

use std::path::PathBuf;

use super::input::{Action, Button, Code, Held, Input, Key, Mouse};

/// The events, as an error lists them.
const EVENTS: &str = "`key NAME`, `type TEXT`, \
    `mouse press|drag|release|move left|middle|right COLUMN ROW [shift] [ctrl] [alt]`, \
    `scroll up|down COLUMN ROW [shift] [ctrl] [alt]`, `resize COLUMNS ROWS`, \
    `shot PATH.png|.txt`, `rest`";

/// What happens at a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Scripted {
    pub(crate) frame: u64,
    pub(crate) event: ScriptEvent,
}

/// An event of a script.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum ScriptEvent {
    Input(Input),
    /// A picture of the screen goes into this file, by its ending as pixels or text.
    Shot(PathBuf),
    /// What follows waits until the picture is sharp.
    Rest,
}

/// A line of a script cannot be understood.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}: {message}")]
pub(crate) struct ScriptError {
    file: String,
    line: usize,
    message: String,
}

/// Reads a script; `file` is what errors call it.
///
/// # Errors
/// The first line that is no event, with what is allowed.
pub(crate) fn parse(text: &str, file: &str) -> Result<Vec<Scripted>, ScriptError> {
    let mut events: Vec<Scripted> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let error = |message| ScriptError {
            file: file.to_owned(),
            line: index + 1,
            message,
        };
        let line = line.trim_start_matches('\u{feff}').trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let (frame, event) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let frame: u64 = frame.parse().map_err(|_| {
            error(format!(
                "{frame:?} is no frame number; lines are FRAME EVENT, events {EVENTS}"
            ))
        })?;
        if let Some(before) = events.last().filter(|before| before.frame > frame) {
            let message = format!(
                "frame {frame} follows frame {}; they must not fall",
                before.frame
            );
            return Err(error(message));
        }
        let found = events_of(event.trim_start()).map_err(error)?;
        events.extend(found.into_iter().map(|event| Scripted { frame, event }));
    }
    Ok(events)
}

fn events_of(text: &str) -> Result<Vec<ScriptEvent>, String> {
    let (verb, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    if verb == "type" {
        return typed(rest);
    }
    // A number sign may be the key, or stand in a path without space before it.
    let is_comment = |place: &usize| {
        let before = &rest[..*place];
        let begins = before.is_empty() || before.ends_with(char::is_whitespace);
        begins && (verb != "key" || !before.trim().is_empty())
    };
    let mut signs = rest.match_indices('#').map(|(place, _)| place);
    let rest = signs.find(is_comment).map_or(rest, |place| &rest[..place]);
    let words: Vec<&str> = rest.split_whitespace().collect();
    let event = match (verb, words.as_slice()) {
        ("key", [name]) => ScriptEvent::Input(Input::Key(Key::parse(name)?)),
        ("mouse", [action, button, column, row, held @ ..]) => mouse(
            mouse_action(action, mouse_button(button)?)?,
            [column, row],
            held,
        )?,
        ("scroll", ["up", column, row, held @ ..]) => mouse(Action::ScrollUp, [column, row], held)?,
        ("scroll", ["down", column, row, held @ ..]) => {
            mouse(Action::ScrollDown, [column, row], held)?
        }
        ("resize", [columns, rows]) => ScriptEvent::Input(Input::Resize {
            columns: count(columns)?,
            rows: count(rows)?,
        }),
        ("shot", [_, ..]) => shot(rest.trim())?,
        ("rest", []) => ScriptEvent::Rest,
        _ => return Err(format!("{text:?} is no event; events are {EVENTS}")),
    };
    Ok(vec![event])
}

/// Each letter as a key of its own. A comment cannot follow: it could be meant.
fn typed(text: &str) -> Result<Vec<ScriptEvent>, String> {
    if text.is_empty() {
        return Err("`type` lacks its text; write `type TEXT`".to_owned());
    }
    let key = |letter| Key::new(Code::Char(letter), Held::NONE);
    let events = text
        .chars()
        .map(|letter| ScriptEvent::Input(Input::Key(key(letter))));
    Ok(events.collect())
}

fn mouse(action: Action, [column, row]: [&str; 2], held: &[&str]) -> Result<ScriptEvent, String> {
    Ok(ScriptEvent::Input(Input::Mouse(Mouse {
        action,
        column: count(column)?,
        row: count(row)?,
        held: modifiers(held)?,
    })))
}

fn mouse_button(name: &str) -> Result<Button, String> {
    match name {
        "left" => Ok(Button::Left),
        "middle" => Ok(Button::Middle),
        "right" => Ok(Button::Right),
        _ => Err(format!(
            "unknown button {name:?}; buttons are left, middle and right"
        )),
    }
}

fn mouse_action(name: &str, button: Button) -> Result<Action, String> {
    match name {
        "press" => Ok(Action::Press(button)),
        "drag" => Ok(Action::Drag(button)),
        "release" => Ok(Action::Release(button)),
        "move" => Ok(Action::Move),
        _ => Err(format!(
            "the mouse cannot {name:?}; it can press, drag, release and move"
        )),
    }
}

fn modifiers(names: &[&str]) -> Result<Held, String> {
    let mut held = Held::NONE;
    for name in names {
        match *name {
            "shift" => held.shift = true,
            "ctrl" => held.ctrl = true,
            "alt" => held.alt = true,
            _ => {
                return Err(format!(
                    "unknown modifier {name:?}; there are shift, ctrl and alt"
                ));
            }
        }
    }
    Ok(held)
}

fn count(text: &str) -> Result<u16, String> {
    let message = || {
        format!(
            "{text:?} is no number of cells; give one from 0 to {}",
            u16::MAX
        )
    };
    text.parse().map_err(|_| message())
}

fn shot(path: &str) -> Result<ScriptEvent, String> {
    let ending = path.rsplit_once('.').map(|(_, ending)| ending);
    match ending {
        Some("png" | "txt") => Ok(ScriptEvent::Shot(PathBuf::from(path))),
        _ => Err(format!("{path:?} must end in .png (pixels) or .txt (text)")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_event_is_read() {
        let text = "# a comment\n\n0 key Tab # select\n0 key shift+Up\n1 key #\n2 type q#\n\
                    3 mouse press left 10 5 shift alt\n3 mouse move right 1 2\n\
                    4 scroll down 3 4\n5 resize 80 24\n6 rest # until it is sharp\n6 shot out/a b.png\r\n";
        let events = parse(text, "s.txt").unwrap();
        assert_eq!(events.len(), 11);
        let key = |name| ScriptEvent::Input(Input::Key(Key::parse(name).unwrap()));
        assert_eq!(events[0].event, key("Tab"));
        assert_eq!(events[2].event, key("#"));
        assert_eq!([&events[3].event, &events[4].event], [&key("q"), &key("#")]);
        let ScriptEvent::Input(Input::Mouse(mouse)) = &events[5].event else {
            panic!("{:?}", events[5])
        };
        assert_eq!(mouse.action, Action::Press(Button::Left));
        assert_eq!((mouse.column, mouse.row), (10, 5));
        assert!(mouse.held.shift && mouse.held.alt && !mouse.held.ctrl);
        assert_eq!(events[9].event, ScriptEvent::Rest);
        assert_eq!(events[10].event, ScriptEvent::Shot("out/a b.png".into()));
        assert_eq!(events[10].frame, 6);
    }

    #[test]
    fn errors_name_the_line_and_what_is_allowed() {
        for (text, message) in [
            ("0 rest\nx key a", "s.txt:2: \"x\" is no frame number"),
            ("3 rest\n2 rest", "s.txt:2: frame 2 follows frame 3"),
            (
                "0 jump",
                "s.txt:1: \"jump\" is no event; events are `key NAME`",
            ),
            ("0 key Foo", "keys are single letters"),
            ("0 mouse poke left 1 1", "press, drag, release"),
            ("0 mouse press thumb 1 1", "left, middle and right"),
            ("0 scroll up 1 x", "no number of cells"),
            ("0 scroll up 1 1 hyper", "shift, ctrl and alt"),
            ("0 shot a.jpg", ".png"),
            ("0", "no event"),
            ("0 type", "lacks its text"),
        ] {
            let error = parse(text, "s.txt").unwrap_err().to_string();
            assert!(error.contains(message), "{text:?}: {error}");
        }
    }
}
