//! The cache of bakes: found by content, checked when read, never in the way.

use std::fs;
use std::path::Path;

use crate::program::{
    Finished, files_in, only_bake, render_box, render_box_command, succeed, temporary_folder,
};

/// Bytes of a bake's file before the payload: magic, format version, key,
/// length and checksum.
const VERSION_AT: usize = 8;
const KEY_AT: usize = 12;
const PAYLOAD_AT: usize = 84;

/// Cache and digest that a render reports.
fn outcome(finished: &Finished) -> (String, String) {
    let report = finished.json();
    let text = |key: &str| report[key].as_str().unwrap_or_default().to_owned();
    (text("cache"), text("digest"))
}

#[test]
fn the_second_run_takes_the_stored_bake() {
    let folder = temporary_folder();
    let (first, digest) = outcome(&render_box(folder.path(), &[]));
    assert_eq!(first, "miss", "nothing is stored yet");
    let bytes = fs::read(only_bake(&folder.path().join("cache"))).expect("the bake can be read");
    let again = render_box(folder.path(), &[]);
    assert_eq!(
        outcome(&again),
        ("hit".to_owned(), digest.clone()),
        "{again:#?}"
    );
    assert_eq!(again.stderr, "", "a hit warns of nothing");
    let kept = fs::read(only_bake(&folder.path().join("cache"))).expect("the bake can be read");
    assert!(bytes == kept, "a hit leaves the file as it is");
    let fresh = render_box(folder.path(), &["--no-cache"]);
    assert_eq!(outcome(&fresh), ("miss".to_owned(), digest), "{fresh:#?}");
}

#[test]
fn without_a_cache_nothing_is_written() {
    let folder = temporary_folder();
    render_box(folder.path(), &["--no-cache"]);
    let files = files_in(folder.path());
    assert_eq!(
        files,
        [folder.path().join("frame.png")],
        "the picture alone"
    );
}

/// Renders with a stored bake whose bytes were changed: it must be rebuilt with
/// a warning that has these words, and be whole afterwards.
fn rebuilt(change: impl FnOnce(Vec<u8>) -> Vec<u8>, words: &str) {
    let folder = temporary_folder();
    let (_, digest) = outcome(&render_box(folder.path(), &[]));
    let path = only_bake(&folder.path().join("cache"));
    let bytes = fs::read(&path).expect("the bake can be read");
    fs::write(&path, change(bytes.clone())).expect("the bake can be changed");

    let finished = render_box(folder.path(), &[]);
    assert_eq!(
        outcome(&finished),
        ("miss".to_owned(), digest.clone()),
        "{words}: {finished:#?}"
    );
    let warnings: Vec<&str> = finished.stderr.lines().collect();
    assert_eq!(warnings.len(), 1, "{words}: one warning: {finished:#?}");
    let file_name = path
        .file_name()
        .and_then(|name| name.to_str())
        .expect("a name");
    for word in ["warning: ", file_name, words, "baking anew"] {
        assert!(
            warnings[0].contains(word),
            "nothing says {word:?}: {finished:#?}"
        );
    }
    let healed = fs::read(only_bake(&folder.path().join("cache"))).expect("the bake can be read");
    assert!(
        healed == bytes,
        "{words}: the rebuilt file has the bytes of the first"
    );
    let again = render_box(folder.path(), &[]);
    assert_eq!(
        outcome(&again),
        ("hit".to_owned(), digest),
        "{words}: {again:#?}"
    );
}

#[test]
fn a_damaged_bake_is_rebuilt() {
    let flip = |at: usize| {
        move |mut bytes: Vec<u8>| {
            bytes[at] ^= 1;
            bytes
        }
    };
    rebuilt(flip(PAYLOAD_AT), "cut short or damaged");
    rebuilt(flip(PAYLOAD_AT + 9_999), "cut short or damaged");
    rebuilt(flip(PAYLOAD_AT - 1), "cut short or damaged");
    rebuilt(flip(PAYLOAD_AT - 32 - 8), "cut short or damaged");
}

#[test]
fn a_bake_that_is_cut_or_too_long_is_rebuilt() {
    for length in [PAYLOAD_AT - 1, PAYLOAD_AT, 5_000] {
        let cut = move |mut bytes: Vec<u8>| {
            bytes.truncate(length);
            bytes
        };
        rebuilt(cut, "cut short or damaged");
    }
    let longer = |mut bytes: Vec<u8>| {
        bytes.push(0);
        bytes
    };
    rebuilt(longer, "cut short or damaged");
}

#[test]
fn a_foreign_file_is_replaced() {
    rebuilt(|_| b"not a bake at all".to_vec(), "not a bake file");
    rebuilt(|_| Vec::new(), "not a bake file");
}

#[test]
fn a_bake_of_another_version_is_rebuilt() {
    for version in [0_u32, 999] {
        let other = move |mut bytes: Vec<u8>| {
            bytes[VERSION_AT..VERSION_AT + 4].copy_from_slice(&version.to_le_bytes());
            bytes
        };
        rebuilt(other, &format!("format version {version}"));
    }
}

#[test]
fn a_bake_of_another_scene_is_rebuilt() {
    let other = |mut bytes: Vec<u8>| {
        bytes[KEY_AT] ^= 0x80;
        bytes
    };
    rebuilt(other, "another scene or other settings");
}

/// Renders the box with a change from a cache that the unchanged box filled.
fn after_the_plain_box(change: &[&str]) -> (String, String) {
    let folder = temporary_folder();
    render_box(folder.path(), &[]);
    outcome(&render_box(folder.path(), change))
}

#[test]
fn edits_of_light_albedo_and_view_need_no_new_bake() {
    let (_, plain) = after_the_plain_box(&[]);
    for change in [
        &["--set", "light.lamp.position=[0.3,1.2,0.5]"][..],
        &["--set", "light.lamp.intensity=[1,2,3]"],
        &["--set", "material.red.albedo=[0.1,0.7,0.7]"],
        &["--set", "camera.position=[0.3,1.1,6.0]"],
        &["--bounces", "2"],
    ] {
        let (cache, digest) = after_the_plain_box(change);
        assert_eq!(cache, "hit", "{change:?} reads nothing that the bake read");
        assert_ne!(digest, plain, "{change:?} changes the picture");
        let folder = temporary_folder();
        let fresh = [change, &["--no-cache"]].concat();
        let (_, solved) = outcome(&render_box(folder.path(), &fresh));
        assert_eq!(
            digest, solved,
            "{change:?}: the stored bake gives the bits of a fresh one"
        );
    }
}

#[test]
fn edits_of_mesh_and_bake_need_a_new_bake() {
    for change in [
        &["--set", "bake.rays=32"][..],
        &["--set", "bake.max_edge=0.45"],
        &["--set", "bake.functions=40"],
        &["--set", "bake.coefficients=12"],
        &["--set", "normals=\"smooth\""],
    ] {
        let (cache, _) = after_the_plain_box(change);
        assert_eq!(cache, "miss", "{change:?} changes what the bake reads");
    }
}

/// Renders the box from a copy whose mesh was edited, with the cache in `folder`.
fn render_edited(folder: &Path, edit: impl Fn(&str) -> String) -> Finished {
    let original = crate::program::scene("cornell");
    for extension in ["toml", "obj", "mtl"] {
        let text =
            fs::read_to_string(original.with_extension(extension)).expect("the scene is text");
        let text = if extension == "obj" {
            edit(&text)
        } else {
            text
        };
        fs::write(folder.join("cornell").with_extension(extension), text)
            .expect("a copy is written");
    }
    let mut command = crate::program::relume(&["render", "--json", "--size", "40x30"]);
    command
        .arg(folder.join("cornell.toml"))
        .args(crate::program::SMALL_BAKE)
        .arg("-o")
        .arg(folder.join("frame.png"))
        .arg("--cache-dir")
        .arg(folder.join("cache"));
    succeed(&mut command)
}

#[test]
fn the_key_is_the_content_and_not_the_place() {
    let folder = temporary_folder();
    let (_, digest) = outcome(&render_box(folder.path(), &[]));
    let copy = render_edited(folder.path(), str::to_owned);
    assert_eq!(
        outcome(&copy),
        ("hit".to_owned(), digest.clone()),
        "the same scene elsewhere"
    );
    let comment = render_edited(folder.path(), |obj| format!("# a comment\n{obj}"));
    assert_eq!(
        outcome(&comment),
        ("hit".to_owned(), digest),
        "a comment is not geometry"
    );
    let moved = render_edited(folder.path(), |obj| obj.replacen("0.60000", "0.60001", 1));
    assert_eq!(
        outcome(&moved).0,
        "miss",
        "a corner was moved by a hundredth of a millimetre"
    );
}

#[test]
fn a_cache_that_cannot_be_used_is_a_warning() {
    let folder = temporary_folder();
    let file = folder.path().join("not a folder");
    fs::write(&file, "a file").expect("a file can be written");
    let file = file.to_str().expect("a temporary path is UTF-8");
    let mut command = render_box_command(folder.path(), "frame.png", &["--cache-dir", file]);
    let finished = succeed(command.arg("--json"));
    let (_, fresh) = outcome(&render_box(folder.path(), &["--no-cache"]));
    assert_eq!(
        outcome(&finished),
        ("miss".to_owned(), fresh),
        "{finished:#?}"
    );
    let said = finished.stderr.contains("warning: ") && finished.stderr.contains("not be stored");
    assert!(said, "the user hears of it: {finished:#?}");
    let kept = fs::read_to_string(file).expect("the file is still there");
    assert_eq!(kept, "a file", "nobody's file is touched");
}

#[test]
fn an_error_that_is_missed_is_said_once_by_each_run() {
    let folder = temporary_folder();
    let asked = ["--set", "bake.error=0.0001"];
    let said = |arguments: &[&str]| {
        let finished = render_box(folder.path(), arguments);
        let count = finished.stderr.matches("were asked for").count();
        (outcome(&finished).0, count)
    };
    let miss = ("miss".to_owned(), 1);
    let hit = ("hit".to_owned(), 1);
    assert_eq!(said(&asked), miss, "made");
    assert_eq!(said(&asked), hit, "stored");
    let all = ["--set", "render.bounces=\"all\""];
    let fixed = ["--set", "bake.fixed_albedo=true"];
    let folded = [&asked[..], &all, &fixed].concat();
    assert_eq!(said(&folded), miss, "folded");
    assert_eq!(said(&folded), hit, "stored, folded");
}

#[cfg(unix)]
#[test]
fn a_stored_bake_has_the_rights_of_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = temporary_folder();
    render_box(folder.path(), &[]);
    let any = folder.path().join("any new file");
    fs::write(&any, "").expect("a file can be written");
    let mode = |path: &Path| {
        let metadata = fs::metadata(path).expect("the file exists");
        metadata.permissions().mode() & 0o777
    };
    let bake = only_bake(&folder.path().join("cache"));
    assert_eq!(
        mode(&bake),
        mode(&any),
        "a cache that is shared can be read by those it is shared with"
    );
}
