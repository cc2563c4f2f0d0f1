//! Questions that the program asks, and what follows from the answers.

use super::{Effect, Program};
use crate::preview::input::{Code, Input, Key};

/// A question that stands in the status line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Prompt {
    /// There are unsaved changes.
    Quit,
    /// The file is not what was read, and is to be written.
    Overwrite,
    /// The file was changed, and so was the scene.
    Reload,
}

impl Prompt {
    /// The question.
    pub(super) fn text(self) -> &'static str {
        match self {
            Self::Quit => {
                "unsaved changes: s saves and quits, d discards them and quits, Esc stays"
            }
            Self::Overwrite => {
                "the scene file was changed meanwhile: o overwrites it, r reads it (u undoes that), \
                 Esc leaves it"
            }
            Self::Reload => {
                "the scene file was changed: r reads it (u undoes that), Esc keeps what is here"
            }
        }
    }
}

impl Program {
    /// Does what a key answers; asks again where it is no answer.
    pub(super) fn answer(&mut self, prompt: Prompt, input: Input) -> Vec<Effect> {
        let Input::Key(Key { code, held }) = input else {
            self.prompt = Some(prompt);
            return Vec::new();
        };
        if code == Code::Char('c') && held.ctrl {
            return vec![Effect::Quit(super::INTERRUPTED)];
        }
        match (prompt, code) {
            (_, Code::Esc) => Vec::new(),
            (Prompt::Quit, Code::Char('s')) => {
                let mut effects = self.save();
                if self.hands.is_unsaved() {
                    // It could not be saved, or there is another question.
                    return effects;
                }
                effects.push(Effect::Quit(0));
                effects
            }
            (Prompt::Quit, Code::Char('d')) => vec![Effect::Quit(0)],
            (Prompt::Overwrite, Code::Char('o')) => self.overwrite(),
            (Prompt::Overwrite | Prompt::Reload, Code::Char('r')) => vec![Effect::Load],
            _ => {
                self.prompt = Some(prompt);
                Vec::new()
            }
        }
    }
}
