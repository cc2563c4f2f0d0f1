//! Undo and redo, without end.

use std::time::Duration;

/// Keys of one kind within this time of each other are one step.
const BURST: Duration = Duration::from_secs(1);

/// States before and after the present one. `S` is a state, `G` says what was
/// done: equal gestures in a row may be one step.
#[derive(Debug, Clone)]
pub(crate) struct History<S, G> {
    past: Vec<S>,
    future: Vec<S>,
    last: Option<(G, Duration)>,
}

impl<S, G> Default for History<S, G> {
    fn default() -> Self {
        Self {
            past: Vec::new(),
            future: Vec::new(),
            last: None,
        }
    }
}

impl<S, G: PartialEq> History<S, G> {
    /// Keeps the state before a change. A gesture joins the step before if that
    /// was the same, at most a second ago. What was undone is forgotten.
    pub(crate) fn record(&mut self, before: S, gesture: G, now: Duration) {
        let joins = self
            .last
            .as_ref()
            .is_some_and(|(last, time)| *last == gesture && now.saturating_sub(*time) <= BURST);
        if !joins {
            self.past.push(before);
        }
        self.future.clear();
        self.last = Some((gesture, now));
    }

    /// Lets the next gesture be a step of its own, whatever it is.
    pub(crate) fn end_gesture(&mut self) {
        self.last = None;
    }

    /// Changes every state that can be returned to.
    pub(crate) fn for_each(&mut self, change: impl FnMut(&mut S)) {
        self.past
            .iter_mut()
            .chain(&mut self.future)
            .for_each(change);
    }

    /// The state before the last step; `present` is what redo returns to.
    pub(crate) fn undo(&mut self, present: S) -> Option<S> {
        self.last = None;
        let before = self.past.pop()?;
        self.future.push(present);
        Some(before)
    }

    /// The state that was undone last.
    pub(crate) fn redo(&mut self, present: S) -> Option<S> {
        self.last = None;
        let after = self.future.pop()?;
        self.past.push(present);
        Some(after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bursts_are_one_step_and_a_new_change_forgets_what_was_undone() {
        let at = Duration::from_millis;
        let mut history: History<u32, &str> = History::default();
        history.record(0, "a", at(0));
        history.record(1, "a", at(900));
        history.record(2, "a", at(1800));
        history.record(3, "b", at(1900));
        history.record(4, "b", at(3000));
        assert_eq!(history.undo(5), Some(4), "more than a second later");
        assert_eq!(history.undo(4), Some(3));
        assert_eq!(history.undo(3), Some(0), "a burst");
        assert_eq!(history.undo(0), None);
        assert_eq!(history.redo(0), Some(3));
        history.record(3, "b", at(3100));
        assert_eq!(history.redo(9), None);
        assert_eq!([history.undo(9), history.undo(3)], [Some(3), Some(0)]);
    }
}
