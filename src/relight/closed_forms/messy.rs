//! Files as other programs write them, and meshes that no one would draw: the
//! picture of the clean file, or at least a finite one.

use glam::Vec3;

use crate::bake::RunSettings;
use crate::frame::Image;
use crate::relight::{FrameSettings, Renderer};
use crate::scene::Scene;
use crate::scene::sample_scenes::{scene_of_files, tga};

const SCENE: &str = r#"
mesh = "MESH"
[camera]
position = [0.3, 0.2, 1.8]
target = [0.0, -0.1, 0.0]
vfov = 80.0
size = [48, 32]
[[light]]
kind = "point"
position = [0.3, 0.6, 0.4]
intensity = [1.0, 1.0, 1.0]
[bake]
max_edge = 0.4
rays = 64
"#;

/// An open box around the origin, its front towards +z missing, and a pyramid.
const CLEAN: &str = "mtllib plain.mtl
v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1
v -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
v -0.4 -0.9 -0.4\nv 0.2 -0.9 -0.5\nv 0.3 -0.9 0.1\nv -0.1 -0.9 0.4\nv -0.5 -0.9 0.1\nv 0 0.1 0
vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1
usemtl wall
f 1/1 2/2 3/3\nf 1/1 3/3 4/4
f 1/1 5/2 6/3\nf 1/1 6/3 2/4
f 4/1 3/2 7/3\nf 4/1 7/3 8/4
f 1/1 4/2 8/3\nf 1/1 8/3 5/4
f 2/1 6/2 7/3\nf 2/1 7/3 3/4
usemtl thing
f 9 10 11\nf 9 11 12\nf 9 12 13
f 9 14 10\nf 10 14 11\nf 11 14 12\nf 12 14 13\nf 13 14 9
";
const CLEAN_MTL: &str = "newmtl wall\nmap_Kd checks.tga\nnewmtl thing\nKd 0.6 0.6 0.6\n";

/// The same mesh: a folder and names with spaces, quads and a pentagon, negative
/// and mixed indices, CRLF, tabs, continued lines, comments, statements that no
/// renderer knows, points and lines, corners that no face uses, texture options.
const MESSY: &str = "# exported by hand\r\n
mtllib my materials.mtl\r
o the room # its name\r
v\t-1 -1 -1\r\nv 1 -1 -1 1 0 0\r\nv 1 1 -1\r\nv -1 1 -1\r
v -1.0 -1e0 1\r\nv 1 -1 1.\r\nv 1 1 1\r\nv -1 1 1\r
v -0.4 -0.9 -0.4\r\nv 0.2 -0.9 -0.5\r\nv 0.3 -0.9 0.1\r\nv -0.1 -0.9 0.4\r\nv -0.5 -0.9 0.1\r\nv 0 0.1 0\r
v 1000 2000 -3000\r\nv 1e9 0 0\r
vt 0 0\r\nvt 1 0\r\nvt 1 1\r\nvt 0 1 0\r
g walls front\r\ns off\r\nshadow_obj none.obj\r\nlod 1\r\nctech cparm 0.5\r
usemtl a white wall\r
f -16/-4 -15/-3 -14/-2 -13/-1\r
f 1/1 5/2 \\\r
 6/3 2/4\r
f 4/1 3/2 7/3 -9/4   # the ceiling\r
f 1/1 4/2 8/3 5/4\r
f 2/1 6/2 7/3 3/4\r
p 1\r\nl 1 2 3\r
usemtl thing\r
s 1\r
f 9 10 11 12 13\r
f 9// 14// 10//\r\nf 10 14 11\r\nf 11 14 12\r\nf 12 14 13\r\nf 13 14 9\r
";
const MESSY_MTL: &str = "# materials\r\nnewmtl a white wall\r\nillum 2\r\nNi 1.45\r\nd 1\r
map_Kd -s 1 1 1 -o 0 0 0 -blendu on -texres 256 textures\\my checks.tga\r
newmtl thing\r\nKd\t0.6 0.6 0.6\r\nTf 1 1 1\r\nunheard_of 3\r\n";

/// Faces that have no meaning or too much of it, for the end of the clean file:
/// of no area, twice, turned over, a third and a fourth one on an edge, one that
/// is a needle, corners that are no numbers or beyond the list, and a corner far
/// away that no face uses.
const ODD_FACES: &str = "v nan 0 0\nv 0 inf 0\nv 1e30 0 0\nv 0.9 0.2 0.5\nv 0.9 0.2000001 0.5
usemtl thing
f 9 9 10\nf 9 14 9\nf 1 2 2
f 9 14 10\nf 14 10 9\nf 10 14 9
f 9 14 3\nf 9 14 7
f 9 14 18\nf 1 18 19
f 1 2 15\nf 1 2 16\nf 1 2 99
";

fn scene(mesh: &str, files: &[(&str, &str)]) -> Scene {
    let toml = SCENE.replace("MESH", mesh);
    let checks = tga([4, 4], |x, y| [60 + 40 * ((x + y) % 4) as u8; 3]);
    let mut list: Vec<(&str, &[u8])> = vec![("scene.toml", toml.as_bytes())];
    list.extend(files.iter().map(|(name, text)| (*name, text.as_bytes())));
    list.push(("checks.tga", &checks));
    list.push(("models/textures/my checks.tga", &checks));
    scene_of_files(&list)
}

fn clean_scene(obj: &str) -> Scene {
    scene("plain.obj", &[("plain.obj", obj), ("plain.mtl", CLEAN_MTL)])
}

/// The picture, every value of which is finite, and what is said of the mesh.
fn picture(scene: Scene) -> (Image, Vec<String>) {
    let settings = FrameSettings::of_scene(&scene);
    let mut warnings = scene.warnings.clone();
    let mut renderer = Renderer::new(scene, None);
    let frame = renderer.frame(&settings, &RunSettings::silent()).unwrap();
    warnings.extend(renderer.take_warnings());
    let is_light = |p: &&Vec3| p.is_finite() && p.min_element() >= 0.0;
    let pixels = frame.image.pixels();
    let good = pixels.iter().filter(is_light).count();
    assert_eq!(good, pixels.len(), "pixels that are light");
    let lit = pixels.iter().filter(|p| p.x > 0.0).count();
    assert!(lit * 2 > pixels.len(), "{lit} pixels are lit");
    (frame.image, warnings)
}

#[test]
fn a_messy_file_is_the_picture_of_a_clean_one() {
    let (clean, warnings) = picture(clean_scene(CLEAN));
    assert_eq!(warnings, [""; 0], "the clean file is clean");
    let files = [
        ("models/messy.obj", MESSY),
        ("models/my materials.mtl", MESSY_MTL),
    ];
    let (messy, warnings) = picture(scene("models/messy.obj", &files));
    assert!(messy == clean, "another picture; {warnings:#?}");
}

#[test]
fn faces_without_meaning_leave_a_finite_picture() {
    let text = format!("{CLEAN}{ODD_FACES}");
    let line = |start: &str| text.lines().position(|l| l == start).map(|index| index + 1);
    let (_, warnings) = picture(clean_scene(&text));
    for (first, what) in [
        ("f 9 9 10", "triangle of zero area"),
        ("f 1 2 15", "NaN, infinite"),
        ("f 1 2 99", "beyond the vertices"),
    ] {
        let line = line(first).expect("the face is in the file");
        let place = format!("plain.obj:{line}: ");
        let said = warnings
            .iter()
            .any(|w| w.starts_with(&place) && w.contains(what));
        assert!(said, "no warning of {what} at line {line}: {warnings:#?}");
    }
    let doubles = warnings.iter().any(|w| w.contains("corners of an earlier"));
    assert!(doubles, "no warning of doubled triangles: {warnings:#?}");
}

#[test]
fn doubled_and_flat_faces_change_no_pixel() {
    let (clean, _) = picture(clean_scene(CLEAN));
    for more in [
        "f 9 14 10\nf 9 10 11\n",
        "f 9 9 10\nf 9 14 9\n",
        "v 1e9 0 0\n",
    ] {
        let (image, _) = picture(clean_scene(&format!("{CLEAN}{more}")));
        assert!(image == clean, "{more:?} changes the picture");
    }
}
