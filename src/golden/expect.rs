//! For `cargo test`: a frame that has to equal a golden.

use std::path::{self, Path, PathBuf};

use super::check::{is_linear, read_mask};
use super::error::{CheckError, GoldenError};
use super::place::relative;
use super::{DrawSettings, Drawn, FrameFault, GoldenScene};
use crate::bake::RunSettings;
use crate::compare::{ComparedImage, Judgement, Limits, Mask, judge, shown, strip};
use crate::frame::{EncodedImage, Image, LoadedImage};
use crate::output::{
    Picture, PictureMetadata, encode_described, encode_png, read_compared, write_file,
};
use crate::relight::{Component, Frame, develop};
use crate::scene::Tone;

/// Environment variable that makes tests write their goldens if it is 1. They
/// fail then, so that a new golden does not pass unseen.
pub const BLESS_VARIABLE: &str = "RELUME_BLESS";

/// A golden that a frame has to equal, as near as some limits ask.
///
/// ```no_run
/// # fn main() -> Result<(), relume::golden::GoldenError> {
/// use relume::golden::Expected;
/// # let levels = relume::EncodedImage::of_bytes(1, 1, vec![0; 3]).unwrap();
///
/// let expected = Expected::new("tests/golden/box.png").failures_in("target/tmp");
/// expected.check_levels(&levels)
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Expected {
    golden: PathBuf,
    limits: Limits,
    mask: Option<PathBuf>,
    failures: PathBuf,
}

/// Draws a scene as its golden is drawn (see the [room](super)), without a cache
/// of bakes, and holds the frame against the golden. What a failure shows is
/// written to the folder `failures`, which is made if it is missing.
///
/// # Errors
/// If the golden is missing, was written because of [`BLESS_VARIABLE`], or is not
/// the frame; or if scene, golden or mask cannot be used.
pub fn check_scene(scene: &Path, failures: &Path) -> Result<Frame, GoldenError> {
    let drawn = Drawn::of(scene, &DrawSettings::default(), &RunSettings::silent())?;
    drawn.check(scene, failures)?;
    Ok(drawn.frame)
}

impl Drawn {
    /// Holds the frame of `scene` against the scene's golden, as [`check_scene`].
    ///
    /// # Errors
    /// As [`check_scene`].
    pub fn check(&self, scene: &Path, failures: &Path) -> Result<(), GoldenError> {
        let place = GoldenScene::of(scene).map_err(|source| {
            CheckError::from(crate::output::OutputError::Read {
                path: scene.to_owned(),
                source,
            })
        })?;
        if let several @ [_, _, ..] = place.all_goldens() {
            return Err(CheckError::Several(several.to_vec()).into());
        }
        let expected = Expected {
            golden: place.golden().to_owned(),
            limits: Limits::of_keys(&self.keys),
            mask: self.keys.mask.clone(),
            failures: failures.to_owned(),
        };
        let fault = self.fault(&expected.golden);
        let actual = self.as_in(&expected.golden);
        expected.check(&actual, fault, |golden| self.encode(golden))
    }
}

impl Expected {
    /// The golden in this file (`.png` for levels, `.exr` for linear values), to
    /// be equalled to the bit. Failures go to the folder `relume-golden` of the
    /// system's folder for temporary files.
    pub fn new(golden: impl Into<PathBuf>) -> Self {
        Self {
            golden: golden.into(),
            limits: Limits::default(),
            mask: None,
            failures: std::env::temp_dir().join("relume-golden"),
        }
    }

    /// How far the frame may be from the golden.
    #[must_use]
    pub fn within(self, limits: Limits) -> Self {
        Self { limits, ..self }
    }

    /// A grey picture of what is allowed by pixel (see [`crate::Mask`]).
    #[must_use]
    pub fn masked_by(self, mask: impl Into<PathBuf>) -> Self {
        let mask = Some(mask.into());
        Self { mask, ..self }
    }

    /// The folder for what a failure shows, such as
    /// `env!("CARGO_TARGET_TMPDIR")`; made if it is missing.
    #[must_use]
    pub fn failures_in(self, folder: impl Into<PathBuf>) -> Self {
        let failures = folder.into();
        Self { failures, ..self }
    }

    /// Holds levels against the golden, a PNG.
    ///
    /// # Errors
    /// If the golden is missing, was written because of [`BLESS_VARIABLE`], or is
    /// not this picture; or if golden or mask cannot be used.
    pub fn check_levels(&self, levels: &EncodedImage) -> Result<(), GoldenError> {
        let actual = ComparedImage::of_levels(levels);
        self.check_pixels(&actual, &actual.pixels().to_linear(), levels)
    }

    /// Holds linear values against the golden, an EXR.
    ///
    /// # Errors
    /// As [`Expected::check_levels`].
    pub fn check_linear(&self, image: &Image) -> Result<(), GoldenError> {
        let levels = develop(image, Component::Albedo, 0.0, Tone::Srgb);
        self.check_pixels(&ComparedImage::of_linear(image.clone()), image, &levels)
    }

    fn check_pixels(
        &self,
        actual: &ComparedImage,
        linear: &Image,
        encoded: &EncodedImage,
    ) -> Result<(), GoldenError> {
        if is_linear(&self.golden) == matches!(actual.pixels(), LoadedImage::Levels(_)) {
            return Err(CheckError::from(crate::compare::JudgeError::Kinds).into());
        }
        let fault = FrameFault::of(actual.pixels().values());
        self.check(actual, fault, |golden| {
            let picture = Picture { linear, encoded };
            Ok(encode_described(
                golden,
                picture,
                &PictureMetadata::default(),
            )?)
        })
    }

    /// Judges, and writes the golden (as `encode` has it) where that is asked
    /// for, or else what there is to look at.
    fn check(
        &self,
        actual: &ComparedImage,
        fault: Option<FrameFault>,
        encode: impl Fn(&Path) -> Result<Vec<u8>, CheckError>,
    ) -> Result<(), GoldenError> {
        let golden = self.golden.clone();
        if let Some(fault) = fault {
            return Err(GoldenError::Faulty { golden, fault });
        }
        let compared = golden.exists().then(|| self.judged(actual));
        if let Some(Ok((judgement, ..))) = &compared
            && judgement.passes()
        {
            return Ok(());
        }
        let is_asked_for = std::env::var_os(BLESS_VARIABLE).is_some_and(|value| value == "1");
        let would_help = !matches!(&compared, Some(Err(error)) if !error.is_of_golden());
        if is_asked_for && would_help {
            write_file(&golden, &encode(&golden)?).map_err(CheckError::from)?;
            return Err(GoldenError::Blessed { golden });
        }
        let Some(compared) = compared else {
            let [_, levels] = shown(actual, actual);
            let actual = self.write(&levels, "actual")?;
            return Err(GoldenError::Missing { golden, actual });
        };
        let (judgement, expected, mask) = compared?;
        let passing = judgement.measured().map(|it| it.passing.keys_text());
        Err(GoldenError::Differs {
            golden,
            failures: judgement.failures(),
            passing: passing.unwrap_or_else(|| "no limit".to_owned()),
            strip: self.write(&strip(&expected, actual, mask.as_ref()), "strip")?,
        })
    }

    fn judged(
        &self,
        actual: &ComparedImage,
    ) -> Result<(Judgement, ComparedImage, Option<Mask>), CheckError> {
        let mask = read_mask(self.mask.as_deref())?;
        let expected = read_compared(&self.golden)?;
        let judgement = judge(&expected, actual, &self.limits, mask.as_ref())?;
        Ok((judgement, expected, mask))
    }

    /// Writes a picture whose name says which golden it belongs to.
    fn write(&self, picture: &EncodedImage, what: &str) -> Result<PathBuf, CheckError> {
        let shown = relative(&self.golden).with_extension("");
        let parts = shown.components().filter_map(|part| match part {
            path::Component::Normal(name) => Some(name.to_string_lossy()),
            _ => None,
        });
        let name = parts.collect::<Vec<_>>().join("-");
        let path = self.failures.join(format!("{name}-{what}.png"));
        write_file(&path, &encode_png(picture)?)?;
        Ok(path)
    }
}

#[cfg(test)]
mod tests;
