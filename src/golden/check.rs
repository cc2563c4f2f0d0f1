//! One scene: drawn, and held against its golden.

use std::path::Path;
use std::time::Instant;

use super::error::CheckError;
use super::{FrameFault, GoldenScene, Verdict};
use crate::bake::{BakeError, RunSettings};
use crate::compare::{ComparedImage, Limits, Mask, judge, shown, strip};
use crate::frame::{EncodedImage, LoadedImage};
use crate::output::{
    Picture, PictureMetadata, encode_described, heat_map, read_compared, read_image, write_file,
};
use crate::relight::{Frame, FrameSettings, RenderError, Renderer, describe_levels};
use crate::scene::{GoldenKeys, Override, Scene};

/// What the frames of a check are drawn with, besides what the scenes say.
#[derive(Debug, Clone, Copy, Default)]
pub struct DrawSettings<'a> {
    /// Keys to replace in every scene, after those that its `[golden]` replaces.
    pub overrides: &'a [Override],
    /// Where bakes are kept; `None`: nowhere.
    pub cache_folder: Option<&'a Path>,
}

/// The job was stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the check was stopped")]
pub struct Stopped;

/// A scene's frame, ready to be compared with its golden.
#[derive(Debug, Clone)]
pub struct Drawn {
    /// The frame, linear.
    pub frame: Frame,
    /// Its levels.
    pub levels: EncodedImage,
    /// What its file says of it.
    pub metadata: PictureMetadata,
    /// Limits and mask.
    pub keys: GoldenKeys,
    /// What the scene and its bake warn of.
    pub warnings: Vec<String>,
}

/// A scene with its verdict.
#[derive(Debug)]
pub struct Checked {
    /// The scene and the place of its golden.
    pub scene: GoldenScene,
    /// What came of it.
    pub verdict: Verdict,
    /// The bytes of the frame as a golden: what [`Checked::bless`] writes. `None`
    /// where there is nothing to bless.
    pub candidate: Option<Vec<u8>>,
    /// What there is to look at where the scene fails.
    pub pictures: Option<Pictures>,
    /// What the scene and its bake warn of.
    pub warnings: Vec<String>,
    /// How long it took, milliseconds.
    pub time_ms: f64,
}

/// Pictures of a failure, as a screen shows them.
#[derive(Debug, Clone)]
pub struct Pictures {
    /// The frame.
    pub actual: EncodedImage,
    /// The golden, where it could be read.
    pub expected: Option<EncodedImage>,
    /// Both with their difference between them.
    pub strip: Option<EncodedImage>,
    /// FLIP by pixel, where the sizes agree.
    pub heat_map: Option<EncodedImage>,
}

impl Drawn {
    /// Draws a scene as its golden is drawn.
    ///
    /// # Errors
    /// If the scene cannot be loaded or drawn.
    pub fn of(
        scene: &Path,
        settings: &DrawSettings<'_>,
        run: &RunSettings<'_>,
    ) -> Result<Self, CheckError> {
        let mut scene = Scene::load_for_golden(scene, settings.overrides)?;
        let mut warnings = std::mem::take(&mut scene.warnings);
        let (exposure, tone) = (scene.render.exposure, scene.render.tone);
        let keys = scene.golden.clone();
        let frame_settings = FrameSettings::of_scene(&scene);
        let mut renderer = Renderer::new(scene, settings.cache_folder);
        let frame = renderer.frame(&frame_settings, run)?;
        warnings.append(&mut renderer.take_warnings());
        let linear = renderer.describe(&frame_settings);
        let encoded = describe_levels(&linear, frame_settings.component, exposure, tone);
        Ok(Self {
            levels: frame.develop(exposure, tone),
            metadata: PictureMetadata { linear, encoded },
            frame,
            keys,
            warnings,
        })
    }

    /// What is wrong with the frame as a golden of this name holds it.
    pub(super) fn fault(&self, golden: &Path) -> Option<FrameFault> {
        match FrameFault::of(&self.frame.image) {
            Some(fault @ FrameFault::NotFinite { .. }) => Some(fault),
            _ => FrameFault::of(self.as_in(golden).pixels().values()),
        }
    }

    /// The frame as a file of this name holds it.
    pub(super) fn as_in(&self, golden: &Path) -> ComparedImage {
        if is_linear(golden) {
            let image = ComparedImage::of_linear(self.frame.image.clone());
            image.with_metadata(self.metadata.linear.clone())
        } else {
            let image = ComparedImage::of_levels(&self.levels);
            image.with_metadata(self.metadata.encoded.clone())
        }
    }

    /// The bytes of the frame in a file of this name.
    pub(super) fn encode(&self, golden: &Path) -> Result<Vec<u8>, CheckError> {
        let picture = Picture {
            linear: &self.frame.image,
            encoded: &self.levels,
        };
        Ok(encode_described(golden, picture, &self.metadata)?)
    }
}

/// Whether a file of this name holds linear values.
pub(super) fn is_linear(path: &Path) -> bool {
    path.extension()
        .is_some_and(|it| it.eq_ignore_ascii_case("exr"))
}

/// Reads the mask of limits, where they have one.
pub(super) fn read_mask(path: Option<&Path>) -> Result<Option<Mask>, CheckError> {
    let Some(path) = path else {
        return Ok(None);
    };
    let image = read_image(path).map_err(|source| CheckError::MaskFile { source })?;
    let mask = Mask::of_image(&image).map_err(|source| CheckError::Mask {
        path: path.to_owned(),
        source,
    })?;
    Ok(Some(mask))
}

impl GoldenScene {
    /// Draws the scene and judges its frame. Whatever is wrong with the scene or
    /// its golden is a verdict, so that other scenes can be checked.
    ///
    /// # Errors
    /// If the job was stopped.
    pub fn check(
        self,
        settings: &DrawSettings<'_>,
        run: &RunSettings<'_>,
    ) -> Result<Checked, Stopped> {
        let start = Instant::now();
        let drawn = match self.all_goldens() {
            several @ [_, _, ..] => Err(CheckError::Several(several.to_vec())),
            _ => Drawn::of(self.scene(), settings, run),
        };
        let mut checked = match drawn {
            Err(CheckError::Render(
                RenderError::Cancelled | RenderError::Bake(BakeError::Cancelled),
            )) => return Err(Stopped),
            Err(error) => Checked::new(self, Verdict::Scene(error)),
            Ok(drawn) => Checked::of(self, drawn),
        };
        checked.time_ms = start.elapsed().as_secs_f64() * 1e3;
        Ok(checked)
    }
}

impl Checked {
    fn new(scene: GoldenScene, verdict: Verdict) -> Self {
        Self {
            scene,
            verdict,
            candidate: None,
            pictures: None,
            warnings: Vec::new(),
            time_ms: 0.0,
        }
    }

    fn of(scene: GoldenScene, drawn: Drawn) -> Self {
        let (verdict, sides) = match verdict(&scene, &drawn) {
            Ok(found) => found,
            Err(error) => (Verdict::Golden(error), None),
        };
        let mut checked = Self::new(scene, verdict);
        if !checked.passes() {
            let golden = checked.scene.golden();
            let blessed = checked.verdict.can_be_blessed();
            checked.candidate = blessed.then(|| drawn.encode(golden).ok()).flatten();
            checked.pictures = Some(Pictures::of(&checked.verdict, &drawn.as_in(golden), sides));
        }
        checked.warnings = drawn.warnings;
        checked
    }

    /// Whether the scene's frame is its golden.
    pub fn passes(&self) -> bool {
        matches!(self.verdict, Verdict::Passes(_))
    }

    /// Makes the frame the scene's golden, as a whole file or not at all. Says
    /// whether there was anything to write: a scene that passes keeps its golden,
    /// and a frame that is wrong by itself becomes none.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn bless(&self) -> Result<bool, CheckError> {
        let Some(bytes) = &self.candidate else {
            return Ok(false);
        };
        write_file(self.scene.golden(), bytes)?;
        Ok(true)
    }
}

/// A golden with its scene's mask.
type Masked = (ComparedImage, Option<Mask>);

/// Judges a frame; the golden is there too where it could be read.
fn verdict(scene: &GoldenScene, drawn: &Drawn) -> Result<(Verdict, Option<Masked>), CheckError> {
    let golden = scene.golden();
    if let Some(fault) = drawn.fault(golden) {
        let expected = scene.has_golden().then(|| read_compared(golden).ok());
        let expected = expected.flatten().map(|it| (it, None));
        return Ok((Verdict::Faulty(fault), expected));
    }
    if !scene.has_golden() {
        return Ok((Verdict::Missing, None));
    }
    let mask = read_mask(drawn.keys.mask.as_deref())?;
    let expected = read_compared(golden)?;
    let actual = drawn.as_in(golden);
    let limits = Limits::of_keys(&drawn.keys);
    let judgement = judge(&expected, &actual, &limits, mask.as_ref())?;
    let verdict = if judgement.passes() {
        Verdict::Passes(judgement)
    } else {
        Verdict::Differs {
            judgement,
            metadata: expected.metadata_differences(&actual),
        }
    };
    Ok((verdict, Some((expected, mask))))
}

impl Pictures {
    fn of(verdict: &Verdict, actual: &ComparedImage, expected: Option<Masked>) -> Self {
        let kind = |image: &ComparedImage| matches!(image.pixels(), LoadedImage::Levels(_));
        let of_kind = expected.filter(|(it, _)| kind(it) == kind(actual));
        let Some((expected, mask)) = of_kind else {
            let [_, shown] = shown(actual, actual);
            return Self {
                actual: shown,
                expected: None,
                strip: None,
                heat_map: None,
            };
        };
        let measured = match verdict {
            Verdict::Differs { judgement, .. } => judgement.measured(),
            _ => None,
        };
        let [shown_expected, shown_actual] = shown(&expected, actual);
        Self {
            actual: shown_actual,
            expected: Some(shown_expected),
            strip: Some(strip(&expected, actual, mask.as_ref())),
            heat_map: measured.map(|it| heat_map(&it.flip_map)),
        }
    }
}
