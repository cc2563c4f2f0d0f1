//! A quantity of the scene that changes from frame to frame.

/// `[[animate]]`: linear between key frames, constant before and after them.
#[derive(Debug, Clone, PartialEq)]
pub struct Animation {
    /// What changes, such as `light.lamp.position`; it exists.
    pub target: String,
    /// Numbers of the key frames, at least one, each above the one before.
    pub frames: Vec<f64>,
    /// Values at the key frames, as many as frames, each with equally many
    /// components (one for a plain number).
    pub values: Vec<Vec<f64>>,
}
