//! What the status line says.

use std::collections::VecDeque;
use std::path::Path;
use std::time::Duration;

use super::document::UNNAMED;
use super::painter::{Drawn, Sharpness};
use super::screen::Written;
use crate::relight::{Renderer, Stages};

/// Pictures whose distances in time make up the rate.
const RATE_OVER: usize = 12;
/// Pictures further apart belong to no movement.
const PAUSE: Duration = Duration::from_millis(400);
/// Stages that take less are not named, milliseconds.
const NEGLIGIBLE_MS: f64 = 0.15;
/// Short names of a frame's stages.
const SHORT: [(&str, &str); 4] = [
    ("direct at vertices", "vertices"),
    ("colours at vertices", "colours"),
    ("light at pixels", "pixels"),
    ("shadow rays", "shadows"),
];

/// What a picture is drawn without.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Lacks {
    Nothing,
    Bake,
    /// Bounces folded under the albedo as it is: they were carried out one by one.
    Folding,
    /// Bounced gloss of this material.
    Slices(String),
}

/// What is known of the session, for the status line.
#[derive(Debug, Default)]
pub(crate) struct Status {
    message: String,
    /// Whether the message says that something failed.
    is_failure: bool,
    /// What is wrong with the scene's files, until it is mended.
    pub(crate) file_error: Option<String>,
    /// Stage of the bake and share of it that is done, while it is made.
    pub(crate) baking: Option<(&'static str, f64)>,
    /// Stated relative error of bounced light, once there is a bake.
    stated_error: Option<f64>,
    /// When the last drafts came.
    drafts: VecDeque<Duration>,
    last: Option<(Sharpness, Stages, Lacks)>,
    clamped_pixels: u64,
    /// What the terminal was sent last.
    pub(crate) written: Written,
}

impl Status {
    /// Says something, until the next thing.
    pub(crate) fn say(&mut self, message: impl Into<String>) {
        self.message = message.into();
        self.is_failure = false;
    }

    /// Says what failed, until the next thing.
    pub(crate) fn fail(&mut self, message: impl Into<String>) {
        self.message = message.into();
        self.is_failure = true;
    }

    /// A frame was written, or not.
    pub(super) fn wrote(&mut self, path: &Path, written: Result<String, String>) {
        match written {
            Ok(digest) => {
                let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
                self.say(format!("wrote {}; digest {digest}", path.display()));
            }
            Err(error) => self.fail(error),
        }
    }

    /// There is a renderer.
    pub(super) fn prepared(&mut self, renderer: &Renderer) {
        self.baking = None;
        let bake = renderer.figures().bake;
        let error = bake.map(|bake| bake.stats.errors.total.mean);
        self.stated_error = error.filter(|&error| error > 0.0);
        if renderer.needs_bake(&crate::relight::FrameSettings::of_scene(renderer.scene())) {
            self.baking = Some(("bake", 0.0));
        }
    }

    /// A picture has come.
    pub(super) fn drew(&mut self, drawn: &Drawn, now: Duration) {
        if matches!(drawn.sharpness, Sharpness::Draft(_)) {
            if self
                .drafts
                .back()
                .is_some_and(|&last| now.saturating_sub(last) > PAUSE)
            {
                self.drafts.clear();
            }
            self.drafts.push_back(now);
            if self.drafts.len() > RATE_OVER {
                self.drafts.pop_front();
            }
        }
        self.clamped_pixels = drawn.clamped_pixels;
        let lacks = match &drawn.lacks_slices_of {
            _ if drawn.lacks_bake => Lacks::Bake,
            _ if drawn.lacks_folding => Lacks::Folding,
            Some(name) => Lacks::Slices(name.clone()),
            None => Lacks::Nothing,
        };
        self.last = Some((drawn.sharpness, drawn.stages.clone(), lacks));
    }

    /// The last message.
    pub(crate) fn words(&self) -> &str {
        &self.message
    }

    /// Whether it says that something failed.
    pub(crate) fn is_failure(&self) -> bool {
        self.is_failure
    }

    /// What is wrong, if anything is.
    pub(crate) fn error(&self) -> Option<String> {
        let failure = self.is_failure.then(|| self.message.clone());
        failure.or_else(|| self.file_error.clone())
    }

    /// What is said in figures, the most important first.
    pub(crate) fn figures(&self) -> Vec<String> {
        let mut figures = Vec::new();
        if let Some((_, _, Lacks::Slices(name))) = &self.last {
            let name = if name.is_empty() { UNNAMED } else { name };
            figures.push(format!("no bounced gloss of {name} yet"));
        }
        if let Some((stage, share)) = self.baking {
            figures.push(format!("{stage} {:.0} %", 100.0 * share));
        }
        let Some((sharpness, stages, lacks)) = &self.last else {
            return figures;
        };
        figures.push(match (sharpness, self.rate()) {
            (Sharpness::Draft(1), Some(rate)) => format!("{rate:.0} fps"),
            (Sharpness::Draft(coarseness), Some(rate)) => format!("{rate:.0} fps 1/{coarseness}"),
            (Sharpness::Draft(_), None) => "draft".to_owned(),
            (Sharpness::Full | Sharpness::Fine, _) => "sharp".to_owned(),
        });
        figures.push(format!("{:.1} ms", stages.total_ms()));
        match (lacks, self.stated_error) {
            (Lacks::Bake, _) => figures.push("no bounces and no sky yet".to_owned()),
            (Lacks::Folding, _) => figures.push("this albedo needs a bake".to_owned()),
            (Lacks::Nothing, Some(error)) => figures.push(format!("error {:.1} %", 100.0 * error)),
            (Lacks::Nothing, None) | (Lacks::Slices(_), _) => {}
        }
        if self.clamped_pixels > 0 {
            figures.push(format!("{} pixels below 0", self.clamped_pixels));
        }
        let mut parts: Vec<String> = stages
            .times_ms()
            .iter()
            .filter(|(_, ms)| *ms >= NEGLIGIBLE_MS)
            .map(|(stage, ms)| format!("{} {ms:.1}", short(stage)))
            .collect();
        if self.written.encode_ms >= NEGLIGIBLE_MS {
            parts.push(format!("encode {:.1}", self.written.encode_ms));
        }
        figures.extend(parts);
        figures
    }

    /// Drafts a second, while something moves.
    fn rate(&self) -> Option<f64> {
        let (first, last) = (self.drafts.front()?, self.drafts.back()?);
        let seconds = last.checked_sub(*first)?.as_secs_f64();
        (seconds > 0.0).then(|| (self.drafts.len() - 1) as f64 / seconds)
    }
}

fn short(stage: &str) -> &str {
    let found = SHORT.iter().find(|(long, _)| *long == stage);
    found.map_or(stage, |(_, short)| short)
}
