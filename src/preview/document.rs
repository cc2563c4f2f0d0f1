//! What can be edited of a scene, and how the renderer and the scene file see it.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::relight::Component;
use crate::scene::{Area, Camera, Light, LightKind, Radiance, Reflection, RenderKeys, Scene};

/// Largest magnitude of a number of the scene file.
const LARGEST: f64 = 1e30;
/// Exposures of the scene file, EV.
const LARGEST_EXPOSURE: f32 = 64.0;
/// Sine of the least angle between the view and up, and between the edges of a
/// rectangle: a little more than the reader of the scene file asks for.
const LEAST_SINE: f64 = 1e-5;

/// What a material without a name is called.
pub(crate) const UNNAMED: &str = "(no material)";

/// The state of an edited scene.
#[derive(Debug, Clone)]
pub(crate) struct Document {
    pub(crate) lights: Vec<EditedLight>,
    /// One of each material of the scene.
    pub(crate) reflections: Vec<Reflection>,
    pub(crate) camera: Camera,
    pub(crate) render: RenderKeys,
    /// What is shown; not saved.
    pub(crate) component: Component,
}

/// A light, and whether it is heard, so to speak.
#[derive(Debug, Clone)]
pub(crate) struct EditedLight {
    pub(crate) light: Light,
    pub(crate) is_muted: bool,
    pub(crate) is_soloed: bool,
}

/// Which parts of two documents differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Changed {
    /// The lights that are shown.
    pub(crate) lights: bool,
    /// How materials reflect.
    pub(crate) reflections: bool,
    pub(crate) camera: bool,
    /// `[render]`: bounces, exposure or tone.
    pub(crate) render: bool,
    pub(crate) component: bool,
    /// Marks over the picture alone: the selection, or a muted light.
    pub(crate) marks: bool,
}

impl Changed {
    /// Whether anything changed.
    pub(crate) fn any(self) -> bool {
        self != Self::default()
    }

    /// What differs between two documents.
    pub(crate) fn between(old: &Document, new: &Document) -> Self {
        let lights = lights_differ(&old.shown_lights(), &new.shown_lights());
        Self {
            lights,
            reflections: old.reflections != new.reflections,
            camera: old.camera != new.camera,
            render: old.render != new.render,
            component: old.component != new.component,
            marks: lights || states_differ(&old.lights, &new.lights),
        }
    }
}

impl Document {
    /// The document of a scene as it was loaded.
    pub(crate) fn of_scene(scene: &Scene, component: Component) -> Self {
        Self {
            lights: scene.lights.iter().cloned().map(EditedLight::new).collect(),
            reflections: Reflection::of_all(&scene.materials),
            camera: scene.camera,
            render: scene.render.clone(),
            component,
        }
    }

    /// The lights as the renderer shall see them, in order: the soloed ones where
    /// there are any, and no muted ones.
    pub(crate) fn shown_lights(&self) -> Vec<Light> {
        let any_soloed = self.lights.iter().any(|it| it.is_soloed && !it.is_muted);
        let shown = self.lights.iter();
        shown
            .filter(|it| !it.is_muted && (it.is_soloed || !any_soloed))
            .map(|it| it.light.clone())
            .collect()
    }

    /// All lights, as they are saved.
    pub(crate) fn lights(&self) -> Vec<Light> {
        self.lights.iter().map(|it| it.light.clone()).collect()
    }

    /// Whether what would be saved differs.
    pub(crate) fn saves_as_other(&self, other: &Self) -> bool {
        lights_differ(&self.lights(), &other.lights())
            || self.reflections != other.reflections
            || self.camera != other.camera
            || self.render != other.render
    }

    /// Whether anything differs.
    pub(crate) fn differs(&self, other: &Self) -> bool {
        Changed::between(self, other).any() || self.saves_as_other(other)
    }

    /// Whether the scene file may say all of it.
    pub(crate) fn is_valid(&self) -> bool {
        let lights = || self.lights.iter().map(|it| &it.light);
        let names_differ = |(index, light): (usize, &Light)| {
            !light.name.is_empty() && lights().skip(index + 1).all(|next| next.name != light.name)
        };
        lights().all(|light| is_valid_kind(&light.kind))
            && lights().enumerate().all(names_differ)
            && self.reflections.iter().all(is_valid_reflection)
            && is_valid_camera(&self.camera)
            && self.render.exposure.abs() <= LARGEST_EXPOSURE
    }
}

impl EditedLight {
    pub(crate) fn new(light: Light) -> Self {
        Self {
            light,
            is_muted: false,
            is_soloed: false,
        }
    }
}

/// A light's colour in its own unit (intensity, irradiance or radiance); `None`
/// for a sky with a map.
pub(crate) fn colour(kind: &LightKind) -> Option<Vec3> {
    match kind {
        LightKind::Point(light) => Some(light.intensity),
        LightKind::Spot(light) => Some(light.intensity),
        LightKind::Directional(light) => Some(light.irradiance),
        LightKind::Area(light) => Some(light.radiance),
        LightKind::Environment(light) => match light.radiance {
            Radiance::Constant(radiance) => Some(radiance),
            Radiance::Map(_) => None,
        },
    }
}

/// Gives a light another colour; a sky with a map keeps its own.
pub(crate) fn set_colour(kind: &mut LightKind, colour: Vec3) {
    match kind {
        LightKind::Point(light) => light.intensity = colour,
        LightKind::Spot(light) => light.intensity = colour,
        LightKind::Directional(light) => light.irradiance = colour,
        LightKind::Area(light) => light.radiance = colour,
        LightKind::Environment(light) => {
            if let Radiance::Constant(radiance) = &mut light.radiance {
                *radiance = colour;
            }
        }
    }
}

/// Where a light is; `None` for light from infinitely far away.
pub(crate) fn position(kind: &LightKind) -> Option<DVec3> {
    match kind {
        LightKind::Point(light) => Some(light.position),
        LightKind::Spot(light) => Some(light.position),
        LightKind::Area(light) => Some(light.corner + (light.edge_u + light.edge_v) * 0.5),
        LightKind::Directional(_) | LightKind::Environment(_) => None,
    }
}

/// Moves a light to a position, which is that of [`position`].
pub(crate) fn set_position(kind: &mut LightKind, position: DVec3) {
    match kind {
        LightKind::Point(light) => light.position = position,
        LightKind::Spot(light) => light.position = position,
        LightKind::Area(Area {
            corner,
            edge_u,
            edge_v,
            ..
        }) => *corner = position - (*edge_u + *edge_v) * 0.5,
        LightKind::Directional(_) | LightKind::Environment(_) => {}
    }
}

/// A light in a few words: kind, place, strength.
pub(crate) fn summary(kind: &LightKind) -> String {
    let name = match kind {
        LightKind::Point(_) => "point",
        LightKind::Spot(_) => "spot",
        LightKind::Directional(_) => "sun",
        LightKind::Area(_) => "rectangle",
        LightKind::Environment(_) => "sky",
    };
    let place = position(kind).map_or(String::new(), |at| format!(" at {}", triple(at.as_vec3())));
    let strength = colour(kind).map_or(String::new(), |colour| format!(", {}", triple(colour)));
    format!("{name}{place}{strength}")
}

/// How a material reflects in a few words, with so many places of its colours.
pub(crate) fn reflection_summary(reflection: &Reflection, places: usize) -> String {
    let colour = |name: &str, colour: Vec3| {
        let [r, g, b] = colour.to_array();
        format!("{name} {r:.places$} {g:.places$} {b:.places$}")
    };
    let mut parts = Vec::new();
    if !reflection.is_metal() {
        parts.push(colour("albedo", reflection.albedo));
    }
    if reflection.is_glossy() {
        parts.push(colour("specular", reflection.specular));
        parts.push(format!("roughness {:.3}", reflection.roughness));
    }
    parts.join(", ")
}

/// Three numbers to two places.
pub(crate) fn triple(values: Vec3) -> String {
    let [x, y, z] = values.to_array();
    format!("{x:.2} {y:.2} {z:.2}")
}

/// Equal maps are one map here: comparing their pixels would take longer than a
/// frame.
fn lights_differ(old: &[Light], new: &[Light]) -> bool {
    old.len() != new.len()
        || old
            .iter()
            .zip(new)
            .any(|(old, new)| light_differs(old, new))
}

fn light_differs(old: &Light, new: &Light) -> bool {
    let (LightKind::Environment(a), LightKind::Environment(b)) = (&old.kind, &new.kind) else {
        return old != new;
    };
    let radiance_differs = match (&a.radiance, &b.radiance) {
        (Radiance::Map(a), Radiance::Map(b)) => !Arc::ptr_eq(a, b),
        (Radiance::Constant(a), Radiance::Constant(b)) => a != b,
        _ => true,
    };
    old.name != new.name
        || radiance_differs
        || a.scale != b.scale
        || a.rotation_deg != b.rotation_deg
}

fn states_differ(old: &[EditedLight], new: &[EditedLight]) -> bool {
    let state = |it: &EditedLight| (it.is_muted, it.is_soloed);
    old.len() != new.len()
        || old
            .iter()
            .zip(new)
            .any(|(old, new)| state(old) != state(new))
}

fn is_valid_reflection(reflection: &Reflection) -> bool {
    is_within(reflection.albedo, 1.0)
        && is_within(reflection.specular, 1.0)
        && (0.0..=1.0).contains(&reflection.roughness)
}

fn is_valid_kind(kind: &LightKind) -> bool {
    let shape = match kind {
        LightKind::Point(light) => is_place(light.position),
        LightKind::Spot(light) => {
            let angles = light.cutoff_deg > 0.0
                && light.cutoff_deg <= 90.0
                && light.beam_deg >= 0.0
                && light.beam_deg <= light.cutoff_deg;
            is_place(light.position) && is_unit(light.direction) && angles
        }
        LightKind::Directional(light) => is_unit(light.direction),
        LightKind::Area(light) => {
            let [u, v] = [light.edge_u, light.edge_v].map(DVec3::normalize_or_zero);
            [light.corner, light.edge_u, light.edge_v]
                .into_iter()
                .all(is_place)
                && u.cross(v).length() > LEAST_SINE
        }
        LightKind::Environment(light) => {
            light.scale >= 0.0
                && f64::from(light.scale) <= LARGEST
                && light.rotation_deg.abs() < 360.0
        }
    };
    shape && colour(kind).is_none_or(|colour| is_within(colour, LARGEST as f32))
}

fn is_valid_camera(camera: &Camera) -> bool {
    let view = (camera.target - camera.position).normalize_or_zero();
    let places = [camera.position, camera.target, camera.up];
    places.into_iter().all(is_place)
        && view.cross(camera.up.normalize_or_zero()).length() > LEAST_SINE
        && camera.vfov_deg > 0.0
        && camera.vfov_deg < 180.0
}

fn is_place(place: DVec3) -> bool {
    place.abs().max_element() <= LARGEST && place.is_finite()
}

fn is_unit(direction: Vec3) -> bool {
    (direction.length() - 1.0).abs() < 1e-5
}

fn is_within(colour: Vec3, most: f32) -> bool {
    colour.is_finite() && colour.min_element() >= 0.0 && colour.max_element() <= most
}
