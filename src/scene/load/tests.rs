//! Scenes as a whole, from files in memory.

use std::path::Path;

use glam::{DVec3, Vec3};

use super::super::files::{Files, Memory};
use super::super::{LightKind, Override, Radiance, Scene, SceneError, sample_images};
use crate::maths::hash::hash3;

const HEAD: &str = "mesh = \"a.obj\"\n[camera]\nposition = [0, 1, 5]\ntarget = [0, 1, 0]\n\
                    vfov = 40\nsize = [64, 48]\n";
const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 2\nvt 0 0\n\
                   usemtl floor\nf 1/1/1 2/1/1 3/1/1 4/1/1\nusemtl wall\nf -4//-1 -3//-1 -2//-1\n";
const MTL: &str =
    "newmtl floor\nKd 0.5 0.25 1\nmap_Kd -s 1 1 1 my wood.png\nnewmtl wall\nKd 0.3 0.3 0.3\n";

fn load_files(files: &[(&str, &[u8])], overrides: &[&str]) -> Result<Scene, SceneError> {
    let files = Memory::of(files);
    let overrides: Result<Vec<_>, _> = overrides.iter().map(|o| Override::parse(o)).collect();
    let path = Path::new("dir/s.toml");
    Scene::load_with(&files.read(path).unwrap(), path, &overrides?, &files)
}

fn load(toml: &str, overrides: &[&str]) -> Result<Scene, SceneError> {
    let files: [(&str, &[u8]); 5] = [
        ("dir/s.toml", toml.as_bytes()),
        ("dir/a.obj", OBJ.as_bytes()),
        ("dir/a.mtl", MTL.as_bytes()),
        ("dir/my wood.png", sample_images::PNG),
        ("dir/sky.hdr", sample_images::HDR),
    ];
    load_files(&files, overrides)
}

fn error(toml: &str, overrides: &[&str]) -> String {
    load(toml, overrides).unwrap_err().to_string()
}

#[test]
fn a_scene_with_its_materials() {
    let scene = load(HEAD, &[]).unwrap();
    assert_eq!(scene.mesh.triangles.len(), 3);
    assert_eq!(scene.materials.len(), 2);
    assert_eq!(scene.materials[0].albedo, Vec3::new(0.5, 0.25, 1.0));
    let map = scene.materials[0].albedo_map.as_ref().unwrap();
    assert_eq!(map.texture.path(), Path::new("dir/my wood.png"));
    assert_eq!(scene.camera.up, DVec3::Y);
    assert_eq!(
        scene.mesh.bounds(),
        (DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0))
    );
    assert_eq!(scene.placement().extent, 1.0);
    assert_eq!(scene.warnings, [""; 0]);
}

#[test]
fn missing_files() {
    let missing_scene = Scene::load(Path::new("no/s.toml"), &[]).unwrap_err();
    assert!(missing_scene.is_io());
    assert!(missing_scene.to_string().contains("no/s.toml"));
    let missing_mesh = load(&HEAD.replace("a.obj", "b.obj"), &[]).unwrap_err();
    assert!(missing_mesh.is_io());
    assert!(
        missing_mesh
            .to_string()
            .starts_with("dir/s.toml:1:8: cannot read dir/b.obj"),
        "{missing_mesh}"
    );
    assert!(!load("mesh = 3", &[]).unwrap_err().is_io());
}

#[test]
fn files_on_disk_are_found_beside_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    write("s.toml", &HEAD.replace("a.obj", "sub/a.obj"));
    write("sub/a.obj", OBJ);
    write("sub/a.mtl", MTL);
    std::fs::write(folder.path().join("sub/my wood.png"), sample_images::PNG).unwrap();
    let scene = Scene::load(&folder.path().join("s.toml"), &[]).unwrap();
    let map = scene.materials[0].albedo_map.as_ref().unwrap();
    assert_eq!(map.texture.path(), folder.path().join("sub/my wood.png"));
    assert!(Scene::load(folder.path(), &[]).unwrap_err().is_io());
}

#[test]
fn materials_are_overridden_by_name() {
    let toml =
        format!("{HEAD}[[material]]\nname = \"wall\"\nalbedo = [1, 0, 0]\nroughness = 0.5\n");
    let scene = load(&toml, &[]).unwrap();
    assert_eq!(scene.materials[1].albedo, Vec3::X);
    assert_eq!(scene.materials[1].roughness, Some(0.5));
    let scene = load(&toml, &["material.wall.albedo=[0, 1, 0]"]).unwrap();
    assert_eq!(scene.materials[1].albedo, Vec3::Y);
    let scene = load(HEAD, &["material.floor.emission=[1, 2, 3]"]).unwrap();
    assert_eq!(scene.materials[0].emission, Vec3::new(1.0, 2.0, 3.0));
    let scene = load(HEAD, &["material.floor.specular=[1, 1, 1]"]).unwrap();
    let gloss = scene.materials[0].gloss().unwrap();
    assert_eq!((gloss.specular, gloss.roughness), (Vec3::ONE, 1.0));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn kinds_of_surfaces_are_set_by_name() {
    let named = |brdf: &str| {
        format!(
            "{HEAD}[[material]]\nname = \"wall\"\nalbedo = [0.5, 0.2, 0.1]\nbrdf = \"{brdf}\"\n"
        )
    };
    let metal = load(&named("brushed metal"), &[]).unwrap();
    assert_eq!(metal.materials[1].albedo, Vec3::ZERO);
    assert_eq!(metal.materials[1].specular, Vec3::new(0.5, 0.2, 0.1));
    let finer = load(&named("plastic"), &["material.wall.roughness=0.1"]).unwrap();
    assert_eq!(finer.materials[1].gloss().unwrap().roughness, 0.1);
    let message = error(&named("brused metal"), &[]);
    assert!(message.contains("brushed metal"), "{message}");
}

#[test]
fn unknown_materials_are_errors_with_the_nearest_name() {
    let toml = format!("{HEAD}[[material]]\nname = \"flor\"\n");
    let message = error(&toml, &[]);
    assert!(message.starts_with("dir/s.toml:8:8: "), "{message}");
    assert!(message.contains("the nearest is `floor`"), "{message}");
    let message = error(HEAD, &["material.wal.albedo=[1, 1, 1]"]);
    assert!(
        message.starts_with("--set material.wal.albedo: ") && message.contains("`wall`"),
        "{message}"
    );
    let animated =
        "[[animate]]\ntarget = \"material.wal.albedo\"\nframes = [0]\nvalues = [[1, 1, 1]]\n";
    let message = error(&format!("{HEAD}{animated}"), &[]);
    assert!(
        message.starts_with("dir/s.toml:8:10: ") && message.contains("`wall`"),
        "{message}"
    );
}

#[test]
fn what_is_not_rendered_yet_is_said_once_a_kind() {
    let toml = format!(
        "{HEAD}[bake]\nerror = 0.1\nfixed_albedo = true\n\
         [[light]]\nname = \"sky\"\nkind = \"environment\"\nradiance = [1, 1, 1]\n\
         [[light]]\nkind = \"environment\"\nmap = \"sky.hdr\"\n\
         [[light]]\nname = \"p\"\nkind = \"point\"\nposition = [0, 0, 0]\nintensity = [1, 1, 1]\n\
         [[animate]]\ntarget = \"light.p.position\"\nframes = [0, 1.5]\nvalues = [[0, 0, 0], [1, 0, 0]]\n"
    );
    let scene = load(&toml, &[]).unwrap();
    assert_eq!(
        scene.warnings[..1],
        ["dir/s.toml:22: [[animate]] of light.p.position is not rendered yet",]
    );
    assert_eq!(scene.bake.error, Some(0.1));
    let LightKind::Environment(sky) = &scene.lights[1].kind else {
        panic!("the second light is an environment")
    };
    let Radiance::Map(image) = &sky.radiance else {
        panic!("a map")
    };
    assert_eq!(image.path(), Path::new("dir/sky.hdr"));
    assert_eq!(scene.animations[0].frames, [0.0, 1.5]);
    assert_eq!(scene.animations[0].values[1], [1.0, 0.0, 0.0]);
}

/// Copies of `bytes` that are cut short or have some bytes changed.
fn damaged(bytes: &[u8], seed: u32) -> Vec<u8> {
    let mut copy = bytes.to_vec();
    let below = |dimension: u32, count: usize| hash3(seed, 1, dimension) as usize % count.max(1);
    if seed.is_multiple_of(3) {
        copy.truncate(below(0, bytes.len()));
    }
    let replacements = b"\0\n\r\t #/-.0e9[]{}=\"'\\\xff\xc3aNf";
    for change in 0..seed % 7 {
        if copy.is_empty() {
            break;
        }
        let at = below(3 * change + 1, copy.len());
        copy[at] = replacements[below(3 * change + 2, replacements.len())];
        if below(3 * change + 3, 5) == 0 {
            copy.remove(at);
        }
    }
    copy
}

#[test]
fn damaged_files_never_panic() {
    let toml = format!(
        "{HEAD}up = [0, 1, 0]\n[render]\nbounces = \"all\"\nexposure = -1.5\n[bake]\nrays = 64\n\
         [[light]]\nname = \"lamp\"\nkind = \"spot\"\nposition = [0, 1, 2]\ntarget = [0, 0, 0]\n\
         intensity = [1, 1, 1]\ncutoff = 20\n[[material]]\nname = \"wall\"\nalbedo = [0.1, 0.2, 1]\n\
         [[animate]]\ntarget = \"light.lamp.cutoff\"\nframes = [0, 1]\nvalues = [10, 25]\n\
         [golden]\nmax_differing_pixels = \"1%\"\n"
    );
    assert!(load(&toml, &[]).is_ok(), "the undamaged scene loads");
    let whole: [&[u8]; 3] = [toml.as_bytes(), OBJ.as_bytes(), MTL.as_bytes()];
    let mut loaded = 0;
    for seed in 0..6000 {
        let mut files = whole.map(<[u8]>::to_vec);
        let hit = seed as usize % 3;
        files[hit] = damaged(whole[hit], seed / 3);
        let named = [
            ("dir/s.toml", files[0].as_slice()),
            ("dir/a.obj", files[1].as_slice()),
            ("dir/a.mtl", files[2].as_slice()),
        ];
        loaded += usize::from(load_files(&named, &[]).is_ok());
        let text =
            String::from_utf8_lossy(&damaged(b"light.lamp.position=[0, 1, 2]", seed)).into_owned();
        if let Ok(set) = Override::parse(&text) {
            drop(load(&toml, &[]).map(|_| set));
        }
    }
    assert!((600..5400).contains(&loaded), "{loaded} of 6000 load");
}
