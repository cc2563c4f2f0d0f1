//! The command line of `relume golden`, as clap reads it.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use crate::cli::args::{Run, Size, parse_size};

#[derive(Debug, Subcommand)]
pub(in crate::cli) enum Golden {
    /// Draw scenes, compare each with its golden, and write a report; exit code
    /// 1 if one differs, is missing its golden, or is black, constant or not
    /// finite.
    ///
    /// Of ROOT/a/b.toml the golden is ROOT/golden/a/b.png, where ROOT is the
    /// nearest folder above that holds a folder `golden`, or a/b.golden.png beside
    /// it; .exr for linear values. Limits and mask are those of the scene's
    /// [golden], by default 0; its `set` changes keys for the golden's frame. The
    /// exit code is the highest of all scenes': 2 for a scene that cannot be
    /// understood, 3 for a golden or a scene that cannot be read. Goldens without
    /// a scene are named and fail nothing.
    Check(Check),
    /// Make the frames of scenes that fail `check` their goldens; all others stay
    /// as they are. A black, constant or not finite frame is refused.
    Bless(Bless),
}

impl Golden {
    pub(in crate::cli) fn suite(&self) -> &SuiteArguments {
        match self {
            Self::Check(arguments) => &arguments.suite,
            Self::Bless(arguments) => &arguments.suite,
        }
    }
}

#[derive(Debug, Args)]
pub(in crate::cli) struct Check {
    #[command(flatten)]
    pub(super) suite: SuiteArguments,
    /// Folder for the report, made if it is missing: report.html, pictures/,
    /// summary.json, junit.xml. Not inside a folder of goldens.
    #[arg(short, long, value_name = "DIR", default_value = "golden-report")]
    pub(super) output: PathBuf,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct Bless {
    #[command(flatten)]
    pub(super) suite: SuiteArguments,
    /// Format of goldens that are missing: png (8-bit levels) or exr (linear
    /// values).
    #[arg(long, value_name = "NAME", default_value = "png")]
    pub(super) format: GoldenFormat,
    /// Bless even where the environment variable CI is set: nobody looks at
    /// goldens that a CI makes.
    #[arg(long)]
    pub(super) in_ci: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum GoldenFormat {
    Png,
    Exr,
}

/// Scenes, and what to change in all of them.
#[derive(Debug, Args)]
pub(in crate::cli) struct SuiteArguments {
    /// Scene files, and folders to look for scenes in: .toml files that set
    /// `mesh` or have a golden.
    #[arg(value_name = "PATH", default_value = ".")]
    pub(super) paths: Vec<PathBuf>,
    /// Change a key of every scene, as in bake.rays=128, after the `set` of its
    /// [golden]; repeatable. Give the same to check and bless.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(super) overrides: Vec<String>,
    /// Size of all frames in pixels, instead of the scenes'.
    #[arg(long, value_parser = parse_size, value_name = "WxH")]
    pub(super) size: Option<Size>,
    #[command(flatten)]
    pub(in crate::cli) run: Run,
}
