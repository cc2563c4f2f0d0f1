//! The command line, as clap reads it.

use std::path::PathBuf;

use super::golden::Golden;
use clap::{Args, Parser, Subcommand};
use relume::preview::{ColourChoice, ProtocolChoice, UnknownChoice};
use relume::reference::GlossyBounces;
use relume::{
    Bounces, Component, ComponentError, PixelLimit, Quality, QualityError, Scheme, SimdLevel,
};

/// Relight OBJ scenes on a CPU, with bounced light.
#[derive(Debug, Parser)]
#[command(version, propagate_version = true, arg_required_else_help = true)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Draw one frame; bakes first where the cache has no valid bake.
    Render(Render),
    /// Precompute how light travels in a scene, for later frames.
    Bake(Bake),
    /// Say what a scene asks for and what it will cost; bakes nothing.
    Info(Info),
    /// Compare two images; exit code 1 if they differ by more than the limits
    /// that are given, or at all if none is. Alpha is compared where either file
    /// has it.
    Diff(Diff),
    /// Hold scenes against their golden images, or make their frames the goldens.
    #[command(subcommand)]
    Golden(Golden),
    /// Path-trace a scene: slow, and the truth to compare frames with.
    Reference(Reference),
    /// Measure speed against error and write a report; or time relighting.
    Measure(Measure),
    /// Light a scene by hand, in the terminal: drag lamps, see bounced light follow,
    /// save. ? shows the keys.
    Preview(Preview),
}

impl Command {
    pub(super) fn run_arguments(&self) -> &Run {
        match self {
            Self::Render(arguments) => &arguments.scene.run,
            Self::Bake(arguments) => &arguments.scene.run,
            Self::Info(arguments) => &arguments.scene.run,
            Self::Diff(arguments) => &arguments.run,
            Self::Golden(arguments) => &arguments.suite().run,
            Self::Reference(arguments) => &arguments.scene.run,
            Self::Measure(arguments) => &arguments.scene.run,
            Self::Preview(arguments) => &arguments.scene.run,
        }
    }
}

#[derive(Debug, Args)]
pub(super) struct Render {
    #[command(flatten)]
    pub(super) scene: SceneArguments,
    #[command(flatten)]
    pub(super) view: ViewArguments,
    /// What to show.
    #[arg(long, default_value = "global", value_parser = parse_component, value_name = "NAME",
          long_help = "What to show: global, direct, indirect, glossy, irradiance, albedo, normal, \
                       depth, \
                       approximated-direct (direct light as the basis has it), partitions (of the \
                       basis), basis:K (its function K, from 0) or basis:P.K (function K of \
                       partition P).")]
    pub(super) component: Component,
    /// Where pixels have their indirect light and the sky's from: standard (from the
    /// vertices, in milliseconds) or gather (by rays of their own, in seconds: for
    /// still pictures).
    #[arg(long, default_value = "standard", value_parser = parse_quality, value_name = "NAME")]
    pub(super) quality: Quality,
}

#[derive(Debug, Args)]
pub(super) struct Bake {
    #[command(flatten)]
    pub(super) scene: SceneArguments,
}

#[derive(Debug, Args)]
pub(super) struct Info {
    #[command(flatten)]
    pub(super) scene: SceneArguments,
}

#[derive(Debug, Args)]
pub(super) struct Diff {
    /// The image that is right (.png or .exr).
    pub(super) reference: PathBuf,
    /// The image to judge, of the same format and size.
    pub(super) candidate: PathBuf,
    /// Largest difference of a channel that passes: levels of 255 for PNG,
    /// linear values for EXR [default: 0].
    #[arg(long, value_name = "X", value_parser = parse_limit, allow_negative_numbers = true)]
    pub(super) max_channel_difference: Option<f64>,
    /// Pixels that may differ by more than that: a number, or a share as in
    /// 0.5% [default: 0].
    #[arg(long, value_name = "N|P%", value_parser = parse_pixel_limit,
          allow_negative_numbers = true)]
    pub(super) max_differing_pixels: Option<PixelLimit>,
    /// Largest mean FLIP (the difference that an observer sees, 0 to 1) that
    /// passes [default: 0]. Alone, it is the only limit; beside one on channels
    /// or pixels, both must hold.
    #[arg(long, value_name = "X", value_parser = parse_flip, allow_negative_numbers = true)]
    pub(super) max_flip: Option<f64>,
    /// Grey picture of the same size: a pixel of level g may differ by g levels
    /// of 255, a white one is ignored.
    #[arg(long, value_name = "FILE.png")]
    pub(super) mask: Option<PathBuf>,
    /// Write reference, difference and candidate side by side.
    #[arg(long, value_name = "FILE.png")]
    pub(super) strip: Option<PathBuf>,
    /// Write FLIP by pixel as colours, with a legend.
    #[arg(long, value_name = "FILE.png")]
    pub(super) heatmap: Option<PathBuf>,
    #[command(flatten)]
    pub(super) run: Run,
}

#[derive(Debug, Args)]
pub(super) struct Preview {
    #[command(flatten)]
    pub(super) scene: SceneArguments,
    /// Pixels, once the scene rests: auto (what the terminal says it can), cells
    /// (half blocks at rest too), kitty, iterm2 or sixel.
    #[arg(long, default_value = "auto", value_parser = parse_protocol, value_name = "NAME")]
    pub(super) protocol: ProtocolChoice,
    /// Colours: auto (what the terminal says it can; none if NO_COLOR is set), true
    /// (24 bits), 256, or none (a picture of characters).
    #[arg(long, default_value = "auto", value_parser = parse_colours, value_name = "NAME")]
    pub(super) colours: ColourChoice,
    /// Take keys and mouse from a file instead of a terminal: lines `FRAME EVENT`,
    /// such as `0 key Tab`, `1 mouse press left 40 12`, `9 rest`, `9 shot a.png`.
    #[arg(long, value_name = "FILE")]
    pub(super) script: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct Reference {
    #[command(flatten)]
    pub(super) scene: SceneArguments,
    #[command(flatten)]
    pub(super) view: ViewArguments,
    /// Paths a pixel.
    #[arg(long, default_value_t = 64, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
    pub(super) spp: u32,
    /// Another seed gives another picture with the same mean.
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub(super) seed: u32,
    /// What to trace: global, direct, indirect or glossy light.
    #[arg(long, default_value = "global", value_name = "NAME",
          value_parser = ["global", "direct", "indirect", "glossy"])]
    pub(super) component: String,
    /// Where glossy lobes reflect: at all bounces, or only at the final one, to the
    /// eye, as `render` has it.
    #[arg(long, default_value = "all", value_name = "WHERE",
          value_parser = parse_glossy_bounces)]
    pub(super) glossy_bounces: GlossyBounces,
}

#[derive(Debug, Args)]
pub(super) struct Measure {
    #[command(flatten)]
    pub(super) scene: SceneArguments,
    #[command(flatten)]
    pub(super) frame: FrameArguments,
    /// Folder for the report on speed and error, made if it is missing; open
    /// report.html there. Its frames have 320x240 pixels if not said. Bakes anew,
    /// whatever the cache has, and takes up to 7 GB of memory.
    #[arg(short, long, value_name = "DIR")]
    pub(super) output: Option<PathBuf>,
    /// Paths a pixel of the report's path-traced reference.
    #[arg(long, value_name = "N", default_value_t = DEFAULT_SPP,
          value_parser = clap::value_parser!(u32).range(4..=MOST_SPP))]
    pub(super) spp: u32,
    /// Frames to time: in each, the first point, spot or area light stands
    /// elsewhere on a circle of 5 % of the extent about its place.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_FRAMES))]
    pub(super) frames: Option<u32>,
}

/// A scene, as its file and the command line have it.
#[derive(Debug, Args)]
pub(super) struct SceneArguments {
    /// The scene file (.toml).
    #[arg(value_name = "SCENE")]
    pub(super) path: PathBuf,
    /// Change a key of the scene, as in light.lamp.intensity=[5,5,5]; repeatable.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(super) overrides: Vec<String>,
    /// How a bake stores the transfer: relume, or paper (as published in 2007,
    /// to compare with).
    #[arg(long, default_value = "relume", value_parser = parse_scheme, value_name = "NAME")]
    pub(super) scheme: Scheme,
    /// Relative error of indirect light to reach, as in 0.02: the bake chooses
    /// rays, functions and coefficients for it; short for --set bake.error.
    #[arg(long, value_name = "SHARE", value_parser = parse_share, allow_negative_numbers = true)]
    pub(super) error: Option<f64>,
    #[command(flatten)]
    pub(super) run: Run,
}

/// What a picture shows and where it goes.
#[derive(Debug, Args)]
pub(super) struct ViewArguments {
    /// Where the picture goes (.png or .exr); repeatable.
    #[arg(short, long, value_name = "OUT", required = true)]
    pub(super) output: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) frame: FrameArguments,
}

/// What of a frame the command line may change.
#[derive(Debug, Args)]
pub(super) struct FrameArguments {
    /// Size of the picture in pixels, instead of the scene's.
    #[arg(long, value_parser = parse_size, value_name = "WxH")]
    pub(super) size: Option<Size>,
    /// Indirect bounces, instead of the scene's.
    #[arg(long, value_parser = parse_bounces, value_name = "N|all", allow_negative_numbers = true)]
    pub(super) bounces: Option<Bounces>,
}

/// Heading of [`Run`] in the help: options of a command come before it.
const RUNNING: &str = "Running (changes no pixel)";

/// How to run: nothing here changes a pixel.
#[derive(Debug, Args)]
pub(super) struct Run {
    /// Threads to use; default: all processors.
    #[arg(long, help_heading = RUNNING, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
    /// Widest instructions to use: scalar, sse2, avx2 or auto.
    #[arg(long, help_heading = RUNNING, default_value = "auto", value_parser = parse_simd, value_name = "LEVEL")]
    pub(super) simd: SimdLevel,
    /// Folder for bakes, instead of the user's cache folder.
    #[arg(long, help_heading = RUNNING, value_name = "DIR")]
    pub(super) cache_dir: Option<PathBuf>,
    /// Neither read nor write bakes.
    #[arg(long, help_heading = RUNNING, conflicts_with = "cache_dir")]
    pub(super) no_cache: bool,
    /// Print one JSON object on standard output, and nothing else there.
    #[arg(long, help_heading = RUNNING)]
    pub(super) json: bool,
}

/// Width and height, pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Size(pub(super) [u32; 2]);

/// Longest side of a picture, pixels.
const LARGEST_SIDE: u32 = 16_384;
/// Paths a pixel of a report's reference: they leave some 5 % of noise in the
/// indirect light of a small lamp, and take a minute of one thread at 320x240.
const DEFAULT_SPP: u32 = 512;
/// Most paths a pixel of a report's reference.
const MOST_SPP: i64 = 1 << 20;
/// Most frames to time.
const MOST_FRAMES: i64 = 100_000;
/// Most bounces by number, as in the scene file.
const MOST_BOUNCES: u32 = 10_000;

pub(super) fn parse_size(text: &str) -> Result<Size, String> {
    let problem = || format!("a size is WxH with 1 to {LARGEST_SIDE} pixels each, such as 320x240");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(problem)?;
    let side = |s: &str| {
        s.trim()
            .parse()
            .ok()
            .filter(|side| (1..=LARGEST_SIDE).contains(side))
    };
    Ok(Size([
        side(width).ok_or_else(problem)?,
        side(height).ok_or_else(problem)?,
    ]))
}

fn parse_bounces(text: &str) -> Result<Bounces, String> {
    match text {
        "all" => Ok(Bounces::All),
        number => number
            .parse()
            .ok()
            .filter(|&count| count <= MOST_BOUNCES)
            .map(Bounces::Count)
            .ok_or_else(|| format!("bounces are a number from 0 to {MOST_BOUNCES}, or \"all\"")),
    }
}

fn parse_glossy_bounces(text: &str) -> Result<GlossyBounces, String> {
    match text {
        "all" => Ok(GlossyBounces::All),
        "final" => Ok(GlossyBounces::Final),
        _ => Err("glossy bounces are all or final".to_owned()),
    }
}

/// The range of the key `bake.error`.
fn parse_share(text: &str) -> Result<f64, String> {
    let is_share = |share: &f64| *share > 0.0 && *share < 1.0;
    let share = text.parse::<f64>().ok().filter(is_share);
    share.ok_or_else(|| "an error is a number above 0 and below 1, such as 0.02 for 2 %".to_owned())
}

fn parse_component(text: &str) -> Result<Component, ComponentError> {
    text.parse()
}

fn parse_quality(text: &str) -> Result<Quality, QualityError> {
    text.parse()
}

fn parse_protocol(text: &str) -> Result<ProtocolChoice, UnknownChoice> {
    text.parse()
}

fn parse_colours(text: &str) -> Result<ColourChoice, UnknownChoice> {
    text.parse()
}

fn parse_scheme(text: &str) -> Result<Scheme, String> {
    let found = Scheme::ALL.into_iter().find(|scheme| scheme.name() == text);
    found.ok_or_else(|| format!("schemes are {}", Scheme::ALL.map(Scheme::name).join(", ")))
}

fn parse_simd(text: &str) -> Result<SimdLevel, String> {
    let level = match text {
        "auto" => return Ok(SimdLevel::detect()),
        "scalar" => SimdLevel::Scalar,
        "sse2" => SimdLevel::Sse2,
        "avx2" => SimdLevel::Avx2,
        _ => return Err("levels are scalar, sse2, avx2 and auto".to_owned()),
    };
    if level.available() == level {
        Ok(level)
    } else {
        Err(format!("this processor has no {text}; use auto"))
    }
}

fn parse_limit(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|x: &f64| *x >= 0.0)
        .ok_or_else(|| "a limit is a number from 0".to_owned())
}

fn parse_flip(text: &str) -> Result<f64, String> {
    let limit = parse_limit(text).ok().filter(|&limit| limit <= 1.0);
    limit.ok_or_else(|| "a mean FLIP is a number from 0 to 1".to_owned())
}

fn parse_pixel_limit(text: &str) -> Result<PixelLimit, String> {
    match text.strip_suffix('%') {
        Some(share) => parse_limit(share.trim()).map(|percent| PixelLimit::Share(percent / 100.0)),
        None => text
            .parse()
            .map(PixelLimit::Count)
            .map_err(|_| "a number of pixels, or a share as in 0.5%".to_owned()),
    }
}
