//! relume relights scenes on a CPU.

mod maths;
mod scene;
