//! What a person does: keys, the mouse and a new size of the terminal, the same
//! whether it comes from a terminal or from a script.

use crossterm::event::{
    Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers, MouseButton, MouseEvent, MouseEventKind,
};

/// One thing that a person does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Input {
    Key(Key),
    Mouse(Mouse),
    /// The terminal has another size, cells.
    Resize {
        columns: u16,
        rows: u16,
    },
}

/// A key that was pressed, or repeats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Key {
    pub(crate) code: Code,
    pub(crate) held: Held,
}

/// Which key. A letter is the letter that it writes, so that Shift is part of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Code {
    Char(char),
    Enter,
    Esc,
    Tab,
    Backspace,
    Delete,
    Insert,
    Home,
    End,
    PageUp,
    PageDown,
    Up,
    Down,
    Left,
    Right,
    F(u8),
}

/// Modifiers that are held down.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Held {
    pub(crate) shift: bool,
    pub(crate) ctrl: bool,
    pub(crate) alt: bool,
}

/// Something done with the mouse over a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Mouse {
    pub(crate) action: Action,
    pub(crate) column: u16,
    pub(crate) row: u16,
    pub(crate) held: Held,
}

/// What is done with the mouse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Action {
    Press(Button),
    Drag(Button),
    Release(Button),
    Move,
    ScrollUp,
    ScrollDown,
}

/// A button of the mouse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Button {
    Left,
    Middle,
    Right,
}

/// Keys that are no letters, as scripts and the help call them.
const NAMES: [(&str, Code); 14] = [
    ("Enter", Code::Enter),
    ("Esc", Code::Esc),
    ("Tab", Code::Tab),
    ("Backspace", Code::Backspace),
    ("Delete", Code::Delete),
    ("Insert", Code::Insert),
    ("Home", Code::Home),
    ("End", Code::End),
    ("PgUp", Code::PageUp),
    ("PgDn", Code::PageDown),
    ("Up", Code::Up),
    ("Down", Code::Down),
    ("Left", Code::Left),
    ("Right", Code::Right),
];

impl Held {
    pub(crate) const NONE: Self = Self {
        shift: false,
        ctrl: false,
        alt: false,
    };

    /// Whether any is held.
    pub(crate) fn any(self) -> bool {
        self != Self::NONE
    }

    fn of(modifiers: KeyModifiers) -> Self {
        Self {
            shift: modifiers.contains(KeyModifiers::SHIFT),
            ctrl: modifiers.contains(KeyModifiers::CONTROL),
            alt: modifiers.contains(KeyModifiers::ALT),
        }
    }
}

impl Key {
    /// A key as every terminal would send it: Shift is part of a letter, and of
    /// Ctrl with a letter terminals do not tell the case.
    pub(crate) fn new(code: Code, held: Held) -> Self {
        match code {
            Code::Char(letter) => {
                let lower = letter.to_ascii_lowercase();
                Self {
                    code: Code::Char(if held.ctrl { lower } else { letter }),
                    held: Held {
                        shift: false,
                        ..held
                    },
                }
            }
            _ => Self { code, held },
        }
    }

    /// A key by its name: `x`, `shift+Up`, `ctrl+s`, `Space`, `F5`.
    ///
    /// # Errors
    /// What is wrong, and what is allowed.
    pub(crate) fn parse(name: &str) -> Result<Self, String> {
        let mut held = Held::NONE;
        let mut rest = name;
        // A plus may be the key itself.
        while let Some((modifier, key)) = rest.split_once('+').filter(|(_, key)| !key.is_empty()) {
            match modifier {
                "shift" => held.shift = true,
                "ctrl" => held.ctrl = true,
                "alt" => held.alt = true,
                _ => {
                    let message = "modifiers are shift, ctrl and alt";
                    return Err(format!(
                        "unknown modifier {modifier:?} of {name:?}; {message}"
                    ));
                }
            }
            rest = key;
        }
        Ok(Self::new(code(rest)?, held))
    }

    /// The name that [`Self::parse`] takes.
    pub(crate) fn name(self) -> String {
        let modifiers = [
            (self.held.ctrl, "ctrl+"),
            (self.held.alt, "alt+"),
            (self.held.shift, "shift+"),
        ];
        let held = modifiers.iter().filter(|(is_held, _)| *is_held);
        let mut name: String = held.map(|(_, name)| *name).collect();
        match self.code {
            Code::Char(' ') => name.push_str("Space"),
            Code::Char(letter) => name.push(letter),
            Code::F(number) => name.push_str(&format!("F{number}")),
            code => {
                let known = NAMES.iter().find(|(_, known)| *known == code);
                name.push_str(known.map_or("", |(name, _)| name));
            }
        }
        name
    }
}

fn code(name: &str) -> Result<Code, String> {
    let mut letters = name.chars();
    if let (Some(letter), None) = (letters.next(), letters.next()) {
        return Ok(Code::Char(letter));
    }
    if name.eq_ignore_ascii_case("space") {
        return Ok(Code::Char(' '));
    }
    let function = name
        .strip_prefix(['F', 'f'])
        .and_then(|n| n.parse::<u8>().ok());
    if let Some(number @ 1..=12) = function {
        return Ok(Code::F(number));
    }
    let known = NAMES
        .iter()
        .find(|(known, _)| known.eq_ignore_ascii_case(name));
    known.map(|(_, code)| *code).ok_or_else(|| {
        let names = NAMES.map(|(name, _)| name).join(", ");
        format!("no key is called {name:?}; keys are single letters, Space, F1 to F12, {names}")
    })
}

impl Input {
    /// Whether a button of the mouse is let go.
    pub(crate) fn is_release(&self) -> bool {
        matches!(self, Self::Mouse(mouse) if matches!(mouse.action, Action::Release(_)))
    }

    /// What an event of the terminal means; `None` for what nobody did on purpose,
    /// such as a key that was let go.
    pub(crate) fn of_terminal(event: &Event) -> Option<Self> {
        match event {
            Event::Key(event) => key_of(event).map(Self::Key),
            Event::Mouse(event) => mouse_of(event).map(Self::Mouse),
            Event::Resize(columns, rows) => Some(Self::Resize {
                columns: *columns,
                rows: *rows,
            }),
            _ => None,
        }
    }
}

fn key_of(event: &KeyEvent) -> Option<Key> {
    if event.kind == KeyEventKind::Release {
        return None;
    }
    let mut held = Held::of(event.modifiers);
    let code = match event.code {
        KeyCode::Char(letter) if held.shift => Code::Char(upper(letter)),
        KeyCode::Char(letter) => Code::Char(letter),
        KeyCode::Enter => Code::Enter,
        KeyCode::Esc => Code::Esc,
        KeyCode::Tab => Code::Tab,
        KeyCode::BackTab => {
            held.shift = true;
            Code::Tab
        }
        KeyCode::Backspace => Code::Backspace,
        KeyCode::Delete => Code::Delete,
        KeyCode::Insert => Code::Insert,
        KeyCode::Home => Code::Home,
        KeyCode::End => Code::End,
        KeyCode::PageUp => Code::PageUp,
        KeyCode::PageDown => Code::PageDown,
        KeyCode::Up => Code::Up,
        KeyCode::Down => Code::Down,
        KeyCode::Left => Code::Left,
        KeyCode::Right => Code::Right,
        KeyCode::F(number) => Code::F(number),
        _ => return None,
    };
    Some(Key::new(code, held))
}

/// Some terminals send a letter with Shift in lower case.
fn upper(letter: char) -> char {
    let mut upper = letter.to_uppercase();
    match (upper.next(), upper.next()) {
        (Some(upper), None) => upper,
        _ => letter,
    }
}

fn mouse_of(event: &MouseEvent) -> Option<Mouse> {
    let action = match event.kind {
        MouseEventKind::Down(button) => Action::Press(button_of(button)),
        MouseEventKind::Drag(button) => Action::Drag(button_of(button)),
        MouseEventKind::Up(button) => Action::Release(button_of(button)),
        MouseEventKind::Moved => Action::Move,
        MouseEventKind::ScrollUp => Action::ScrollUp,
        MouseEventKind::ScrollDown => Action::ScrollDown,
        MouseEventKind::ScrollLeft | MouseEventKind::ScrollRight => return None,
    };
    Some(Mouse {
        action,
        column: event.column,
        row: event.row,
        held: Held::of(event.modifiers),
    })
}

fn button_of(button: MouseButton) -> Button {
    match button {
        MouseButton::Left => Button::Left,
        MouseButton::Middle => Button::Middle,
        MouseButton::Right => Button::Right,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sent(code: KeyCode, modifiers: KeyModifiers) -> Option<Input> {
        Input::of_terminal(&Event::Key(KeyEvent::new(code, modifiers)))
    }

    #[test]
    fn terminals_and_names_give_the_same_keys() {
        let none = KeyModifiers::NONE;
        for (code, modifiers, name) in [
            (KeyCode::Char('x'), none, "x"),
            (KeyCode::Char('X'), KeyModifiers::SHIFT, "X"),
            (KeyCode::Char('x'), KeyModifiers::SHIFT, "X"),
            (KeyCode::Char('?'), KeyModifiers::SHIFT, "?"),
            (KeyCode::Char('s'), KeyModifiers::CONTROL, "ctrl+s"),
            (KeyCode::Char('+'), none, "+"),
            (KeyCode::Char(' '), none, "Space"),
            (KeyCode::BackTab, KeyModifiers::SHIFT, "shift+Tab"),
            (KeyCode::BackTab, none, "shift+Tab"),
            (KeyCode::Up, KeyModifiers::SHIFT, "shift+Up"),
            (KeyCode::PageDown, KeyModifiers::ALT, "alt+PgDn"),
            (KeyCode::F(5), none, "F5"),
        ] {
            let key = Key::parse(name).unwrap();
            assert_eq!(sent(code, modifiers), Some(Input::Key(key)), "{name}");
            assert_eq!(Key::parse(&key.name()), Ok(key), "{name}");
        }
        assert_eq!(Key::parse("ctrl++").unwrap().code, Code::Char('+'));
        let released = KeyEvent::new_with_kind(KeyCode::Tab, none, KeyEventKind::Release);
        assert_eq!(Input::of_terminal(&Event::Key(released)), None);
    }

    #[test]
    fn unknown_names_say_what_is_allowed() {
        assert!(Key::parse("Foo").unwrap_err().contains("PgUp"));
        assert!(Key::parse("super+x").unwrap_err().contains("alt"));
        assert!(Key::parse("").is_err() && Key::parse("F13").is_err());
    }
}
