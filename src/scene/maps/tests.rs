//! Textures of materials: which file, which colour beside it, which triangles.

use std::path::Path;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use crate::scene::files::{Files, Memory};
use crate::scene::sample_images::PNG;
use crate::scene::{Material, Override, Scene, SceneError};

const TOML: &str = "mesh = \"a.obj\"\n[camera]\nposition = [0, 1, 5]\ntarget = [0, 1, 0]\n\
                    vfov = 40\nsize = [64, 48]\n";
const VERTICES: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n";
const MAPPED: &str = "f 1/1 2/2 3/3\n";

/// A scene whose mesh has these faces and this MTL, with `a.png` beside it.
fn load(faces: &str, mtl: &str, overrides: &[&str]) -> Result<Scene, SceneError> {
    let obj = format!("{VERTICES}{faces}");
    let files = Memory::of(&[
        ("s.toml", TOML.as_bytes()),
        ("a.obj", obj.as_bytes()),
        ("a.mtl", mtl.as_bytes()),
        ("a.png", PNG),
    ]);
    let overrides: Result<Vec<_>, _> = overrides.iter().map(|o| Override::parse(o)).collect();
    let path = Path::new("s.toml");
    Scene::load_with(&files.read(path).unwrap(), path, &overrides?, &files)
}

/// The only material of a mapped triangle, with its warnings.
fn material(statements: &str, overrides: &[&str]) -> (Material, Vec<String>) {
    let faces = format!("usemtl m\n{MAPPED}");
    let scene = load(&faces, &format!("newmtl m\n{statements}"), overrides).unwrap();
    assert_eq!(scene.materials.len(), 1);
    (scene.materials[0].clone(), scene.warnings)
}

#[test]
fn options_reach_the_map_and_a_file_is_decoded_once() {
    let (material, warnings) = material(
        "map_Kd -s 2 3 -o 0.5 0.25 -clamp on a.png\nmap_Ke A.PNG\n",
        &[],
    );
    let map = material.albedo_map.unwrap();
    assert_eq!(map.scale, Vec2::new(2.0, 3.0));
    assert_eq!(map.offset, Vec2::new(0.5, 0.25));
    assert!(map.clamp);
    let emission = material.emission_map.unwrap();
    assert_eq!((emission.scale, emission.clamp), (Vec2::ONE, false));
    assert!(Arc::ptr_eq(&map.texture, &emission.texture));
    assert_eq!(warnings, [""; 0]);
}

#[test]
fn a_black_or_absent_colour_beside_a_map_means_the_map_alone() {
    let colours = |statements: &str, overrides: &[&str]| {
        let (material, _) = material(statements, overrides);
        (material.albedo, material.emission)
    };
    let half = Vec3::splat(0.5);
    for (statements, albedo, emission) in [
        ("", Vec3::splat(0.8), Vec3::ZERO),
        ("Kd 0 0 0", Vec3::ZERO, Vec3::ZERO),
        ("map_Kd a.png", Vec3::ONE, Vec3::ZERO),
        ("Kd 0 0 0\nmap_Kd a.png", Vec3::ONE, Vec3::ZERO),
        ("map_Kd a.png\nKd 0.5", half, Vec3::ZERO),
        ("Kd 0.5\nmap_Ke a.png", half, Vec3::ONE),
        ("Kd 0.5\nKe 0 0 0\nmap_Ke a.png", half, Vec3::ONE),
        (
            "Kd 0.5\nKe 4 5 6\nmap_Ke a.png",
            half,
            Vec3::new(4.0, 5.0, 6.0),
        ),
        // Files that are not there leave the colours that their absence does.
        ("Kd 0 0 0\nmap_Kd b.png", Vec3::splat(0.8), Vec3::ZERO),
        ("Kd 0.5\nmap_Kd b.png\nmap_Ke b.png", half, Vec3::ZERO),
    ] {
        assert_eq!(colours(statements, &[]), (albedo, emission), "{statements}");
    }
}

#[test]
fn an_override_multiplies_the_map_whatever_it_is() {
    let statements = "map_Kd a.png\nmap_Ke a.png";
    let overrides = [
        "material.m.albedo=[0, 0, 0]",
        "material.m.emission=[0, 0, 0]",
    ];
    let (black, _) = material(statements, &overrides);
    assert_eq!((black.albedo, black.emission), (Vec3::ZERO, Vec3::ZERO));
    assert!(black.albedo_map.is_some() && black.emission_map.is_some());
    let (lit, _) = material(statements, &["material.m.emission=[1, 2, 3]"]);
    assert_eq!(lit.emission, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(lit.albedo, Vec3::ONE, "the other colour is not touched");
    let (missing, _) = material("map_Kd b.png", &["material.m.albedo=[0, 0, 1]"]);
    assert_eq!(missing.albedo, Vec3::Z);
}

#[test]
fn a_metal_beside_a_map_reflects_its_colour_and_is_warned_of() {
    let with = |statements: &str, overrides: &[&str]| material(statements, overrides);
    let metal = "material.m.brdf=\"brushed metal\"";
    let half = Vec3::splat(0.5);
    // The colour beside a map that stands alone is white, and it is the metal's then.
    for (statements, specular) in [
        ("map_Kd a.png", Vec3::ONE),
        ("Kd 0 0 0\nmap_Kd a.png", Vec3::ONE),
        ("Kd 0.5\nmap_Kd a.png", half),
    ] {
        let (found, warnings) = with(statements, &[metal]);
        assert_eq!((found.albedo, found.specular), (Vec3::ZERO, specular));
        assert_eq!(found.roughness, Some(0.5));
        assert!(found.albedo_map.is_some());
        let [warning] = warnings.as_slice() else {
            panic!("{statements}: {warnings:?}");
        };
        assert!(warning.starts_with("a.mtl:") && warning.contains("does not tint"));
    }
    for (statements, overrides) in [
        ("map_Kd a.png\nPm 1", vec![]),
        ("Kd 0.5\nmap_Kd a.png\nPm 0.5", vec![]),
        (
            "Kd 0.5\nmap_Kd a.png\nPm 0.5",
            vec!["material.m.roughness=0.2"],
        ),
        (
            "map_Kd a.png",
            vec![
                "material.m.albedo=[0, 0, 0]",
                "material.m.specular=[1, 0.8, 0.5]",
            ],
        ),
    ] {
        assert_eq!(with(statements, &overrides).1.len(), 1, "{statements}");
    }
    // Of anything else it is the diffuse part's alone, as it should be.
    let (plastic, warnings) = with("map_Kd a.png", &["material.m.brdf=plastic"]);
    assert_eq!(
        (plastic.albedo, plastic.specular),
        (Vec3::ONE, Vec3::splat(0.04))
    );
    assert_eq!(warnings, [""; 0]);
    for (statements, overrides) in [
        ("map_Kd a.png\nPm 0", vec![]),
        ("Kd 0.5\nKs 0.5\nmap_Kd a.png", vec![]),
        ("Kd 0.5\nmap_Kd a.png\nPm 1", vec!["material.m.brdf=matte"]),
        ("Kd 0.5\nmap_Kd none.png\nPm 1", vec![]),
    ] {
        let warnings = with(statements, &overrides).1;
        let tells = |it: &String| it.contains("does not tint");
        assert!(!warnings.iter().any(tells), "{statements}: {warnings:?}");
    }
}

#[test]
fn files_that_are_not_there_are_counted_where_they_are_used() {
    let faces = format!("usemtl a\n{MAPPED}usemtl b\n{MAPPED}");
    let mtl = "newmtl a\nmap_Kd lost.png\nnewmtl b\nmap_Kd lost.png\nmap_Ke lost too.png\n\
               newmtl unused\nmap_Kd nowhere.png\n";
    let scene = load(&faces, mtl, &[]).unwrap();
    assert_eq!(scene.warnings.len(), 2, "{:?}", scene.warnings);
    let [albedo, emission] = [&scene.warnings[0], &scene.warnings[1]];
    assert!(
        albedo.starts_with("a.mtl:2: cannot read the texture lost.png ("),
        "{albedo}"
    );
    assert!(albedo.ends_with("Kd alone (2 in all, the first one here)"));
    assert!(
        emission.starts_with("a.mtl:5: cannot read the texture lost too.png ("),
        "{emission}"
    );
}

#[test]
fn triangles_without_texture_coordinates_are_drawn_without_texture() {
    let scene = load("usemtl m\nf 1 2 3\n", "newmtl m\nmap_Kd no file.png\n", &[]).unwrap();
    assert_eq!(scene.materials.len(), 1);
    assert_eq!(scene.materials[0].albedo, Vec3::splat(0.8));
    assert_eq!(
        scene.warnings,
        [
            "a.mtl:2: material \"m\" has a texture, but triangles without texture coordinates; \
             these are drawn without it"
        ],
        "a map that nothing needs is not looked for"
    );
    let faces = format!("usemtl m\n{MAPPED}f 1 2 3\n");
    let scene = load(&faces, "newmtl m\nmap_Kd a.png\n", &[]).unwrap();
    let drawn =
        |triangle: usize| &scene.materials[scene.mesh.triangles[triangle].material as usize];
    assert!(drawn(0).albedo_map.is_some() && drawn(1).albedo_map.is_none());
    assert_eq!(
        (drawn(0).albedo, drawn(1).albedo),
        (Vec3::ONE, Vec3::splat(0.8))
    );
    assert_eq!(drawn(1).name, "m");
    assert_eq!(scene.warnings.len(), 1);
}

#[test]
fn an_option_that_is_not_obeyed_is_said() {
    let (_, warnings) = material("map_Kd -mm 0 0.5 a.png\nmap_Ke -imfchan r a.png\n", &[]);
    assert_eq!(
        warnings,
        [
            "a.mtl:2: an option of a texture is not obeyed (only -s, -o and -clamp are) \
             (2 in all, the first one here)"
        ]
    );
}

#[test]
fn a_file_that_is_no_image_is_an_error_with_its_name_and_place() {
    let faces = format!("usemtl m\n{MAPPED}");
    let error = load(&faces, "newmtl m\nmap_Kd a.mtl\n", &[]).unwrap_err();
    assert!(error.is_io());
    let message = error.to_string();
    assert!(message.starts_with("a.mtl:2: a.mtl: "), "{message}");
}
