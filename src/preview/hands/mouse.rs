//! What the mouse does: a mark is dragged or its light selected, a surface is
//! selected, the camera is moved.

use std::time::Duration;

use super::{Gesture, Hands, Outcome, Selection, Sight};
use crate::preview::command::Command;
use crate::preview::document::Changed;
use crate::preview::drag::{Drag, Dragged};
use crate::preview::input::{Action, Button, Mouse};
use crate::preview::light_edits::described;
use crate::preview::marks::nearest;
use crate::preview::view::View;

impl Hands {
    pub(super) fn mouse(
        &mut self,
        mouse: Mouse,
        view: &View,
        sight: Sight<'_>,
        now: Duration,
    ) -> Outcome {
        match mouse.action {
            Action::Press(button) if view.holds(mouse.column, mouse.row) => {
                self.press(mouse, button, view)
            }
            Action::Drag(_) => self.drag_to(mouse, view, now),
            Action::Release(button) => {
                let outcome = self.drag_to(mouse, view, now);
                let Some(drag) = self.drag.take() else {
                    return outcome;
                };
                self.history.end_gesture();
                let is_click = !drag.has_moved && button == Button::Left;
                if is_click && matches!(drag.what, Dragged::Orbit | Dragged::Pan) {
                    return self.click(mouse, view, sight);
                }
                outcome
            }
            Action::ScrollUp | Action::ScrollDown if view.holds(mouse.column, mouse.row) => {
                let sign = if mouse.action == Action::ScrollUp {
                    1
                } else {
                    -1
                };
                let command = match self.selection {
                    Selection::Nothing => Command::Dolly(sign),
                    _ if mouse.held.any() => Command::Brighter(sign),
                    _ => Command::Dolly(sign),
                };
                self.command(command, 1.0, view, now)
            }
            _ => Outcome::default(),
        }
    }

    fn press(&mut self, mouse: Mouse, button: Button, view: &View) -> Outcome {
        let px = view.px_of_cell(mouse.column, mouse.row);
        let marks = if self.hides_marks {
            Vec::new()
        } else {
            self.marks(view)
        };
        let hit = nearest(&marks, view, px, self.selected_light());
        let is_plain = button == Button::Left && !mouse.held.any();
        let hit = hit.filter(|_| button != Button::Middle);
        let what = match hit {
            Some(index) if is_plain => Dragged::Across(index),
            Some(index) => Dragged::Along(index),
            None if is_plain => Dragged::Orbit,
            None => Dragged::Pan,
        };
        // A mark at the border is not where its light is: the light comes to the
        // pointer.
        let grip = hit.map(|index| &marks[index]);
        let grip = grip.filter(|mark| mark.is_in_place).map(|mark| mark.px);
        let cell = [mouse.column, mouse.row];
        self.drag = Some(Drag::new(what, cell, view, grip, self.document.clone()));
        self.gestures += 1;
        match hit {
            Some(index) => self.select(Selection::Light(index), ""),
            None => Outcome::default(),
        }
    }

    fn drag_to(&mut self, mouse: Mouse, view: &View, now: Duration) -> Outcome {
        let Some(drag) = &mut self.drag else {
            return Outcome::default();
        };
        if !drag.has_moved && drag.cell == [mouse.column, mouse.row] {
            return Outcome::default();
        }
        drag.has_moved = true;
        let document = drag.to(view.px_of_cell(mouse.column, mouse.row), view);
        if !document.is_valid() || !document.differs(&self.document) {
            return Outcome::default();
        }
        if !drag.is_recorded {
            drag.is_recorded = true;
            let before = (drag.start.clone(), self.selection);
            self.history
                .record(before, Gesture::Single(self.gestures), now);
        }
        let changed = Changed::between(&self.document, &document);
        self.document = document;
        let light = self.selected_light().filter(|_| changed.lights);
        let light = light.and_then(|index| self.document.lights.get(index));
        Outcome {
            changed,
            message: light.map(|it| {
                let place = described(&it.light.kind);
                format!("{}: {place}", it.light.name)
            }),
            request: None,
        }
    }

    fn click(&mut self, mouse: Mouse, view: &View, sight: Sight<'_>) -> Outcome {
        match sight(view.px_of_cell(mouse.column, mouse.row)) {
            Some(seen) if seen.material < self.material_names.len() => {
                self.clicked = Some(seen.point);
                self.select(Selection::Surface(seen.material), "")
            }
            _ => self.select(Selection::Nothing, ""),
        }
    }
}
