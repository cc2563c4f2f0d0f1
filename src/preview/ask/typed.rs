//! Keys that were typed while the terminal was being asked, as the events that
//! they would have been.
//!
//! crossterm reads the terminal itself and takes no bytes, so the few keys that
//! somebody may hit in the first moment are read here: characters, control keys,
//! arrows and their like. Other sequences are dropped as a whole.

use crossterm::event::{Event, KeyCode, KeyEvent, KeyModifiers};

/// Events of bytes that are no answers.
pub(crate) fn typed_events(bytes: &[u8]) -> Vec<Event> {
    let mut events = Vec::new();
    let mut left = bytes;
    while !left.is_empty() {
        let (key, length) = key(left);
        events.extend(key.map(Event::Key));
        left = &left[length.clamp(1, left.len())..];
    }
    events
}

/// The first key and its bytes; none where they are not understood.
fn key(bytes: &[u8]) -> (Option<KeyEvent>, usize) {
    match bytes {
        [0x1b, b'[', inner @ ..] => {
            let end = inner.iter().position(|byte| (0x40..0x7f).contains(byte));
            let inner = &inner[..end.map_or(inner.len(), |end| end + 1)];
            (named(inner).map(KeyEvent::from), 2 + inner.len())
        }
        [0x1b, b'O', letter, ..] => (named(&[*letter]).map(KeyEvent::from), 3),
        [0x1b, 0x1b, ..] | [0x1b] => (Some(KeyCode::Esc.into()), 1),
        [0x1b, behind @ ..] => {
            let (key, length) = key(behind);
            let with_alt = key.map(|key| KeyEvent {
                modifiers: key.modifiers | KeyModifiers::ALT,
                ..key
            });
            (with_alt, 1 + length)
        }
        _ => plain(bytes),
    }
}

/// What stands behind `ESC [` or `ESC O` of a key that has a name.
fn named(inner: &[u8]) -> Option<KeyCode> {
    Some(match inner {
        b"A" => KeyCode::Up,
        b"B" => KeyCode::Down,
        b"C" => KeyCode::Right,
        b"D" => KeyCode::Left,
        b"H" | b"1~" => KeyCode::Home,
        b"F" | b"4~" => KeyCode::End,
        b"Z" => KeyCode::BackTab,
        b"3~" => KeyCode::Delete,
        b"5~" => KeyCode::PageUp,
        b"6~" => KeyCode::PageDown,
        _ => return None,
    })
}

/// A control key or a character.
fn plain(bytes: &[u8]) -> (Option<KeyEvent>, usize) {
    let key = match bytes[0] {
        b'\r' => KeyCode::Enter.into(),
        b'\t' => KeyCode::Tab.into(),
        0x7f => KeyCode::Backspace.into(),
        byte @ 1..=26 => {
            let letter = char::from(b'a' + byte - 1);
            KeyEvent::new(KeyCode::Char(letter), KeyModifiers::CONTROL)
        }
        0..=31 => return (None, 1),
        _ => return character(bytes),
    };
    (Some(key), 1)
}

fn character(bytes: &[u8]) -> (Option<KeyEvent>, usize) {
    let text = bytes.utf8_chunks().next().map_or("", |chunk| chunk.valid());
    let Some(letter) = text.chars().next() else {
        return (None, 1);
    };
    let modifiers = match letter.is_uppercase() {
        true => KeyModifiers::SHIFT,
        false => KeyModifiers::NONE,
    };
    let key = KeyEvent::new(KeyCode::Char(letter), modifiers);
    (Some(key), letter.len_utf8())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_become_their_events() {
        let key = |code, modifiers| Event::Key(KeyEvent::new(code, modifiers));
        let none = KeyModifiers::NONE;
        assert_eq!(
            typed_events("qÉ\x03\r\x1b[A\x1b[6~\x1b[?9;9z\x1bOC\x1bx\x1b".as_bytes()),
            [
                key(KeyCode::Char('q'), none),
                key(KeyCode::Char('É'), KeyModifiers::SHIFT),
                key(KeyCode::Char('c'), KeyModifiers::CONTROL),
                key(KeyCode::Enter, none),
                key(KeyCode::Up, none),
                key(KeyCode::PageDown, none),
                key(KeyCode::Right, none),
                key(KeyCode::Char('x'), KeyModifiers::ALT),
                key(KeyCode::Esc, none),
            ]
        );
    }

    #[test]
    fn bytes_without_meaning_end() {
        for number in 0..20_000_u32 {
            let bytes = crate::maths::hash::mix(number).to_be_bytes();
            assert!(typed_events(&bytes).len() <= 4);
            let [a, b, c, _] = bytes;
            assert!(typed_events(&[0x1b, b'[', a, 0x1b, b, c]).len() <= 6);
        }
    }
}
