//! What can be done to a scene and to the program, whichever key does it.

use super::light_edits::Way;
use super::new_lights::NewKind;

/// One thing to do. Signs are 1 for more or the next, -1 for less or the one
/// before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Command {
    SelectLight(i8),
    SelectSurface(i8),
    Deselect,
    /// Moves the selected light; the camera where none is selected.
    Nudge(Way),
    Orbit(Way),
    Pan(Way),
    Walk(Way),
    Dolly(i8),
    ResetView,
    LookAtSelected,
    Brighter(i8),
    Colder(i8),
    Hue(i8),
    Saturation(i8),
    /// Makes the selected surface the next named kind.
    Kind(i8),
    Rougher(i8),
    Open(i8),
    OpenBeam(i8),
    Turn(i8),
    Tilt(i8),
    Aim,
    Add(NewKind),
    Duplicate,
    Delete,
    Mute,
    Solo,
    /// Shows the component of this number in the table of components.
    Show(u8),
    Bounces(i8),
    AllBounces,
    Exposure(i8),
    Tone,
    Undo,
    Redo,
    Marks,
    Ask(Request),
}

/// What the program around the scene is asked to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Request {
    Save,
    WritePng,
    /// Shows the keys, or hides them.
    Help,
    Redraw,
    Suspend,
    Quit,
    /// Ctrl-C: ends at once, with unsaved changes and all.
    Interrupt,
}

impl Command {
    /// Whether the same command again, soon after, belongs to the same step of
    /// undo.
    pub(crate) fn is_part_of_a_burst(self) -> bool {
        !matches!(
            self,
            Self::Add(_) | Self::Duplicate | Self::Delete | Self::Mute | Self::Solo | Self::Kind(_)
        )
    }
}
