//! One table of keys: what each does, and what the help says of it.

use super::command::{Command, Request};
use super::input::{Code, Held, Key};
use super::light_edits::Way;
use super::new_lights::NewKind;

/// Steps of a command with Shift (or the capital letter), and with Alt or Ctrl.
const COARSE: f64 = 10.0;
const FINE: f64 = 0.1;

/// A line of the help: keys that belong together.
pub(crate) struct Row {
    /// Heading under which the help has it.
    pub(crate) group: &'static str,
    /// Keys in the notation of scripts, two with a space between where one follows
    /// the other; each with what it does.
    pub(crate) keys: &'static [(&'static str, Command)],
    /// What they do.
    pub(crate) help: &'static str,
}

const fn row(
    group: &'static str,
    keys: &'static [(&'static str, Command)],
    help: &'static str,
) -> Row {
    Row { group, keys, help }
}

use Command as C;
use Way::{Away, Closer, Down, Left, Right, Up};

/// All keys. Of a pair, the small letter is more and the capital one less.
#[rustfmt::skip]
pub(crate) const ROWS: [Row; 41] = [
    row("Select", &[("Tab", C::SelectLight(1)), ("shift+Tab", C::SelectLight(-1))], "next, previous light"),
    row("Select", &[("]", C::SelectSurface(1)), ("[", C::SelectSurface(-1))], "next, previous surface"),
    row("Select", &[("Esc", C::Deselect)], "select nothing"),
    row("Move", &[("Left", C::Nudge(Left)), ("Right", C::Nudge(Right)), ("Up", C::Nudge(Up)), ("Down", C::Nudge(Down))], "move the light across the view (turn a sun or sky; orbit if no light is selected)"),
    row("Move", &[("PgUp", C::Nudge(Away)), ("PgDn", C::Nudge(Closer))], "move the light away, closer (the camera if no light is selected)"),
    row("Move", &[("x", C::Turn(1)), ("X", C::Turn(-1))], "turn spot, sun, rectangle or sky right, left"),
    row("Move", &[("y", C::Tilt(1)), ("Y", C::Tilt(-1))], "tilt it up, down"),
    row("Move", &[(".", C::Aim)], "aim it at the point clicked last, or the middle"),
    row("Light or surface", &[("i", C::Brighter(1)), ("I", C::Brighter(-1))], "brighter, darker"),
    row("Light or surface", &[("c", C::Hue(1)), ("C", C::Hue(-1))], "hue forward, back"),
    row("Light or surface", &[("g", C::Saturation(1)), ("G", C::Saturation(-1))], "more colour, more grey"),
    row("Surface", &[("}", C::Kind(1)), ("{", C::Kind(-1))], "next, previous kind: matte, satin, plastic, brushed metal, polished metal"),
    row("Surface", &[(">", C::Rougher(1)), ("<", C::Rougher(-1))], "rougher, smoother gloss"),
    row("Light", &[("t", C::Colder(1)), ("T", C::Colder(-1))], "colder, warmer (temperature)"),
    row("Light", &[("o", C::Open(1)), ("O", C::Open(-1))], "wider, narrower cone; larger, smaller rectangle"),
    row("Light", &[("b", C::OpenBeam(1)), ("B", C::OpenBeam(-1))], "wider, narrower beam; longer, shorter second edge"),
    row("Light", &[("m", C::Mute)], "mute"),
    row("Light", &[("M", C::Solo)], "solo"),
    row("Light", &[("n p", C::Add(NewKind::Point))], "new point light"),
    row("Light", &[("n s", C::Add(NewKind::Spot))], "new spot"),
    row("Light", &[("n d", C::Add(NewKind::Directional))], "new sun (directional)"),
    row("Light", &[("n a", C::Add(NewKind::Area))], "new rectangle (area)"),
    row("Light", &[("n e", C::Add(NewKind::Environment))], "new sky (environment)"),
    row("Light", &[("n n", C::Duplicate), ("ctrl+d", C::Duplicate)], "duplicate"),
    row("Light", &[("Delete", C::Delete), ("Backspace", C::Delete)], "delete"),
    row("Camera", &[("h", C::Orbit(Left)), ("l", C::Orbit(Right)), ("k", C::Orbit(Up)), ("j", C::Orbit(Down))], "orbit left, right, up, down"),
    row("Camera", &[("H", C::Pan(Left)), ("L", C::Pan(Right)), ("K", C::Pan(Up)), ("J", C::Pan(Down))], "pan left, right, up, down"),
    row("Camera", &[("w", C::Walk(Away)), ("s", C::Walk(Closer)), ("a", C::Walk(Left)), ("d", C::Walk(Right))], "walk forward, back, left, right (capital: ten times as far)"),
    row("Camera", &[("r", C::Walk(Up)), ("f", C::Walk(Down))], "rise, sink"),
    row("Camera", &[("z", C::Dolly(1)), ("Z", C::Dolly(-1))], "closer to, away from the middle"),
    row("Camera", &[("v", C::ResetView)], "the view of the file"),
    row("Camera", &[("V", C::LookAtSelected)], "look at the selected light, or the point clicked last"),
    row("Picture", &[("1", C::Show(0)), ("2", C::Show(1)), ("3", C::Show(2)), ("4", C::Show(3)), ("5", C::Show(4)), ("6", C::Show(5)), ("7", C::Show(6)), ("8", C::Show(7)), ("9", C::Show(8)), ("0", C::Show(9))], "component: global, direct, indirect, glossy, irradiance, albedo, normal, depth, approximated direct, partitions"),
    row("Picture", &[("+", C::Bounces(1)), ("=", C::Bounces(1)), ("-", C::Bounces(-1)), ("*", C::AllBounces)], "more (either key), fewer, all bounces"),
    row("Picture", &[("e", C::Exposure(1)), ("E", C::Exposure(-1))], "exposure up, down by a third of a stop"),
    row("Picture", &[("/", C::Tone)], "other tone curve"),
    row("Picture", &[("Space", C::Marks)], "hide, show the marks of lights"),
    row("Program", &[("u", C::Undo), ("U", C::Redo), ("ctrl+r", C::Redo)], "undo, redo (either key)"),
    row("Program", &[("ctrl+s", C::Ask(Request::Save)), ("P", C::Ask(Request::WritePng))], "save the scene file, write a PNG at full size"),
    row("Program", &[("?", C::Ask(Request::Help)), ("F1", C::Ask(Request::Help)), ("ctrl+l", C::Ask(Request::Redraw))], "these keys, draw the screen again"),
    row("Program", &[("q", C::Ask(Request::Quit)), ("ctrl+z", C::Ask(Request::Suspend)), ("ctrl+c", C::Ask(Request::Interrupt))], "quit, suspend, end at once"),
];

/// What the mouse does, for the help.
pub(crate) const MOUSE: [(&str, &str); 9] = [
    ("click a mark", "select the light"),
    ("click elsewhere", "select the surface there"),
    (
        "drag a mark",
        "move the light across the view; turn a sun or sky",
    ),
    (
        "right-drag or Ctrl/Alt-drag a mark",
        "move the light along the view, up is away",
    ),
    (
        "Shift-drag a mark",
        "the same, where the terminal does not keep it for text",
    ),
    ("drag elsewhere", "orbit"),
    ("middle-, right- or Shift/Ctrl/Alt-drag elsewhere", "pan"),
    ("wheel", "closer, away"),
    (
        "Shift/Ctrl/Alt-wheel",
        "the selected light or surface brighter, darker",
    ),
];

/// What the help says of steps.
pub(crate) const STEPS: &str = "Steps: Shift with arrows and PgUp/PgDn ten times, Ctrl or Alt a tenth; \
     Alt with a letter a tenth. Of a pair, the small letter is more, the capital less.";

/// What a key means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Meaning {
    /// A command, by so many of its steps.
    Command(Command, f64),
    /// Another key must follow.
    Begins,
    Nothing,
}

/// What a key means behind another one that must be followed.
pub(crate) fn meaning(first: Option<Key>, key: Key) -> Meaning {
    let known = |wanted: Key| {
        let mut all = ROWS.iter().flat_map(|row| row.keys);
        all.find(|(keys, _)| strokes(keys) == [first, Some(wanted)])
            .map(|(_, command)| *command)
    };
    if let Some(command) = known(key) {
        return Meaning::Command(command, 1.0);
    }
    let begins = |keys: &str| strokes(keys)[0] == Some(key);
    if first.is_none()
        && ROWS
            .iter()
            .flat_map(|row| row.keys)
            .any(|(keys, _)| begins(keys))
    {
        return Meaning::Begins;
    }
    let stepped = plain(key).and_then(|(plain, steps)| Some((known(plain)?, steps)));
    stepped.map_or(Meaning::Nothing, |(command, steps)| {
        Meaning::Command(command, steps)
    })
}

/// A key without its modifiers, and the size of step that they ask for.
fn plain(key: Key) -> Option<(Key, f64)> {
    let Held { shift, ctrl, alt } = key.held;
    match key.code {
        // Ctrl with a letter is a key of its own.
        Code::Char(_) if ctrl => None,
        Code::Char(letter) if alt => Some((Key::new(Code::Char(letter), Held::NONE), FINE)),
        Code::Char(letter) if letter.is_uppercase() => {
            let small = letter.to_ascii_lowercase();
            Some((Key::new(Code::Char(small), Held::NONE), COARSE))
        }
        Code::Char(_) | Code::Tab => None,
        code if key.held.any() => {
            let steps = if ctrl || alt { FINE } else { 1.0 } * if shift { COARSE } else { 1.0 };
            Some((Key::new(code, Held::NONE), steps))
        }
        _ => None,
    }
}

/// One or two keys: the second and what must come before it.
fn strokes(keys: &str) -> [Option<Key>; 2] {
    let parse = |name: &str| Key::parse(name).ok();
    match keys.split_once(' ') {
        Some((first, second)) => [parse(first), parse(second)],
        None => [None, parse(keys)],
    }
}

/// What may follow a key that must be followed, for a message.
pub(crate) fn continuations(first: Key) -> String {
    let rows = ROWS
        .iter()
        .flat_map(|row| row.keys.iter().map(move |it| (it.0, row.help)));
    let following = rows.filter(|(keys, _)| strokes(keys)[0] == Some(first));
    let named = following.filter_map(|(keys, help)| {
        let second = strokes(keys)[1]?;
        Some(format!("{} {help}", shown(&second.name())))
    });
    named.collect::<Vec<_>>().join(", ")
}

/// The keys of a line of the help, as people write them: `Shift-Tab`, `Ctrl-R`.
pub(crate) fn shown_keys(row: &Row) -> String {
    let keys = row.keys.iter().map(|(keys, _)| {
        let parts = keys.split(' ').map(shown);
        parts.collect::<Vec<_>>().join(" ")
    });
    keys.collect::<Vec<_>>().join(" ")
}

fn shown(name: &str) -> String {
    let (held, code) = match name.rsplit_once('+') {
        Some((held, code)) if !code.is_empty() => (held, code),
        _ => return name.to_owned(),
    };
    let held = held.split('+').map(|modifier| {
        let (first, rest) = modifier.split_at(1);
        format!("{}{rest}-", first.to_uppercase())
    });
    let code = if code.len() == 1 {
        code.to_uppercase()
    } else {
        code.to_owned()
    };
    held.collect::<String>() + &code
}

/// The help: keys and what they do, a heading above each group (its keys empty).
pub(crate) fn help() -> Vec<(String, &'static str)> {
    let mut lines = Vec::new();
    let mut group = "";
    for row in &ROWS {
        if row.group != group {
            group = row.group;
            lines.push((String::new(), group));
        }
        lines.push((shown_keys(row), row.help));
    }
    lines.push((String::new(), "Mouse"));
    lines.extend(MOUSE.iter().map(|(what, help)| ((*what).to_owned(), *help)));
    lines.push((String::new(), STEPS));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brdf::NAMED_BRDFS;
    use crate::relight::COMPONENTS;

    fn mean(name: &str) -> Meaning {
        meaning(None, Key::parse(name).unwrap())
    }

    #[test]
    fn every_key_of_the_table_is_one_key_and_means_what_it_says() {
        let mut seen = Vec::new();
        for (keys, command) in ROWS.iter().flat_map(|row| row.keys) {
            let [first, key] = strokes(keys);
            assert!(key.is_some(), "{keys:?} is no key");
            assert!(!seen.contains(&[first, key]), "{keys:?} stands twice");
            seen.push([first, key]);
            assert_eq!(
                meaning(first, key.unwrap()),
                Meaning::Command(*command, 1.0)
            );
        }
        let begins: Vec<_> = seen.iter().filter_map(|strokes| strokes[0]).collect();
        assert!(
            begins
                .iter()
                .all(|first| !seen.contains(&[None, Some(*first)]))
        );
    }

    #[test]
    fn the_numbers_show_the_components_that_the_help_names() {
        let names = COMPONENTS.map(|(name, _)| name.replace('-', " "));
        let help = format!("component: {}", names.join(", "));
        let row = ROWS.iter().find(|row| row.help == help);
        let shown = row.expect("a row names them all in their order").keys;
        for (index, (_, component)) in COMPONENTS.iter().enumerate() {
            let digit = (index + 1) % 10;
            assert_eq!(
                shown[index],
                (digit.to_string().as_str(), C::Show(index as u8)),
                "{component}"
            );
        }
        assert_eq!(shown.len(), COMPONENTS.len());
    }

    #[test]
    fn the_help_names_the_kinds_of_surfaces_in_their_order() {
        let kinds = NAMED_BRDFS.map(|kind| kind.name).join(", ");
        let row = ROWS.iter().find(|row| row.help.ends_with(&kinds));
        let keys = [("}", C::Kind(1)), ("{", C::Kind(-1))];
        assert_eq!(row.map(|row| row.keys), Some(keys.as_slice()));
    }

    #[test]
    fn modifiers_change_the_step() {
        let left = C::Nudge(Left);
        assert_eq!(mean("shift+Left"), Meaning::Command(left, 10.0));
        assert_eq!(mean("ctrl+Left"), Meaning::Command(left, 0.1));
        assert_eq!(mean("alt+Left"), Meaning::Command(left, 0.1));
        assert_eq!(mean("W"), Meaning::Command(C::Walk(Away), 10.0));
        assert_eq!(mean("alt+i"), Meaning::Command(C::Brighter(1), 0.1));
        assert_eq!(mean("alt+I"), Meaning::Command(C::Brighter(-1), 0.1));
        assert_eq!(mean("I"), Meaning::Command(C::Brighter(-1), 1.0));
        assert_eq!(mean("n"), Meaning::Begins);
        assert_eq!(mean("ctrl+w"), Meaning::Nothing);
        assert_eq!(mean("F9"), Meaning::Nothing);
    }

    #[test]
    fn the_help_names_keys_as_people_do() {
        let help = help();
        let keys: Vec<&str> = help.iter().map(|(keys, _)| keys.as_str()).collect();
        for expected in ["Tab Shift-Tab", "u U Ctrl-R", "n n Ctrl-D", "+ = - *"] {
            assert!(keys.contains(&expected), "{keys:?}");
        }
        assert!(continuations(Key::parse("n").unwrap()).contains("p new point light"));
    }
}
