//! The interactive terminal program: a scene is lit by hand in a terminal.
