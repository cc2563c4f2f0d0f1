//! The interactive terminal program: a scene is lit by hand in a terminal.
//!
//! What a person does comes in as `input`, from a terminal or a `script`;
//! `keys` says which `command` it is, and `hands` turns that into `edits` of
//! a `document`, which can all be undone (`history`).

mod camera_moves;
mod colour;
mod command;
mod document;
mod drag;
mod edits;
mod hands;
mod history;
mod input;
mod keys;
mod light_edits;
mod marks;
mod new_lights;
mod script;
mod shapes;
mod steps;
mod view;
