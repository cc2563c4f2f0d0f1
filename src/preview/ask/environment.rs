//! What the environment says of the terminal.

/// The variables that say something, as they are.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Environment {
    /// `TERM`: the terminal's kind.
    pub(crate) term: String,
    /// `TERM_PROGRAM`, or iTerm2's `LC_TERMINAL`, which goes through ssh.
    pub(crate) program: String,
    /// Whether `COLORTERM` says 24 bits, or Windows Terminal is there.
    pub(crate) says_true_colour: bool,
    /// Whether `NO_COLOR` is there and not empty (<https://no-color.org>).
    pub(crate) wants_no_colour: bool,
    /// Whether tmux is in between.
    pub(crate) is_tmux: bool,
    /// Whether screen is in between.
    pub(crate) is_screen: bool,
    /// Whether the terminal is at the other end of a network.
    pub(crate) is_remote: bool,
}

impl Environment {
    /// The program's own.
    pub(crate) fn of_process() -> Self {
        Self::read(|name| std::env::var(name).ok())
    }

    /// From a look-up of variables; an empty one is as good as none.
    pub(crate) fn read(variable: impl Fn(&str) -> Option<String>) -> Self {
        let text = |name: &str| variable(name).unwrap_or_default();
        let has = |name: &str| !text(name).is_empty();
        let term = text("TERM");
        let program = match text("TERM_PROGRAM") {
            none if none.is_empty() => text("LC_TERMINAL"),
            program => program,
        };
        Self {
            says_true_colour: matches!(text("COLORTERM").as_str(), "truecolor" | "24bit")
                || has("WT_SESSION"),
            wants_no_colour: has("NO_COLOR"),
            is_tmux: has("TMUX") || term.starts_with("tmux"),
            is_screen: has("STY") || (term.starts_with("screen") && !has("TMUX")),
            is_remote: has("SSH_CONNECTION") || has("SSH_TTY"),
            term,
            program,
        }
    }

    /// Whether another program draws what we send.
    pub(crate) fn is_behind_another(&self) -> bool {
        self.is_tmux || self.is_screen
    }

    /// Whether the terminal can do nothing but print.
    pub(crate) fn is_dumb(&self) -> bool {
        self.term == "dumb"
    }

    /// Whether the terminal may be asked: consoles and terminals of no kind print
    /// questions or swallow what follows.
    pub(crate) fn may_be_asked(&self) -> bool {
        !matches!(
            self.term.as_str(),
            "" | "dumb" | "linux" | "cons25" | "vt52"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(variables: &[(&str, &str)]) -> Environment {
        Environment::read(|name| {
            let found = variables.iter().find(|(known, _)| *known == name);
            found.map(|(_, value)| (*value).to_owned())
        })
    }

    #[test]
    fn variables_are_read() {
        let found = of(&[
            ("TERM", "xterm-256color"),
            ("COLORTERM", "truecolor"),
            ("NO_COLOR", ""),
            ("LC_TERMINAL", "iTerm2"),
            ("SSH_TTY", "/dev/pts/3"),
        ]);
        assert!(found.says_true_colour && found.is_remote && !found.wants_no_colour);
        assert_eq!(found.program, "iTerm2");
        assert!(found.may_be_asked() && !found.is_behind_another());
    }

    #[test]
    fn tmux_calls_itself_screen_too() {
        let tmux = of(&[
            ("TERM", "screen-256color"),
            ("TMUX", "/tmp/tmux-0/default,1,0"),
        ]);
        assert!(tmux.is_tmux && !tmux.is_screen);
        assert!(of(&[("TERM", "screen")]).is_screen);
        assert!(!of(&[]).may_be_asked());
    }
}
