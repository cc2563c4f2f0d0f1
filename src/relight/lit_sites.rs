//! Direct light at the sites of a picture, light by light, and what of it is
//! kept from frame to frame.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use super::frame::Effort;
use super::raster::{Fragment, SampleBuffer};
use super::reach::{Reach, mixed, seen_point, trace};
use super::shade::View;
use super::sites::{Sites, members, samples_of};
use super::stages::Stages;
use super::sum::{BLOCK, BlockSums, Part};
use crate::brdf::GlossyMaterials;
use crate::scene::PlacedLight;
use crate::surface::direct::{Found, LightPoints, reflected_in_the_open};

/// Samples of a pixel that share the shadow rays of its centre: where a light
/// is partly hidden, each of the 16 samples gets a quarter of `light_samples`.
/// (64 rays where 16 disagree: 16 alone leave 6 % of noise in a penumbra, these
/// about 2 %.)
const SAMPLES_PER_CENTRE: u32 = 4;
/// Seed of the points of lights, seen from samples.
const LIGHT_SEED: u32 = 0x9e12;
/// Points of a light that is no point, for what a lobe reflects where nothing hides
/// the light: without shadow rays they cost little, and a highlight of roughness
/// 0.3 shows single ones of 16.
const POINTS_IN_THE_OPEN: u32 = 64;
/// Sites that one task takes.
const SITES_A_TASK: usize = 256;
/// Most bytes of lights' irradiance that are kept of a picture: some 40 lights at
/// 1280 x 720. Lights beyond are computed in every frame.
const KEPT_BYTES: usize = 1 << 29;
/// Pictures that are kept: a draft, a full frame, and one of another size.
const MOST_PICTURES: usize = 3;

/// The sites of the last picture, and each light's irradiance there. What did not
/// change is not computed again; the sum is formed in the lights' order.
#[derive(Default)]
pub(crate) struct KeptPicture {
    sites: Option<Sites>,
    lights: Vec<LitSites>,
    /// The lobes that `lights` were reflected by.
    glossy: GlossyMaterials,
    /// Lights computed so far: the next one's number.
    computed: u64,
    blocks: BlockSums,
    reflected_blocks: BlockSums,
}

#[derive(Clone)]
struct LitSites {
    light: PlacedLight,
    light_samples: u32,
    /// Irradiance by site.
    part: Part,
    /// Radiance by lobes by site; nowhere where no material has one.
    reflected: Part,
}

/// Direct light by site; empty where the component has no use for it.
#[derive(Debug, Default)]
pub(super) struct DirectLight {
    /// W/m2.
    pub(super) irradiance: Vec<Vec3>,
    /// Radiance by glossy lobes, W/(m2 sr); empty where no material has one.
    pub(super) reflected: Vec<Vec3>,
}

impl KeptPicture {
    /// The view's sites and the sum of all lights there; `None` if it was stopped,
    /// which is asked between stages and lights.
    pub(super) fn direct(
        &mut self,
        view: &View,
        stages: &mut Stages,
        go_on: &dyn Fn() -> Option<()>,
    ) -> Option<(&Sites, DirectLight)> {
        if !self.sites.as_ref().is_some_and(|sites| sites.serve(view)) {
            *self = Self::default();
            self.sites = Some(Sites::of(view, stages, go_on)?);
        }
        let sites = self.sites.as_ref().expect("they were made above");
        if !view.component.needs_direct() {
            return Some((sites, DirectLight::default()));
        }
        if self.glossy != *view.glossy {
            self.lights.clear();
            self.glossy = view.glossy.clone();
        }
        let kept = std::mem::take(&mut self.lights);
        let found = |light: &PlacedLight| {
            let serves = |k: &&LitSites| k.light == *light && k.light_samples == view.light_samples;
            kept.iter().find(serves)
        };
        let sources = view.lights.sources.iter();
        let new: Vec<&PlacedLight> = sources.filter(|light| found(light).is_none()).collect();
        let asked = Asked::of(view, sites, &new, stages, go_on);
        let mut next_asked = 0;
        let mut sum = vec![Vec3::ZERO; sites.len()];
        let reflecting = if view.glossy.any() { sites.len() } else { 0 };
        let mut reflected = vec![Vec3::ZERO; reflecting];
        let bytes_of_one = size_of_val(sum.as_slice()) + size_of_val(reflected.as_slice());
        for (index, lights) in view.lights.sources.chunks(BLOCK).enumerate() {
            let mut block = Vec::with_capacity(BLOCK);
            let mut reflected_block = Vec::with_capacity(BLOCK);
            for light in lights {
                let lit = match (found(light), &asked) {
                    (Some(lit), _) => lit.clone(),
                    (None, Some(asked)) if go_on().is_some() => {
                        next_asked += 1;
                        self.computed += 1;
                        let [irradiance, reflected] = stages
                            .time("light at pixels", || asked.at_sites(light, next_asked - 1));
                        let part = |values| Part {
                            id: self.computed,
                            values,
                        };
                        LitSites {
                            light: light.clone(),
                            light_samples: view.light_samples,
                            part: part(irradiance),
                            reflected: part(reflected),
                        }
                    }
                    _ => {
                        keep_of_last(&mut self.lights, kept, view);
                        return None;
                    }
                };
                block.push(lit.part.clone());
                reflected_block.push(lit.reflected.clone());
                if (self.lights.len() + 1) * bytes_of_one <= KEPT_BYTES {
                    self.lights.push(lit);
                }
            }
            stages.time("light at pixels", || {
                self.blocks.add(index, &block, &mut sum);
                if !reflected.is_empty() {
                    let blocks = &mut self.reflected_blocks;
                    blocks.add(index, &reflected_block, &mut reflected);
                }
            });
        }
        let irradiance = sum;
        Some((
            sites,
            DirectLight {
                irradiance,
                reflected,
            },
        ))
    }
}

/// Puts back what a frame that was stopped found ready and serves the next one.
fn keep_of_last(lights: &mut Vec<LitSites>, last: Vec<LitSites>, view: &View) {
    for lit in last {
        let is_there = lights.iter().any(|it| it.part.id == lit.part.id);
        if !is_there && view.lights.sources.contains(&lit.light) {
            lights.push(lit);
        }
    }
}

/// The last pictures: drafts, full frames and frames of another size follow one
/// another while lights are moved, and none of them should cost another one what
/// it has.
#[derive(Default)]
pub(crate) struct KeptPictures {
    /// The one that was drawn last is the last.
    pictures: Vec<KeptPicture>,
}

impl KeptPictures {
    /// The picture that serves a view, or one for it.
    pub(super) fn of(&mut self, view: &View) -> &mut KeptPicture {
        let serves = |it: &KeptPicture| it.sites.as_ref().is_some_and(|sites| sites.serve(view));
        let picture = match self.pictures.iter().position(serves) {
            Some(position) => self.pictures.remove(position),
            None => {
                if self.pictures.len() == MOST_PICTURES {
                    self.pictures.remove(0);
                }
                KeptPicture::default()
            }
        };
        self.pictures.push(picture);
        self.pictures.last_mut().expect("it was pushed")
    }

    /// The sites of the picture that was drawn last.
    pub(super) fn last_sites(&self) -> Option<&Sites> {
        self.pictures.last()?.sites.as_ref()
    }
}

/// What is known of lights before their irradiance is computed: where one answer
/// a pixel is not enough, and the samples there.
struct Asked<'a> {
    view: &'a View<'a>,
    sites: &'a Sites,
    reaches: Vec<Vec<Reach>>,
    mixed: Vec<Vec<bool>>,
    /// Samples of the pixels of one surface in which some light is mixed.
    samples: SampleBuffer,
    pixels_of_groups: Vec<u32>,
}

impl<'a> Asked<'a> {
    fn of(
        view: &'a View<'a>,
        sites: &'a Sites,
        lights: &[&PlacedLight],
        stages: &mut Stages,
        go_on: &dyn Fn() -> Option<()>,
    ) -> Option<Self> {
        let mut asked = Self {
            view,
            sites,
            reaches: Vec::new(),
            mixed: Vec::new(),
            samples: SampleBuffer::default(),
            pixels_of_groups: Vec::new(),
        };
        if view.effort == Effort::Draft || lights.is_empty() {
            return Some(asked);
        }
        asked.pixels_of_groups = sites.pixels_of_groups();
        asked.reaches = stages.time("shadow rays", || {
            let traced = lights.iter();
            traced
                .map(|light| go_on().map(|()| trace(view, light, &sites.points)))
                .collect::<Option<_>>()
        })?;
        asked.mixed = stages.time("shadow edges", || {
            let pairs = lights.iter().zip(&asked.reaches);
            pairs
                .map(|(light, reach)| mixed(view, light, &sites.points, reach))
                .collect()
        });
        let mut mask = vec![false; sites.pixel_count()];
        for light in &asked.mixed {
            for pixel in 0..mask.len() {
                mask[pixel] |= light[pixel] && !sites.edges[pixel];
            }
        }
        go_on()?;
        asked.samples = stages.time("samples", || samples_of(view, &sites.geometry, &mask));
        Some(asked)
    }

    /// What one light does at every site: irradiance, W/m2, and radiance by lobes,
    /// W/(m2 sr), nowhere where no material has one; `number` is the light's place
    /// among those that were asked for.
    fn at_sites(&self, light: &PlacedLight, number: usize) -> [Arc<[Vec3]>; 2] {
        let site = |site: usize| match site.checked_sub(self.sites.pixel_count()) {
            None if self.view.effort == Effort::Draft => self.at_centre(light, site),
            None if self.sites.edges[site] => Lit::default(),
            None => self.at_pixel(light, number, site),
            Some(group) => self.at_group(light, number, group),
        };
        let sites = (0..self.sites.len()).into_par_iter();
        let sites = sites.with_min_len(SITES_A_TASK).map(site);
        if !self.view.glossy.any() {
            let irradiance: Vec<Vec3> = sites.map(|lit| lit.irradiance).collect();
            return [irradiance.into(), Arc::default()];
        }
        let both: (Vec<Vec3>, Vec<Vec3>) = sites.map(|lit| (lit.irradiance, lit.reflected)).unzip();
        [both.0.into(), both.1.into()]
    }

    /// In a draft: the light at the pixel's centre.
    fn at_centre(&self, light: &PlacedLight, pixel: usize) -> Lit {
        let Some(point) = &self.sites.points[pixel] else {
            return Lit::default();
        };
        let lobe = self.view.lobe(&self.sites.centers.fragments[pixel], point);
        let count = self.view.light_samples;
        let to_light = LightPoints::of(LIGHT_SEED, pixel as u32, 0, count);
        let mut found = Found::by(lobe);
        self.view.shadows().find(light, point, to_light, &mut found);
        Lit::of(&found)
    }

    /// A pixel of one surface: at its centre, or averaged over its samples where
    /// the light has an edge there.
    fn at_pixel(&self, light: &PlacedLight, number: usize, pixel: usize) -> Lit {
        let Some(point) = &self.sites.points[pixel] else {
            return Lit::default();
        };
        if self.mixed[number][pixel] {
            let samples = self.samples.pixel(pixel);
            let samples = samples.expect("a pixel with a light's edge has samples");
            return self.mean(light, pixel, samples.iter());
        }
        if self.reaches[number][pixel] != Reach::Lit {
            return Lit::default();
        }
        let incident = light.incident(point.position, point.normal);
        let lobe = self.view.lobe(&self.sites.centers.fragments[pixel], point);
        let reflected = lobe.map(|lobe| {
            let points = LightPoints::of(LIGHT_SEED, pixel as u32, 0, POINTS_IN_THE_OPEN);
            reflected_in_the_open(&incident, point, &lobe, points)
        });
        Lit {
            irradiance: incident.open(),
            reflected: reflected.unwrap_or(Vec3::ZERO),
        }
    }

    /// One surface of a pixel of several: at its sample closest to its middle,
    /// or averaged over its samples.
    fn at_group(&self, light: &PlacedLight, number: usize, index: usize) -> Lit {
        let (pixel, group) = (self.pixels_of_groups[index], self.sites.group(index));
        let samples = self.sites.samples.pixel(pixel as usize);
        let samples = samples.expect("a pixel of an edge has samples");
        if self.mixed[number][pixel as usize] {
            return self.mean(light, pixel as usize, members(group, samples));
        }
        let fragment = &samples[group.representative as usize];
        seen_point(self.view, fragment).map_or(Lit::default(), |point| {
            let count = self.view.light_samples;
            let to_light = LightPoints::of(LIGHT_SEED, pixel, 0, count);
            let mut found = Found::by(self.view.lobe(fragment, &point));
            self.view
                .shadows()
                .find(light, &point, to_light, &mut found);
            Lit::of(&found)
        })
    }

    /// Points of a light that a sample of a pixel sends its shadow rays to.
    fn light_points(&self, pixel: usize, sample: u32) -> LightPoints {
        let count = self.view.light_samples.div_ceil(SAMPLES_PER_CENTRE);
        LightPoints::of(LIGHT_SEED, pixel as u32, sample * count, count)
    }

    /// The mean over fragments with shadow rays each.
    fn mean<'f>(
        &self,
        light: &PlacedLight,
        pixel: usize,
        fragments: impl Iterator<Item = &'f Fragment>,
    ) -> Lit {
        let shadows = self.view.shadows();
        let mut found = Found::default();
        // What a light that is no point sends hardly changes within a pixel: one
        // look at thousands of emitters does for all samples.
        let mut shared = None;
        for (sample, fragment) in fragments.enumerate() {
            let Some(point) = seen_point(self.view, fragment) else {
                continue;
            };
            found.lobe = self.view.lobe(fragment, &point);
            let to_light = self.light_points(pixel, sample as u32);
            if shared.is_none() || light.is_sharp() {
                let incident = light.incident(point.position, point.normal);
                shared = Some((incident, point.position));
            }
            if let Some((incident, from)) = &shared {
                shadows.follow_all((incident, *from), &point, to_light, &mut found);
            }
        }
        Lit::of(&found)
    }
}

/// What a light does at a site.
#[derive(Debug, Clone, Copy, Default)]
struct Lit {
    /// W/m2.
    irradiance: Vec3,
    /// Radiance by the lobe, W/(m2 sr).
    reflected: Vec3,
}

impl Lit {
    fn of(found: &Found) -> Self {
        Self {
            irradiance: found.irradiance(),
            reflected: found.reflected(),
        }
    }
}
