//! OBJ and MTL texts, good and bad.

use std::path::Path;

use glam::{DVec2, DVec3, Vec3};

use super::{Loaded, load};
use crate::scene::files::{Finder, Memory};
use crate::scene::{Normals, SceneError};

/// A square in the plane z = 0 and a corner above it.
const VERTICES: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1\n";

fn load_as(obj: &str, mtl: Option<&str>, normals: Normals) -> Result<Loaded, SceneError> {
    let mtl = mtl.map(|text| ("a b.mtl", text.as_bytes()));
    let files = Memory::of(mtl.as_slice());
    load(
        obj.as_bytes(),
        Path::new("a.obj"),
        normals,
        &Finder::new(&files),
    )
}

fn mesh(obj: &str) -> Loaded {
    load_as(&format!("{VERTICES}{obj}"), None, Normals::File).unwrap()
}

fn materials(mtl: &str) -> Loaded {
    let obj = format!("mtllib a b.mtl\n{VERTICES}f 1 2 3");
    load_as(&obj, Some(mtl), Normals::File).unwrap()
}

/// Positions of the corners of every triangle.
fn corners(loaded: &Loaded) -> Vec<[DVec3; 3]> {
    let triangles = loaded.mesh.triangles.iter();
    triangles
        .map(|t| t.corners.map(|c| loaded.mesh.positions[c as usize]))
        .collect()
}

#[test]
fn polygons_are_fans_from_the_first_corner() {
    let loaded = mesh("v 0.5 2 0\nf 2 3 6 4 1\n");
    let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    assert_eq!(
        corners(&loaded),
        [
            [at(1.0, 0.0), at(1.0, 1.0), at(0.5, 2.0)],
            [at(1.0, 0.0), at(0.5, 2.0), at(0.0, 1.0)],
            [at(1.0, 0.0), at(0.0, 1.0), at(0.0, 0.0)],
        ]
    );
    assert_eq!(
        corners(&mesh("f 1 2 3 4"))[1],
        [at(0.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]
    );
}

#[test]
fn indices_may_be_negative_or_point_ahead() {
    assert_eq!(corners(&mesh("f -5 -4 -3")), corners(&mesh("f 1 2 3")));
    let ahead = load_as(&format!("f 1 2 3\n{VERTICES}"), None, Normals::File).unwrap();
    assert_eq!(corners(&ahead), corners(&mesh("f 1 2 3")));
    let counted_above = mesh("f -5 -4 -3\nv 9 9 9\n");
    assert_eq!(corners(&counted_above), corners(&mesh("f 1 2 3")));
}

#[test]
fn odd_spellings_mean_the_same() {
    let plain = corners(&mesh("f 1 2 3"));
    for text in [
        "\tf  1\t2 3  # a comment\r\n",
        "g a name\no another\ns off\nf 1/ 2// 3\n",
        "f 1 \\\n 2 3\n",
        "f 1 2 3\\",
        "f 1 2 3# a comment\n",
        "# C:\\models\\\nf 1 2 3\n",
        "p 1 2\nl 1 2 3\nf 1 2 3",
        "usemtl\nf 1 2 3",
    ] {
        assert_eq!(corners(&mesh(text)), plain, "{text:?}");
    }
    let coloured = "v 0 0 0 1 0 0\nv 1 0 0 0 1\nv 1 1 0 2\nf 1 2 3\n";
    let coloured = load_as(coloured, None, Normals::File).unwrap();
    assert_eq!(
        corners(&coloured),
        plain,
        "colours and weights are left out"
    );
}

#[test]
fn broken_faces_are_dropped_with_one_warning_a_kind() {
    let loaded = mesh(
        "v nan 0 0\nv 1.#INF 0 0\nv 1e31 0 0\nf 1 2 3\nf 0 1 2\nf 1 2 99\nf -99 1 2\n\
         f 1 2 6\nf 1 2 7\nf 1 2 8\nf 1 2\nf 1\nf\nf 1 1 2\nf 1 2 3\nf 1 99999999999999999999 2\n",
    );
    assert_eq!(loaded.mesh.triangles.len(), 2, "a repeated triangle stays");
    assert_eq!(
        loaded.warnings,
        [
            "a.obj:10: dropped a face with a corner index of 0 or beyond the vertices (4 in all, the first one here)",
            "a.obj:13: dropped a face with a corner that is NaN, infinite or beyond 1e30 (3 in all, the first one here)",
            "a.obj:16: dropped a face with fewer than three corners (3 in all, the first one here)",
            "a.obj:19: dropped a triangle of zero area",
        ]
    );
}

#[test]
fn statements_that_make_no_sense_are_errors_with_a_line() {
    for (text, what) in [
        ("v 1 2\n", "it needs 3 numbers"),
        ("v 1 2 x\n", "`v 1 2 x`"),
        ("vn 1,5 2 3\n", "it needs 3 numbers"),
        ("vt\n", "it needs 1 numbers"),
        ("f 1 2 c\n", "\"c\" is no corner"),
        ("f 1 2 3/1/1/1\n", "is no corner"),
        ("f 1 2 /3\n", "is no corner"),
    ] {
        let error = load_as(&format!("{VERTICES}{text}"), None, Normals::File).unwrap_err();
        let message = error.to_string();
        assert!(
            message.starts_with("a.obj:6: ") && message.contains(what),
            "{message}"
        );
        assert!(!error.is_io());
    }
}

#[test]
fn a_mesh_without_triangles_is_an_error() {
    for (text, what) in [
        ("", "no face"),
        ("p 1 2 3\nl 1 2", "no face"),
        ("f 1 1 2", "zero area"),
        ("f 1 2 9", "beyond the vertices"),
    ] {
        let error = load_as(&format!("{VERTICES}{text}"), None, Normals::File).unwrap_err();
        assert!(error.to_string().contains(what), "{error}");
    }
    let junk = load(
        b"\x89PNG\r\n\x1a\n\0\0",
        Path::new("a.obj"),
        Normals::File,
        &Finder::new(&Memory::default()),
    );
    assert!(junk.unwrap_err().to_string().contains("no text"));
}

#[test]
fn file_normals_where_all_corners_have_one() {
    let vertices = "vn 0 0 3\nvn 0 4e-200 3e-200\nvn 0 0 0\nvn nan 0 0\n";
    let faces = "f 1//1 2//2 3//1\nf 1//1 2 3//1\nf 1 2 3\nf 1//3 2//1 3//1\nf 1//4 2//1 3//1\nf 1//9 2//1 3//1\n";
    let loaded = mesh(&format!("{vertices}{faces}"));
    let normals = |index: usize| {
        let normals = loaded.mesh.triangles[index].normals;
        normals.map(|n| n.map(|n| loaded.mesh.normals[n as usize]))
    };
    assert_eq!(
        normals(0),
        Some([DVec3::Z, DVec3::new(0.0, 0.8, 0.6), DVec3::Z])
    );
    assert!((1..6).all(|index| normals(index).is_none()));
    assert_eq!(loaded.warnings.len(), 1);
    assert!(
        loaded.warnings[0].starts_with("a.obj:13: ") && loaded.warnings[0].contains("3 in all"),
        "{:?}",
        loaded.warnings
    );
    let flat = load_as(&format!("{VERTICES}{vertices}{faces}"), None, Normals::Flat).unwrap();
    assert!(flat.mesh.triangles.iter().all(|t| t.normals.is_none()));
    assert!(flat.warnings.is_empty() && flat.mesh.normals.is_empty());
}

#[test]
fn texture_coordinates_where_all_corners_have_one() {
    let loaded = mesh("vt 0.25\nvt 0.5 1 0\nvt nan 0\nf 1/1 2/2 3/2\nf 1/1 2 3/2\nf 1/3 2/2 3/1\n");
    let found = loaded.mesh.triangles[0].texture_coordinates.unwrap();
    let found = found.map(|t| loaded.mesh.texture_coordinates[t as usize]);
    assert_eq!(
        found,
        [
            DVec2::new(0.25, 0.0),
            DVec2::new(0.5, 1.0),
            DVec2::new(0.5, 1.0)
        ]
    );
    assert!(loaded.mesh.triangles[1].texture_coordinates.is_none());
    assert!(loaded.mesh.triangles[2].texture_coordinates.is_none());
    assert_eq!(loaded.warnings.len(), 1);
}

#[test]
fn smooth_normals_are_weighted_by_area_within_a_material() {
    // A floor of area 2 meets a wall of area 1 along x = 1; the wall's
    // vertices repeat the positions of the floor's.
    let text = "v 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0\nv 1 -0.0 0\nv 1 2 0\nv 1 2 0.5\nv 1 0 0.5\n\
                f 1 2 3\nf 1 3 4\nf 8 5 6 7\n";
    let loaded = load_as(text, None, Normals::Smooth).unwrap();
    let normal = |triangle: usize, corner: usize| {
        let normals = loaded.mesh.triangles[triangle].normals.unwrap();
        loaded.mesh.normals[normals[corner] as usize]
    };
    // At (1, 0, 0) a floor triangle of area 1 meets a wall triangle of 0.5.
    let wall = normal(2, 0);
    assert_eq!(wall.abs(), DVec3::X);
    let expected = (DVec3::Z + wall * 0.5).normalize();
    assert!(
        (normal(0, 1) - expected).length() < 1e-12,
        "{}",
        normal(0, 1)
    );
    assert_eq!(normal(0, 1), normal(2, 1));
    assert_eq!(normal(0, 0), DVec3::Z);
    let split = format!(
        "mtllib a b.mtl\nusemtl a\n{}",
        text.replace("f 8", "usemtl b\nf 8")
    );
    let split = load_as(&split, Some("newmtl a\nnewmtl b\n"), Normals::Smooth).unwrap();
    let is_flat = |n: &DVec3| n.abs().max_element() == 1.0;
    assert!(split.mesh.normals.iter().all(is_flat));
}

#[test]
fn a_sheet_with_two_sides_stays_flat_when_smooth() {
    let text = format!("{VERTICES}f 1 2 3\nf 2 1 3\n");
    let loaded = load_as(&text, None, Normals::Smooth).unwrap();
    assert!(loaded.mesh.triangles.iter().all(|t| t.normals.is_none()));
}

#[test]
fn metalness_wins_over_the_specular_colour() {
    let loaded = materials(
        "newmtl metal\nKd 0.8 0.4 0.2\nKs 0.5 0.5 0.5\nNs 250\nPr 0.3\nPm 1\n\
         newmtl half\nKd 0.8 0.4 0.2\nPm 0.5\nnewmtl mapped\nmap_Kd a.png\nPm 0.75\n\
         newmtl plastic\nKd 0.8 0.4 0.2\nKs 0.1 0.1 0.1\nPr 0.2\n",
    );
    let [metal, half, mapped, plastic] = &loaded.materials[..4] else {
        panic!("four materials")
    };
    assert_eq!(
        (metal.albedo, metal.specular),
        (Vec3::ZERO, Vec3::new(0.8, 0.4, 0.2))
    );
    assert_eq!(metal.roughness, Some(0.3));
    assert_eq!(half.albedo, Vec3::new(0.4, 0.2, 0.1));
    assert!(
        (half.specular - Vec3::new(0.42, 0.22, 0.12))
            .abs()
            .max_element()
            < 1e-6
    );
    assert_eq!(mapped.albedo, Vec3::splat(0.25), "the map counts as 1 1 1");
    assert_eq!(
        (plastic.specular, plastic.roughness),
        (Vec3::splat(0.1), Some(0.2))
    );
}

#[test]
fn material_values_have_defaults_and_limits() {
    let loaded = materials(
        "Kd 1 1 1\nnewmtl plain\nnewmtl mapped\nKd 0 0 0\nmap_Kd -o 0.1 a.png\nnewmtl only map\n\
         map_kd tex\\b.png\nnewmtl grey # not a comment\nKd 0.5\nKs 0.1 0.2 2\nNs 6\nKe 3 2 1 # red\n\
         newmtl bad\nKd -1 2 0.5\nPr 0.3\nNs 6\nnewmtl formed\nKd spectral x.rfl\nKs 1 2\n\
         newmtl plain\nKd 0 1 0\nnewmtl\nKd 0 0 1\n",
    );
    let albedo: Vec<_> = loaded.materials.iter().map(|m| m.albedo).collect();
    assert_eq!(
        albedo,
        [
            Vec3::splat(0.8),
            Vec3::splat(0.8),
            Vec3::splat(0.8),
            Vec3::splat(0.5),
            Vec3::new(0.0, 1.0, 0.5),
            Vec3::splat(0.8),
            Vec3::splat(0.8),
        ]
    );
    let names: Vec<_> = loaded.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names[2..4], ["only map", "grey # not a comment"]);
    assert_eq!(names[6], "", "triangles without usemtl");
    for (index, name) in [(1, "a.png"), (2, "tex\\b.png")] {
        let map = loaded.material_maps[index].albedo.as_ref().unwrap();
        assert_eq!((map.name.as_str(), map.stands_alone), (name, true));
    }
    assert_eq!(loaded.materials[3].specular, Vec3::new(0.1, 0.2, 1.0));
    assert_eq!(loaded.materials[3].emission, Vec3::new(3.0, 2.0, 1.0));
    // alpha = sqrt(2 / (6 + 2)) = 0.5.
    assert_eq!(loaded.materials[3].roughness, Some(0.5_f32.sqrt()));
    assert_eq!(loaded.materials[4].roughness, Some(0.3), "Pr before Ns");
    assert_eq!(loaded.materials[4].specular, Vec3::splat(0.04), "Pr alone");
    for text in [
        "above 1",
        "negative",
        "spectrum",
        "not a number",
        "defined again",
        "without a name",
    ] {
        let count = loaded.warnings.iter().filter(|w| w.contains(text)).count();
        assert_eq!(count, 1, "{text}: {:?}", loaded.warnings);
    }
    assert!(
        loaded
            .warnings
            .iter()
            .any(|w| w.starts_with("a b.mtl:10: ") && w.contains("(2 in all"))
    );
}

#[test]
fn unknown_materials_and_files_are_warnings() {
    let text =
        format!("mtllib missing.mtl other.mtl\n{VERTICES}usemtl x y\nf 1 2 3\nusemtl z\nf 1 2 4\n");
    let loaded = load_as(&text, None, Normals::File).unwrap();
    assert_eq!(loaded.materials.len(), 1);
    assert_eq!(loaded.materials[0].albedo, Vec3::splat(0.8));
    assert_eq!(loaded.warnings.len(), 2, "{:?}", loaded.warnings);
    assert!(loaded.warnings[0].starts_with("a.obj:1: cannot read the material file"));
    assert!(loaded.warnings[1].starts_with("a.obj:7: usemtl names"));
}

#[test]
fn materials_without_any_mtl_file() {
    let loaded = mesh("usemtl a\nf 1 2 3\n");
    assert_eq!(
        loaded.warnings,
        [
            "a.obj:6: usemtl names \"a\", but the file names no MTL file (mtllib); grey of albedo 0.8 is used"
        ]
    );
}

#[test]
fn mtl_files_are_counted_and_found_in_any_spelling() {
    let text = format!(
        "mtllib x.mtl\nmtllib y.mtl\nmtllib A B.MTL # ours\n{VERTICES}usemtl a # b\nf 1 2 3\n"
    );
    let loaded = load_as(&text, Some("newmtl a\nKd 1 0 0\n"), Normals::File).unwrap();
    assert_eq!(loaded.materials[0].albedo, Vec3::X);
    assert_eq!(loaded.warnings.len(), 1, "{:?}", loaded.warnings);
    assert!(loaded.warnings[0].starts_with("a.obj:1: cannot read the material file x.mtl ("));
    assert!(loaded.warnings[0].ends_with("(2 in all, the first one here)"));
}

#[test]
fn several_libraries_on_a_line() {
    let files = Memory::of(&[
        ("one.mtl", b"newmtl a\nKd 1 0 0\n"),
        ("two.mtl", b"newmtl a\nKd 0 1 0\nnewmtl b b\nKd 0 0 1\n"),
    ]);
    let text = format!(
        "{VERTICES}usemtl a\nf 1 2 3\nusemtl b b\nf 1 2 4\nmtllib none.mtl one.mtl two.mtl\n"
    );
    let loaded = load(
        text.as_bytes(),
        Path::new("a.obj"),
        Normals::File,
        &Finder::new(&files),
    )
    .unwrap();
    let used: Vec<_> = loaded
        .mesh
        .triangles
        .iter()
        .map(|t| loaded.materials[t.material as usize].albedo)
        .collect();
    assert_eq!(used, [Vec3::X, Vec3::Z], "the first definition counts");
}
