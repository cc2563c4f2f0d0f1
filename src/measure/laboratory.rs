//! The laboratory: variants of the method, measured under tuning lights.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use super::run::albedo;
use super::statistics::{ByLight, errors, without_noise};
use super::vertices::{plus, times};
use crate::bake::knobs::{DEFAULT, Knobs, Masses, Operator, Share, set};
use crate::bake::lab::{LabBasis, prepare};
use crate::bake::{
    Bake, BakeSettings, LIGHTS, LightErrors, RunSettings, Study, StudyLight, VertexFields,
};
use crate::scene::{Override, Scene};
use crate::surface::{Surface, direct};

const LIGHT_SEED: u32 = 0x7e57_ab1e;
const ROW_SEEDS: [u32; 2] = [0x7e57_0001, 0x7e57_0002];
const LAST_SEEDS: [u32; 2] = [0x7e57_0003, 0x7e57_0004];
const ROW_RAYS: u32 = 384;
const LAST_RAYS: u32 = 4096;
const RECEIVERS: usize = 2000;
const KEPT: u32 = 4096;

struct Place {
    name: &'static str,
    path: &'static str,
    set: &'static [&'static str],
    pilots: usize,
}

const PLACES: [Place; 5] = [
    Place { name: "cornell", path: "scenes/cornell/cornell.toml", set: &["bake.max_edge=0.13"], pilots: 1000 },
    Place { name: "window", path: "scenes/window/window.toml", set: &["bake.max_edge=0.32"], pilots: 1000 },
    Place { name: "sheet", path: "scenes/sheet/sheet.toml", set: &["bake.max_edge=0.2"], pilots: 1000 },
    Place { name: "statues", path: "scenes/statues/statues.toml", set: &[], pilots: 16 },
    Place { name: "bunny_room", path: "/work/shared/scenes/bunny_room/scene.toml", set: &[], pilots: 20 },
];

struct Lab<'a> {
    study: &'a Study<'a>,
    surface: &'a Surface,
    run: RunSettings<'a>,
    receivers: Vec<u32>,
    is_whole: bool,
    areas: Vec<f64>,
    albedo: Vec<f32>,
    lights: Vec<StudyLight>,
    direct: VertexFields,
    before_last: VertexFields,
    mean: VertexFields,
    noise: [ByLight; 2],
    seconds_a_ray: f64,
    bases: BTreeMap<String, (LabBasis, f64)>,
    found: BTreeMap<String, Outcome>,
}

/// Seconds of the processor so far, all threads.
fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap();
    let fields: Vec<&str> = text[text.rfind(')').unwrap()..].split(' ').collect();
    (fields[12].parse::<f64>().unwrap() + fields[13].parse::<f64>().unwrap()) / 100.0
}

fn stats(errors: &ByLight) -> LightErrors {
    LightErrors::of(&std::array::from_fn(|light| errors[light]))
}

#[derive(Clone, Copy)]
struct Outcome {
    errors: [LightErrors; 2],
    by_light: [Option<[f64; 2]>; LIGHTS],
    bytes: f64,
    seconds: f64,
    entries: f64,
}

impl<'a> Lab<'a> {
    fn new(
        study: &'a Study<'a>,
        surface: &'a Surface,
        scene: &Scene,
        vertices: &[u32],
        seconds_a_ray: f64,
        run: RunSettings<'a>,
    ) -> Self {
        let count = RECEIVERS.min(vertices.len());
        let receivers: Vec<u32> = (0..count)
            .map(|i| vertices[(2 * i + 1) * vertices.len() / (2 * count)])
            .collect();
        let albedo: Vec<f32> = albedo(scene, surface).iter().map(|a| a.element_sum() / 3.0).collect();
        let settings = BakeSettings::of_keys(&scene.bake);
        let start = cpu_seconds();
        let basis = study.lab_basis(&settings, &run).unwrap();
        let basis_seconds = cpu_seconds() - start;
        let (lights, direct) = study.lights(basis.basis(), LIGHT_SEED);
        let half = |which: usize| {
            let rows = study.trace(ROW_SEEDS[which], ROW_RAYS, &run).unwrap();
            let mut brightness = times(&albedo, &direct);
            for _ in 1..4 {
                let arriving = study.bounce_by(&rows, &brightness);
                brightness = times(&albedo, &plus(&direct, &arriving));
            }
            let fields = direct.beside(&brightness);
            let last = study
                .bounce_at(&receivers, [LAST_SEEDS[which], LAST_RAYS], &fields, &run)
                .unwrap();
            (brightness, last)
        };
        let ((b0, h0), (b1, h1)) = (half(0), half(1));
        let mean_of = |a: &VertexFields, b: &VertexFields| VertexFields {
            width: a.width,
            values: a.values.iter().zip(&b.values).map(|(a, b)| 0.5 * (a + b)).collect(),
        };
        let mean = mean_of(&h0, &h1);
        let areas: Vec<f64> = receivers
            .iter()
            .map(|&v| f64::from(surface.vertices.open_area(v as usize)))
            .collect();
        let noise = [0..LIGHTS, LIGHTS..2 * LIGHTS]
            .map(|range| errors(&areas, &mean.columns(range.clone()), &h0.columns(range)));
        let mut bases = BTreeMap::new();
        bases.insert(key(&DEFAULT, &settings), (basis, basis_seconds));
        Self {
            study,
            surface,
            run,
            is_whole: vertices.len() == surface.vertices.len(),
            receivers,
            areas,
            albedo,
            lights,
            direct,
            before_last: mean_of(&b0, &b1),
            mean,
            noise,
            seconds_a_ray,
            bases,
            found: BTreeMap::new(),
        }
    }

    fn outcome(&mut self, knobs: Knobs, settings: &BakeSettings) -> Outcome {
        set(knobs);
        let key = key(&knobs, settings);
        if let Some(found) = (knobs == DEFAULT).then(|| self.found.get(&format!("{settings:?}"))).flatten() {
            set(DEFAULT);
            return *found;
        }
        if !self.bases.contains_key(&key) {
            let start = cpu_seconds();
            let basis = self.study.lab_basis(settings, &self.run).unwrap();
            self.bases.insert(key.clone(), (basis, cpu_seconds() - start));
        }
        let start = cpu_seconds();
        let (bake, wanted) = self
            .study
            .lab_bake(&self.bases[&key].0, settings, &self.receivers, &self.run)
            .unwrap();
        let seconds = cpu_seconds() - start
            + self.bases[&key].1 * wanted as f64 / self.surface.vertices.len() as f64
            + self.seconds_a_ray * wanted as f64 * f64::from(settings.rays);
        let bounce = |fields: &VertexFields| bake.bounce(self.run.level, fields);
        let one = bounce(&self.direct);
        let four = if self.is_whole {
            let mut arriving = bounce(&times(&self.albedo, &self.direct));
            for _ in 1..4 {
                arriving = bounce(&times(&self.albedo, &plus(&self.direct, &arriving)));
            }
            arriving
        } else {
            bounce(&self.before_last)
        };
        let one = self.against_truth(0, &one);
        let four = self.against_truth(1, &four);
        set(DEFAULT);
        let outcome = Outcome {
            errors: [stats(&one), stats(&four)],
            by_light: std::array::from_fn(|light| one[light]),
            bytes: bytes(&bake, wanted),
            seconds,
            entries: bake.operator().coefficients_per_vertex() * self.surface.vertices.len() as f64
                / wanted as f64,
        };
        if knobs == DEFAULT {
            self.found.insert(format!("{settings:?}"), outcome);
        }
        outcome
    }

    fn against_truth(&self, which: usize, estimate: &VertexFields) -> ByLight {
        let truth = self.mean.columns(which * LIGHTS..(which + 1) * LIGHTS);
        let found = errors(&self.areas, &truth, &estimate.at(&self.receivers));
        without_noise(found, &self.noise[which])
    }

    /// Direct light by so many points a vertex against 64, through the same rays.
    fn points(&self) -> Vec<(String, LightErrors)> {
        let shadows = direct::Shadows::of_surface(self.surface, self.run.level);
        let counts = [64, 1, 4, 8, 16];
        let placed: Vec<_> = self.lights.iter().filter_map(|l| l.placed.clone()).collect();
        let mut columns = Vec::new();
        for light in &placed {
            let red = |values: Vec<glam::Vec3>| values.iter().map(|e| e.x).collect::<Vec<f32>>();
            for count in counts {
                columns.push(red(direct::at_vertices_by_many(&shadows, light, count)));
            }
            columns.push(red(direct::at_vertices(&shadows, light)));
        }
        let fields = VertexFields::of_columns(&columns);
        let bounced = self
            .study
            .bounce_at(&self.receivers, [LAST_SEEDS[0], 2048], &fields, &self.run)
            .unwrap();
        let names = ["64", "1", "4", "8", "16", "8 where uneven"];
        (1..6)
            .map(|which| {
                let all = errors(
                    &self.areas,
                    &VertexFields::of_columns(&(0..placed.len()).map(|l| bounced.column(6 * l)).collect::<Vec<_>>()),
                    &VertexFields::of_columns(&(0..placed.len()).map(|l| bounced.column(6 * l + which)).collect::<Vec<_>>()),
                );
                let filled = std::array::from_fn(|l| all.get(l).copied().flatten());
                (names[which].to_owned(), LightErrors::of(&filled))
            })
            .collect()
    }
}

impl Lab<'_> {
    /// What a bake of the defaults states under lights of several seeds.
    fn seeds(&self, settings: &BakeSettings) {
        let prepared = &self.bases[&key(&DEFAULT, settings)].0;
        let (bake, _) = self
            .study
            .lab_bake(prepared, settings, &self.receivers, &self.run)
            .unwrap();
        let mut kept: Vec<Vec<LightErrors>> = vec![Vec::new(), Vec::new()];
        for seed in 0..6_u32 {
            for (which, old) in [true, false].into_iter().enumerate() {
                // SAFETY: nothing else runs.
                #[allow(unsafe_code)]
                unsafe {
                    if old {
                        std::env::set_var("LAB_OLD", "1");
                    } else {
                        std::env::remove_var("LAB_OLD");
                    }
                }
                let (_, fields) = self.study.lights(prepared.basis(), 0x7e57_0100 + seed);
                let truth = self
                    .study
                    .bounce_at(&self.receivers, [LAST_SEEDS[0], LAST_RAYS], &fields, &self.run)
                    .unwrap();
                let found = bake.bounce(self.run.level, &fields).at(&self.receivers);
                let by_light = errors(&self.areas, &truth, &found);
                kept[which].push(stats(&by_light));
                let each: Vec<String> = by_light
                    .iter()
                    .map(|e| e.map_or("-".to_owned(), |e| format!("{:.1}", e[0] * 100.0)))
                    .collect();
                let s = stats(&by_light);
                println!(
                    "seeds,{},{seed},{:.3},{:.3},{:.3},{}",
                    if old { "old" } else { "new" },
                    s.mean * 100.0, s.p95 * 100.0, s.signed * 100.0, each.join(" ")
                );
            }
        }
    }
}

fn bytes(bake: &Bake, wanted: usize) -> f64 {
    let all = bake.basis().slot_count();
    let dark = (all - wanted) as f64 / 8.0 * 80.0;
    let scales = 4.0 * bake.basis().function_count() as f64 * (1.0 - wanted as f64 / all as f64);
    (bake.operator().bytes() as f64 - dark - scales) / wanted as f64
}

fn key(knobs: &Knobs, settings: &BakeSettings) -> String {
    format!(
        "{:?} {:?} {:?} {:?} {:?} {}",
        knobs.laplacian, knobs.masses, knobs.least_mass, knobs.share, settings.functions, settings.vertices_per_part
    )
}

struct Variant {
    knob: &'static str,
    name: String,
    knobs: Knobs,
    change: Box<dyn Fn(&mut BakeSettings, usize)>,
    /// Whether entries are changed until the bytes are those of the default.
    at_equal_bytes: bool,
}

fn variants() -> Vec<Variant> {
    let mut all: Vec<Variant> = Vec::new();
    let mut add = |knob: &'static str, name: &str, knobs: Knobs| {
        all.push(Variant { knob, name: name.to_owned(), knobs, change: Box::new(|_, _| ()), at_equal_bytes: true });
    };
    let d = DEFAULT;
    add("representation", "low rank", d);
    add("representation", "sparse lists (near share 0.2)", Knobs { sparse: true, near_share: 0.2, near_most: 0.0, ..d });
    add("representation", "sparse lists (near share 0.4)", Knobs { sparse: true, near_most: 0.0, ..d });
    add("near field", "one threshold (4 x the mean at most)", d);
    add("near field", "one threshold (8 x the mean at most)", Knobs { near_most: 8.0, ..d });
    add("near field", "the same for all", Knobs { near_most: 0.0, ..d });
    for share in [0.2, 0.3, 0.4, 0.5, 0.6] {
        add("near share", &format!("{share}"), Knobs { near_share: share, ..d });
    }
    add("functions shared by", "root of what bounces x vertices", d);
    add("functions shared by", "area", Knobs { share: Share::Area, ..d });
    add("functions shared by", "vertices", Knobs { share: Share::Vertices, ..d });
    add("functions shared by", "root of area x vertices", Knobs { share: Share::RootOfBoth, ..d });
    add("functions shared by", "what bounces", Knobs { share: Share::Bounce, ..d });
    add("ranks", "by singular value", d);
    add("ranks", "the same for all", Knobs { equal_rank: true, ..d });
    add("constant response", "kept", d);
    add("constant response", "not kept", Knobs { constant: false, ..d });
    add("smoothing of U", "on", d);
    add("smoothing of U", "off", Knobs { smoothing: false, ..d });
    add("noise in V", "left out", d);
    add("noise in V", "kept", Knobs { leave_noise: false, ..d });
    add("rays", "3072", d);
    add("entries", "72", d);
    add("vertices a partition", "600", d);
    add("functions for 1000 vertices", "64", d);
    add("laplacian", "combinatorial; fit by what bounces", d);
    add("laplacian", "combinatorial; no masses", Knobs { masses: Masses::One, ..d });
    add("laplacian", "combinatorial; fit by area", Knobs { masses: Masses::Area, ..d });
    add("laplacian", "combinatorial with area as mass; fit by what bounces", Knobs { laplacian: Operator::CombinatorialArea, ..d });
    add("laplacian", "cotangent with area as mass; fit by area", Knobs { laplacian: Operator::Cotangent, masses: Masses::Area, ..d });
    add("laplacian", "cotangent with area as mass; fit by what bounces", Knobs { laplacian: Operator::Cotangent, ..d });
    let mut with = |knob: &'static str, name: String, equal: bool, change: Box<dyn Fn(&mut BakeSettings, usize)>| {
        all.push(Variant { knob, name, knobs: d, change, at_equal_bytes: equal });
    };
    for per in [32_u32, 96, 128] {
        with("functions for 1000 vertices", per.to_string(), true, Box::new(move |s, n| s.functions = Some((n as f64 * f64::from(per) / 1000.0).ceil() as u32)));
    }
    for size in [300_u32, 1200] {
        with("vertices a partition", size.to_string(), true, Box::new(move |s, _| s.vertices_per_part = size));
    }
    for rays in [1024_u32, 2048, 4096] {
        with("rays", rays.to_string(), false, Box::new(move |s, _| s.rays = rays));
    }
    for entries in [48_u32, 96, 128] {
        with("entries", entries.to_string(), false, Box::new(move |s, _| s.coefficients = entries));
    }
    let mut add = |knob: &'static str, name: &str, knobs: Knobs| {
        all.push(Variant { knob, name: name.to_owned(), knobs, change: Box::new(|_, _| ()), at_equal_bytes: true });
    };
    add("rays by area", "the same for all", d);
    add("rays by area", "by root of area (4 x the mean at most)", Knobs { rays_power: 0.5, rays_most: 4.0, ..d });
    add("least mass", "0.02", d);
    add("least mass", "0.001", Knobs { least_mass: 0.001, ..d });
    for threshold in [2.0, 4.0, 8.0] {
        add("threshold of functions in V", &format!("{threshold}"), Knobs { function_threshold: threshold, ..d });
    }
    all
}

fn extra() -> Vec<Variant> {
    let d = DEFAULT;
    let mut all: Vec<Variant> = Vec::new();
    // LAB_EXTRA: "name|field=value,field=value|functions|coefficients;..."
    for text in std::env::var("LAB_EXTRA").unwrap_or_default().split(';').filter(|t| !t.is_empty()) {
        let parts: Vec<&str> = text.split('|').collect();
        let mut knobs = d;
        let (mut functions, mut entries, mut rays, mut part) = (None::<f64>, None::<u32>, None::<u32>, None::<u32>);
        let mut equal = false;
        for pair in parts[1].split(',').filter(|p| !p.is_empty()) {
            let (field, value) = pair.split_once('=').unwrap();
            let number = || value.parse::<f64>().unwrap();
            match field {
                "share" => knobs.share = match value { "area" => Share::Area, "vertices" => Share::Vertices, "rootboth" => Share::RootOfBoth, "bounce" => Share::Bounce, "rootbounce" => Share::RootOfBounce, _ => panic!("{value}") },
                "near" => knobs.near_share = number(),
                "most" => knobs.near_most = number(),
                "mass" => knobs.least_mass = number(),
                "threshold" => knobs.function_threshold = number(),
                "power" => knobs.rays_power = number(),
                "raysmost" => knobs.rays_most = number(),
                "functions" => functions = Some(number()),
                "entries" => entries = Some(number() as u32),
                "rays" => rays = Some(number() as u32),
                "part" => part = Some(number() as u32),
                "constant" => knobs.constant = number() > 0.0,
                "equal" => equal = true,
                _ => panic!("{field}"),
            }
        }
        all.push(Variant {
            knob: "extra",
            name: parts[0].to_owned(),
            knobs,
            change: Box::new(move |s, n| {
                if let Some(per) = functions { s.functions = Some((n as f64 * per / 1000.0).ceil() as u32); }
                if let Some(entries) = entries { s.coefficients = entries; }
                if let Some(rays) = rays { s.rays = rays; }
                if let Some(part) = part { s.vertices_per_part = part; }
            }),
            at_equal_bytes: equal,
        });
    }
    all
}

fn wanted(list: &str, name: &str) -> bool {
    let list = std::env::var(list).unwrap_or_default();
    list.is_empty() || list.split(',').any(|it| it == name)
}

#[test]
#[ignore = "a laboratory: prints a table"]
fn variants_are_compared() {
    let run = RunSettings::silent();
    for place in PLACES.iter().filter(|p| wanted("LAB_SCENES", p.name)) {
        let sets: Vec<Override> = place.set.iter().map(|s| Override::parse(s).unwrap()).collect();
        let mut scene = Scene::load(Path::new(place.path), &sets).unwrap();
        scene.warnings.clear();
        let start = Instant::now();
        let (surface, backs, open, vertices, seconds_a_ray) = prepare(&scene, place.pilots, KEPT, &run);
        let study = Study::in_laboratory(&surface, backs, open, &run).unwrap();
        let mut lab = Lab::new(&study, &surface, &scene, &vertices, seconds_a_ray, run);
        let count = surface.vertices.len();
        eprintln!(
            "# {} {} vertices, {} in parts, {} receivers; ready after {:.1} s; noise of truth {:.4} {:.4}",
            place.name, count, vertices.len(), lab.receivers.len(), start.elapsed().as_secs_f64(),
            stats(&lab.noise[0]).mean, stats(&lab.noise[1]).mean,
        );
        let settings = BakeSettings::of_keys(&scene.bake);
        let default = lab.outcome(DEFAULT, &settings);
        if std::env::var("LAB_LIGHTS").is_ok() {
            for (number, (light, error)) in lab.lights.iter().zip(&default.by_light).enumerate() {
                eprintln!("# light {number} {:?} {error:?} {:?}", light.kind, light.placed);
            }
        }
        if std::env::var("LAB_SEEDS").is_ok() {
            lab.seeds(&settings);
        }
        let mut chosen: Option<[LightErrors; 2]> = None;
        let list = if std::env::var("LAB_EXTRA").is_ok() { extra() } else { variants() };
        for variant in list.iter().filter(|v| v.knob == "extra" || wanted("LAB_KNOBS", v.knob)) {
            let mut settings = settings;
            (variant.change)(&mut settings, count);
            let is_default = variant.knobs == DEFAULT && settings == BakeSettings::of_keys(&scene.bake);
            let mut found = if is_default {
                lab.outcome(DEFAULT, &settings)
            } else {
                lab.outcome(variant.knobs, &settings)
            };
            if is_default {
                chosen.get_or_insert_with(|| found.errors);
            }
            for _ in 0..1 {
                let ratio = found.bytes / default.bytes;
                if !variant.at_equal_bytes || (ratio - 1.0).abs() < 0.02 {
                    break;
                }
                let entries = f64::from(settings.coefficients) / ratio;
                settings.coefficients = (entries.round() as u32).clamp(8, 300);
                found = lab.outcome(variant.knobs, &settings);
            }
            let p = |x: f64| x * 100.0;
            println!(
                "{},\"{}\",{},{},{:.3},{:.3},{:.3},{:.3},{:.3},{:.3},{:.1},{:.1},{:.1}",
                variant.knob, variant.name, place.name, settings.coefficients,
                p(found.errors[0].mean), p(found.errors[0].p95), p(found.errors[0].signed),
                p(found.errors[1].mean), p(found.errors[1].p95), p(found.errors[1].signed),
                found.bytes, found.entries, found.seconds,
            );
            lab.bases.retain(|k, _| *k == key(&DEFAULT, &BakeSettings::of_keys(&scene.bake)));
        }
        if std::env::var("LAB_EXTRA").is_err() && wanted("LAB_KNOBS", "points") {
            for (name, found) in lab.points() {
                let p = |x: f64| x * 100.0;
                println!("points a vertex,\"{name}\",{},,{:.3},{:.3},{:.3},,,,,,", place.name, p(found.mean), p(found.p95), p(found.signed));
            }
        }
    }
}
