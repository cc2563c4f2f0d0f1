//! Answers that come after the wait is over, which would be read as keys.
//!
//! The reader of keys takes a device's string for alt and a letter, and then for
//! what the string says, letter by letter: a "q" in a terminal's name would quit.
//! So as long as answers are outstanding such a string is dropped from its first
//! key to its last.

use std::time::{Duration, Instant};

use crossterm::event::{Event, KeyCode, KeyEvent, KeyModifiers};

/// How long after the questions an answer may come.
const LATEST: Duration = Duration::from_secs(5);
/// Most keys of an answer; more are keys that somebody types.
const MOST_KEYS: u32 = 96;
/// Letters that begin the strings of answers: DCS and APC.
const BEGINNINGS: [char; 2] = ['P', '_'];

/// Drops late answers out of the events.
#[derive(Debug)]
pub(crate) struct LateAnswers {
    /// Until when answers may come; none if all have.
    until: Option<Instant>,
    /// Keys left of the string that is being dropped.
    left: u32,
}

impl LateAnswers {
    /// After questions at a time; `are_outstanding` if the last was not answered.
    pub(crate) fn new(asked: Instant, are_outstanding: bool) -> Self {
        Self {
            until: are_outstanding.then(|| asked + LATEST),
            left: 0,
        }
    }

    /// Whether an event that has come now is the user's.
    pub(crate) fn is_input(&mut self, event: &Event) -> bool {
        let Some(until) = self.until else {
            return true;
        };
        let Event::Key(key) = event else {
            return true;
        };
        if self.left > 0 {
            // `ESC \` ends it.
            self.left = match is_alt(key, '\\') {
                true => 0,
                false => self.left - 1,
            };
            return false;
        }
        if Instant::now() > until {
            self.until = None;
            return true;
        }
        if BEGINNINGS.iter().any(|&letter| is_alt(key, letter)) {
            self.left = MOST_KEYS;
            return false;
        }
        true
    }
}

fn is_alt(key: &KeyEvent, letter: char) -> bool {
    key.code == KeyCode::Char(letter) && key.modifiers.contains(KeyModifiers::ALT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::ask::typed_events;

    fn passed(late: &mut LateAnswers, bytes: &[u8]) -> usize {
        let mut events = typed_events(bytes);
        events.retain(|event| late.is_input(event));
        events.len()
    }

    #[test]
    fn a_late_name_is_no_keys() {
        let mut late = LateAnswers::new(Instant::now(), true);
        assert_eq!(passed(&mut late, b"a\x1bP>|quick(1.2)\x1b\\b"), 2);
        assert_eq!(passed(&mut late, b"\x1b_Gi=1;OK\x1b\\q"), 1);
    }

    #[test]
    fn a_string_without_end_does_not_swallow_all() {
        let mut late = LateAnswers::new(Instant::now(), true);
        assert_eq!(
            passed(&mut late, &[b"\x1bP", &[b'x'; 200][..]].concat()),
            104
        );
    }

    #[test]
    fn keys_are_keys_once_all_is_answered_or_too_late() {
        let mut late = LateAnswers::new(Instant::now(), false);
        assert_eq!(passed(&mut late, b"\x1bPq"), 2);
        let long_ago = Instant::now().checked_sub(LATEST * 2);
        let mut late = LateAnswers::new(long_ago.unwrap(), true);
        assert_eq!(passed(&mut late, b"\x1bPq"), 2);
    }
}
