//! Decodes image files.
