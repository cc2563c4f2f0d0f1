//! The scenes of `scenes/`: their meshes and pictures are generated here, and
//! the files in the repository must be the generator's bytes.
//!
//! `RELUME_UPDATE_SCENES=1 cargo test --test scenes` writes them anew; that run
//! fails, so that a rewritten scene cannot pass unnoticed. The TOML files beside
//! the meshes are typed by hand.

#[path = "scenes/mod.rs"]
mod generator;

use std::fs;
use std::path::{Path, PathBuf};

use generator::body::{Body, Shape};
use generator::model::Model;
use generator::{obj, topology};
use glam::DVec3;
use relume::Scene;

/// Environment variable that makes the test write the files.
const UPDATE: &str = "RELUME_UPDATE_SCENES";
/// The repository stays small: most bytes of all generated files together.
const MOST_BYTES_IN_ALL: usize = 8_000_000;
/// Most bytes of one file: the mesh of the statues, and of any other scene.
const MOST_BYTES_OF_STATUES: usize = 4_000_000;
const MOST_BYTES_A_FILE: usize = 350_000;
/// Smallest triangle, square metres: a tenth of a millimetre by ten; anything
/// smaller is a slip of the generator, not a detail of a scene.
const SMALLEST_AREA: f64 = 1e-7;

fn scenes_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

/// The generated files of a scene: path and content.
fn generated_files(model: &Model) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = scenes_folder().join(model.name);
    let stem = folder.join(model.name);
    let mut files = vec![
        (stem.with_extension("obj"), obj::mesh_text(model).into()),
        (stem.with_extension("mtl"), obj::material_text(model).into()),
    ];
    let pictures = model.pictures.iter();
    files.extend(pictures.map(|picture| (folder.join(picture.name), picture.bytes.clone())));
    files
}

/// The scene files of a scene: every TOML file of its folder.
fn scene_files(model: &Model) -> Vec<PathBuf> {
    let folder = scenes_folder().join(model.name);
    let entries = fs::read_dir(&folder).expect("a scene has a folder");
    let paths = entries.map(|entry| entry.expect("the folder can be listed").path());
    paths
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect()
}

#[test]
fn the_files_are_the_generators_bytes() {
    let update = std::env::var_os(UPDATE).is_some_and(|value| value == "1");
    let mut written = Vec::new();
    for (path, bytes) in generator::all().iter().flat_map(generated_files) {
        if fs::read(&path).is_ok_and(|found| found == bytes) {
            continue;
        }
        assert!(
            update,
            "{} is not what the generator makes; {UPDATE}=1 writes it anew",
            path.display()
        );
        let folder = path.parent().expect("a scene file lies in a folder");
        fs::create_dir_all(folder).expect("the scene's folder can be created");
        fs::write(&path, bytes).expect("the scene file can be written");
        written.push(path);
    }
    assert!(
        written.is_empty(),
        "written anew, look at them and run again: {written:#?}"
    );
}

#[test]
fn every_scene_file_names_its_generated_mesh() {
    for model in generator::all() {
        let paths = scene_files(&model);
        let main = format!("{}.toml", model.name);
        assert!(
            paths.iter().any(|path| path.ends_with(&main)),
            "{main} is missing"
        );
        let mesh = format!("mesh = \"{}.obj\"", model.name);
        for path in paths {
            let text = fs::read_to_string(&path)
                .unwrap_or_else(|error| panic!("{} cannot be read: {error}", path.display()));
            assert!(
                text.lines().any(|line| line.trim_end() == mesh),
                "{} does not say {mesh}",
                path.display()
            );
            assert!(
                text.starts_with('#'),
                "{} starts with what it shows",
                path.display()
            );
        }
    }
}

#[test]
fn every_scene_file_loads_without_a_warning() {
    for path in generator::all().iter().flat_map(scene_files) {
        let scene = Scene::load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.warnings, [""; 0], "{}", path.display());
    }
}

#[test]
fn the_files_are_small() {
    let mut total = 0;
    for (path, bytes) in generator::all().iter().flat_map(generated_files) {
        let most = if path.ends_with("statues.obj") {
            MOST_BYTES_OF_STATUES
        } else {
            MOST_BYTES_A_FILE
        };
        assert!(
            bytes.len() <= most,
            "{} has {} bytes",
            path.display(),
            bytes.len()
        );
        total += bytes.len();
    }
    assert!(total <= MOST_BYTES_IN_ALL, "{total} bytes in all");
}

#[test]
fn no_mesh_holds_a_negative_zero() {
    for model in generator::all() {
        let text = obj::mesh_text(&model);
        assert!(!text.contains("-0.0000 "), "{}: -0", model.name);
    }
}

/// Runs a check on every body of every scene.
fn check_bodies(check: impl Fn(&Body) -> Result<(), String>) {
    for model in generator::all() {
        for body in &model.bodies {
            if let Err(fault) = check(body) {
                panic!("{}, {}: {fault}", model.name, body.name);
            }
        }
    }
}

#[test]
fn every_edge_is_used_once_a_direction() {
    check_bodies(topology::check_manifold);
}

#[test]
fn closed_bodies_are_watertight() {
    check_bodies(|body| match body.shape {
        Shape::Solid | Shape::Hollow => topology::check_watertight(body),
        Shape::Open { .. } => Ok(()),
    });
}

#[test]
fn fronts_face_where_the_light_is() {
    check_bodies(|body| match body.shape {
        Shape::Solid => topology::check_volume_sign(body, 1.0),
        Shape::Hollow => topology::check_volume_sign(body, -1.0),
        Shape::Open { seen_from } => topology::check_faces_towards(body, seen_from),
    });
}

#[test]
fn no_face_is_degenerate_and_no_corner_is_stored_twice() {
    check_bodies(|body| topology::check_areas(body, SMALLEST_AREA));
    check_bodies(topology::check_distinct_positions);
}

#[test]
fn walls_have_no_t_junctions() {
    check_bodies(|body| match body.shape {
        Shape::Open { .. } => topology::check_no_t_junctions(body),
        Shape::Solid | Shape::Hollow => Ok(()),
    });
}

#[test]
fn given_normals_agree_with_the_faces() {
    check_bodies(topology::check_normals);
}

#[test]
fn the_statues_have_the_size_of_the_published_measurements() {
    let model = generator::statues::model();
    let vertices = model.vertex_count();
    let triangles = model.triangle_count();
    assert!((34_000..=36_000).contains(&vertices), "{vertices} vertices");
    assert!(
        (68_000..=72_000).contains(&triangles),
        "{triangles} triangles"
    );
}

#[test]
fn the_sphere_is_as_large_as_its_header_says() {
    let body = &generator::sphere::model().bodies[0];
    let share = topology::area(body) / (4.0 * std::f64::consts::PI);
    assert!(
        (0.9980..0.9990).contains(&share),
        "area is {share} of the round sphere's; the header names 0.15 % less"
    );
}

#[test]
fn the_halves_beside_the_sheet_share_nothing() {
    let model = generator::sheet::model();
    let side = |point: &DVec3| point.x.total_cmp(&0.0);
    for body in model.bodies.iter().filter(|body| body.name != "sheet") {
        let first = side(&body.positions[0]);
        assert!(
            first.is_ne() && body.positions.iter().all(|point| side(point) == first),
            "{} lies on both sides of the sheet",
            body.name
        );
    }
}
