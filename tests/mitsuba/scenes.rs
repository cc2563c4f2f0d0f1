//! Scenes for the comparison that `scenes/` does not hold: emitters, rectangles,
//! skies and textures. Written into a folder, with the box of `scenes/cornell`
//! where it serves.

use std::fs;
use std::path::{Path, PathBuf};

use image::codecs::hdr::HdrEncoder;
use image::{Rgb, Rgb32FImage, RgbImage};

/// The repository's box, open towards +z: x and z from -1 to 1, y from 0 to 2.
const BOX_OBJ: &str = include_str!("../../scenes/cornell/cornell.obj");
const BOX_MTL: &str = include_str!("../../scenes/cornell/cornell.mtl");

const BOX_CAMERA: &str = "[camera]
position = [0.0, 1.0, 6.8]
target = [0.0, 1.0, 0.0]
vfov = 19.5
size = [640, 480]
";

/// From the right of the yard, the horizon and the sky in the picture.
const YARD_CAMERA: &str = "[camera]
position = [3.4, 2.4, 7.5]
target = [0.0, 1.0, 0.0]
vfov = 34.0
size = [640, 480]
";

/// A lamp below the ceiling, seen from below, and a panel that shines at the red
/// wall and shows the camera its back. The lamp stands cornerwise: along rows of
/// pixels the 16 samples of a pixel round the share that a lamp covers the same
/// way all along an edge, which alone is 0.4 % of this picture's mean.
const EMITTERS_OBJ: &str = "o lamps
v 0 1.97 -0.52
v 0.42 1.97 -0.1
v 0 1.97 0.32
v -0.42 1.97 -0.1
usemtl lamp
f -4 -3 -2 -1
v -0.45 1.30 0.60
v -0.75 1.30 0.10
v -0.75 1.70 0.10
v -0.45 1.70 0.60
usemtl panel
f -4 -1 -2 -3
";
const EMITTERS_MTL: &str = "newmtl lamp
Kd 0.78 0.78 0.78
Ke 5.0 4.0 2.5
newmtl panel
Kd 0.4 0.5 0.6
Ke 0.6 1.2 2.4
";

/// A lamp that shines down, seen from below, and a sheared panel that shines
/// into the box and shows the camera its black back. Both are in front of the
/// box, where light that leaves it is lost anyway: relume's bounced light passes
/// through rectangles, and the same lamp just below the ceiling, which it darkens
/// in Mitsuba, makes 0.8 % of the mean.
const RECTANGLES: &str = "[[light]]
kind = \"area\"
corner = [0.0, 1.85, 1.05]
edge_u = [0.42, 0.0, 0.42]
edge_v = [-0.42, 0.0, 0.42]
radiance = [5.0, 4.0, 2.5]

[[light]]
kind = \"area\"
corner = [0.35, 0.1, 1.25]
edge_u = [0.1, 0.4, 0.0]
edge_v = [0.4, 0.0, 0.1]
radiance = [1.0, 2.0, 4.0]
";

/// Ground all around the box, and a block that throws its shadow on it.
const YARD_OBJ: &str = "o ground
v -4 0 1
v 4 0 1
v 4 0 4
v -4 0 4
v -4 0 -4
v -1 0 -4
v -1 0 1
v -1 0 -1
v 1 0 -4
v 1 0 -1
v 4 0 -4
v 1 0 1
usemtl ground
f -12 -9 -10 -11
f -8 -12 -6 -7
f -7 -5 -3 -4
f -4 -1 -11 -2
o block
v -2.4 0 1.4
v -1.6 0 1.4
v -1.6 0 2.2
v -2.4 0 2.2
v -2.4 1 1.4
v -1.6 1 1.4
v -1.6 1 2.2
v -2.4 1 2.2
usemtl white
f -4 -1 -2 -3
f -8 -4 -3 -7
f -7 -3 -2 -6
f -6 -2 -1 -5
f -5 -1 -4 -8
";
const YARD_MTL: &str = "newmtl ground
Kd 0.35 0.4 0.25
";

const SUN_AND_SKY: &str = "[[light]]
kind = \"directional\"
direction = [-0.5, -0.8, -1.0]
irradiance = [3.0, 2.8, 2.4]

[[light]]
kind = \"environment\"
radiance = [0.3, 0.4, 0.6]
";

const MAPPED_SKY: &str = "[[light]]
kind = \"environment\"
map = \"sky.hdr\"
scale = 1.5
rotation = 25.0
";

/// A floor, a back wall and a low step, all with images: repeated beyond 0..1
/// with a factor, once alone (`Kd 0 0 0`), and scaled and moved by the statement.
const TEXTURED_OBJ: &str = "mtllib textured.mtl
o room
v -1 0 -1
v -1 0 1
v 1 0 1
v 1 0 -1
v -1 2 -1
v 1 2 -1
vt -0.6 -0.3
vt 1.7 2.4
usemtl floor
vt -0.6 2.4
vt 1.7 -0.3
f 1/-2 2/-4 3/-1 4/-3
usemtl wall
vt 0 0
vt 1 0
vt 1 1
vt 0 1
f 1/-4 4/-3 6/-2 5/-1
o step
v 0.1 0.5 -0.6
v 0.1 0.5 0.3
v 0.8 0.5 0.3
v 0.8 0.5 -0.6
v 0.1 0 0.3
v 0.8 0 0.3
vt 0 0
vt 1 0
vt 1 1
vt 0 1
usemtl step
f -6/-1 -5/-4 -4/-3 -3/-2
f -5/-1 -2/-4 -1/-3 -4/-2
";
const TEXTURED_MTL: &str = "newmtl floor
Kd 0.9 0.8 0.6
map_Kd texture.png
newmtl wall
Kd 0 0 0
map_Kd texture.png
newmtl step
Kd 0.8 0.8 0.8
map_Kd -s 1.5 2 1 -o 0.25 0.1 0 texture.png
";
const TEXTURED_LIGHT: &str = "[[light]]
kind = \"point\"
position = [-0.2, 1.5, 0.6]
intensity = [3.0, 3.0, 3.0]
";

/// Size of the image: few texels, so that the picture shows how they are
/// interpolated.
const TEXTURE_SIZE: [u32; 2] = [8, 6];
/// Columns and rows of the sky.
const SKY_SIZE: [u32; 2] = [64, 32];

/// Writes all scenes into a folder; name and scene file of each.
pub(crate) fn write_all(folder: &Path) -> Vec<(&'static str, PathBuf)> {
    let emitters = [BOX_OBJ, EMITTERS_OBJ].concat();
    write(folder, "emitters.obj", &using(&emitters, "emitters.mtl"));
    write(folder, "emitters.mtl", &[BOX_MTL, EMITTERS_MTL].concat());
    write(folder, "cornell.obj", BOX_OBJ);
    write(folder, "cornell.mtl", BOX_MTL);
    let yard = [BOX_OBJ, YARD_OBJ].concat();
    write(folder, "yard.obj", &using(&yard, "yard.mtl"));
    write(folder, "yard.mtl", &[BOX_MTL, YARD_MTL].concat());
    write(folder, "textured.obj", TEXTURED_OBJ);
    write(folder, "textured.mtl", TEXTURED_MTL);
    texture()
        .save(folder.join("texture.png"))
        .expect("the folder can be written");
    write_hdr(&folder.join("sky.hdr"), &sky());

    [
        ("emitters", "emitters.obj", BOX_CAMERA, ""),
        ("rectangles", "cornell.obj", BOX_CAMERA, RECTANGLES),
        ("sun and sky", "yard.obj", YARD_CAMERA, SUN_AND_SKY),
        ("mapped sky", "yard.obj", YARD_CAMERA, MAPPED_SKY),
        ("textures", "textured.obj", BOX_CAMERA, TEXTURED_LIGHT),
    ]
    .map(|(name, mesh, camera, lights)| {
        let file = format!("{}.toml", name.replace(' ', "_"));
        let text = format!("mesh = \"{mesh}\"\n\n{camera}\n{lights}");
        write(folder, &file, &text);
        (name, folder.join(file))
    })
    .into()
}

/// The box's OBJ with another MTL file.
fn using(obj: &str, mtl: &str) -> String {
    obj.replace("cornell.mtl", mtl)
}

/// Like no mirror image of itself, in the middle tones where sRGB matters most.
fn texture() -> RgbImage {
    let [width, height] = TEXTURE_SIZE;
    RgbImage::from_fn(width, height, |x, y| {
        let checker = if (x + y) % 2 == 0 { 60 } else { 0 };
        Rgb([
            (40 + checker + 18 * x) as u8,
            (40 + checker + 25 * y) as u8,
            (60 + checker + (13 * x * y) % 90) as u8,
        ])
    })
}

/// Above the horizon one quadrant of azimuth is bright (u from 1/4 to 1/2: +x to
/// +z) and the others have a colour each; below all is dark blue.
fn sky() -> Rgb32FImage {
    let [width, height] = SKY_SIZE;
    Rgb32FImage::from_fn(width, height, |x, y| {
        let quadrant = 4 * x / width;
        if 2 * y >= height {
            return Rgb([0.02, 0.03, 0.08]);
        }
        match quadrant {
            1 => Rgb([2.0, 1.75, 1.5]),
            2 => Rgb([0.125, 0.5, 0.0625]),
            3 => Rgb([0.5, 0.125, 0.0625]),
            _ => Rgb([0.125, 0.25, 0.375]),
        }
    })
}

fn write(folder: &Path, file: &str, text: &str) {
    fs::write(folder.join(file), text).expect("the folder can be written");
}

fn write_hdr(path: &Path, image: &Rgb32FImage) {
    let pixels: Vec<Rgb<f32>> = image.pixels().copied().collect();
    let file = fs::File::create(path).expect("the folder can be written");
    HdrEncoder::new(file)
        .encode(&pixels, image.width() as usize, image.height() as usize)
        .expect("the folder can be written");
}
