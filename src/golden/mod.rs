//! Scenes and frames held against golden images: pictures that were looked at,
//! once, and that every later frame has to equal.
//!
//! Comes in: scene files ([`find`]), or a frame that is already there
//! ([`Expected`]). Goes out: a [`Verdict`] for each scene, its golden written
//! anew ([`Checked::bless`]), and the files of a report. `relume golden
//! check|bless` is this room with a command line; [`check_scene`] is for
//! `cargo test`.
//!
//! # Where a golden is
//!
//! The root of a scene is the nearest folder above it that holds a folder
//! `golden` (looked for up to the folder with `.git`, or to the top). The golden
//! of `ROOT/scenes/box.toml` is `ROOT/golden/scenes/box.png`; without a root, or
//! where it is there already, `ROOT/scenes/box.golden.png`. An EXR in its place
//! holds linear values.
//!
//! # What is compared
//!
//! The frame as the scene file asks for it, with what `set` of its `[golden]`
//! changes, judged by the limits and the mask of `[golden]`:
//!
//! ```toml
//! [golden]
//! set = ["camera.size=[160, 120]", "bake.rays=128"]  # as --set has it
//! max_channel_difference = 1                         # levels; 0 by default
//! ```
//!
//! A frame that is black, of one colour or not finite fails whatever its golden
//! holds. A scene without a golden fails.
//!
//! # In the tests of another crate
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let mesh = "o floor\nv 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 4 3 2 1\n";
//! # std::fs::write(folder.path().join("floor.obj"), mesh)?;
//! # let text = r#"mesh = "floor.obj"
//! # [camera]
//! # position = [0.5, 1.0, 2.0]
//! # target = [0.5, 0.0, 0.5]
//! # vfov = 40.0
//! # size = [16, 12]
//! # [[light]]
//! # kind = "point"
//! # position = [0.5, 0.5, 0.5]
//! # intensity = [1.0, 1.0, 1.0]
//! # [render]
//! # bounces = 0
//! # "#;
//! # let scene = folder.path().join("floor.toml");
//! # std::fs::write(&scene, text)?;
//! use relume::golden::{self, GoldenError};
//!
//! // In a test, `scene` is a file of the repository, and the folder for what a
//! // failure shows is `env!("CARGO_TARGET_TMPDIR").as_ref()`.
//! let outcome = golden::check_scene(&scene, folder.path());
//! // Nobody has made the golden yet; `RELUME_BLESS=1 cargo test` does, and fails
//! // too, so that a new golden never passes unseen.
//! assert!(matches!(outcome, Err(GoldenError::Missing { .. })));
//! # Ok(())
//! # }
//! ```

mod check;
mod error;
mod expect;
mod fault;
mod find;
mod junit;
mod page;
mod place;
mod verdict;

pub use check::{Checked, DrawSettings, Drawn, Pictures, Stopped};
pub use error::{CheckError, GoldenError};
pub use expect::{BLESS_VARIABLE, Expected, check_scene};
pub use fault::FrameFault;
pub use find::{FindError, Suite, find};
pub use junit::junit;
pub use page::{PageError, picture_names, report_files};
pub use place::GoldenScene;
pub use verdict::Verdict;
