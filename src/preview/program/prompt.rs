//! Questions that the program asks, and what follows from the answers.

use super::{Effect, Program, QuitsAfter};
use crate::preview::input::{Code, Key};

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
    pub(super) fn answer(&mut self, prompt: Prompt, key: Key) -> Vec<Effect> {
        let Key { code, held } = key;
        if code == Code::Char('c') && held.ctrl {
            return vec![Effect::Quit(super::INTERRUPTED)];
        }
        let mut effects = match (prompt, code) {
            (_, Code::Esc) => {
                self.quits_after = None;
                Vec::new()
            }
            (Prompt::Quit, Code::Char('s')) => {
                self.quits_after = Some(QuitsAfter::Saving);
                self.save()
            }
            (Prompt::Quit, Code::Char('d')) => self.quit(),
            (Prompt::Overwrite, Code::Char('o')) => self.overwrite(),
            (Prompt::Overwrite | Prompt::Reload, Code::Char('r')) => {
                self.quits_after = None;
                vec![self.load(true)]
            }
            _ => {
                self.prompt = Some(prompt);
                return Vec::new();
            }
        };
        if self.prompt.is_none() && std::mem::take(&mut self.files_wait) {
            effects.extend(self.files_changed());
        }
        effects
    }
}
