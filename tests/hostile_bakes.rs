//! Stored bakes with a right checksum and wrong contents: the program that
//! reads one may refuse it with a warning or use it, but not crash. The kernels
//! index without further checks, so the reader is all that guards them.

mod program;

use std::fs;
use std::path::Path;

use program::{only_bake, scene, temporary_folder};
use relume::{FrameSettings, Override, Renderer, RunSettings, Scene, Scheme};

/// Bytes before the payload, the last 32 of which are its checksum.
const PAYLOAD_AT: usize = 84;
/// A list's length in bytes, before its items.
const LENGTH: usize = 8;
/// Every so many bytes of the payload, four are replaced; a prime, so that all
/// kinds of lists are met at all alignments.
const STRIDE: usize = 97;
/// Values that an index, an offset, a length or a float should not have.
const HOSTILE: [u32; 3] = [u32::MAX, 0x7fff_0000, 1];

/// A box of few vertices and functions: hundreds of frames of it take seconds.
fn tiny_box() -> Scene {
    let keys = [
        "bake.max_edge=2",
        "bake.rays=16",
        "bake.functions=12",
        "camera.size=[16,12]",
    ];
    let overrides = keys.map(|text| Override::parse(text).expect("the override is valid"));
    Scene::load(&scene("cornell"), &overrides).expect("the box can be loaded")
}

/// Draws a frame with the bakes in a folder; returns the warnings.
fn draw(scheme: Scheme, cache: &Path) -> Vec<String> {
    let scene = tiny_box();
    let settings = FrameSettings::of_scene(&scene);
    let mut renderer = Renderer::with_scheme(scene, Some(cache), scheme);
    renderer
        .frame(&settings, &RunSettings::silent())
        .expect("a frame is drawn whatever the cache holds");
    renderer.take_warnings()
}

/// Puts the right checksum and length on a payload that was changed.
fn seal(bytes: &mut [u8]) {
    let length = (bytes.len() - PAYLOAD_AT) as u64;
    let checksum = blake3::hash(&bytes[PAYLOAD_AT..]);
    bytes[PAYLOAD_AT - 40..PAYLOAD_AT - 32].copy_from_slice(&length.to_le_bytes());
    bytes[PAYLOAD_AT - 32..PAYLOAD_AT].copy_from_slice(checksum.as_bytes());
}

/// Draws with a changed bake; whether it was refused.
fn refused(scheme: Scheme, path: &Path, change: impl FnOnce(&mut Vec<u8>), bytes: &[u8]) -> bool {
    let mut changed = bytes.to_vec();
    change(&mut changed);
    seal(&mut changed);
    fs::write(path, &changed).expect("the bake can be changed");
    let warnings = draw(scheme, path.parent().expect("a bake lies in a folder"));
    let refused = warnings
        .iter()
        .any(|warning| warning.contains("baking anew"));
    let now = fs::read(path).expect("there is a bake");
    assert!(
        now == if refused { bytes } else { &changed },
        "a refused bake is replaced by the right one, another is left: {warnings:?}"
    );
    refused
}

#[test]
fn no_contents_crash_the_reader_or_the_kernels() {
    Scheme::ALL.into_iter().for_each(no_contents_crash);
}

fn no_contents_crash(scheme: Scheme) {
    let folder = temporary_folder();
    let first = draw(scheme, folder.path());
    let about_the_cache = first.iter().any(|warning| warning.contains("stored"));
    assert!(!about_the_cache, "nothing to warn of: {first:?}");
    let path = only_bake(folder.path());
    let bytes = fs::read(&path).expect("the bake can be read");
    assert!(
        !refused(scheme, &path, |_| {}, &bytes),
        "the sealed file as it was is used"
    );

    let mut refusals = 0;
    let places: Vec<usize> = (PAYLOAD_AT..bytes.len() - 4).step_by(STRIDE).collect();
    for (&at, value) in places.iter().zip(HOSTILE.iter().cycle()) {
        let replace = |changed: &mut Vec<u8>| {
            changed[at..at + 4].copy_from_slice(&value.to_le_bytes());
        };
        refusals += usize::from(refused(scheme, &path, replace, &bytes));
    }
    assert!(
        places.len() > 40 && refusals > 0,
        "{refusals} of {} changes were refused",
        places.len()
    );
}

#[test]
fn lists_that_are_cut_or_missing_are_refused() {
    Scheme::ALL.into_iter().for_each(cut_lists_are_refused);
}

fn cut_lists_are_refused(scheme: Scheme) {
    let folder = temporary_folder();
    draw(scheme, folder.path());
    let path = only_bake(folder.path());
    let bytes = fs::read(&path).expect("the bake can be read");
    for kept in [
        0,
        1,
        LENGTH,
        LENGTH + 4,
        1_000,
        bytes.len() - PAYLOAD_AT - 1,
    ] {
        let cut = |changed: &mut Vec<u8>| changed.truncate(PAYLOAD_AT + kept);
        assert!(
            refused(scheme, &path, cut, &bytes),
            "a payload of {kept} bytes is refused"
        );
    }
    let longer = |changed: &mut Vec<u8>| changed.push(0);
    assert!(
        refused(scheme, &path, longer, &bytes),
        "a byte too many is refused"
    );
    for tag in [2, u8::MAX] {
        let other = |changed: &mut Vec<u8>| changed[PAYLOAD_AT + LENGTH] = tag;
        assert!(
            refused(scheme, &path, other, &bytes),
            "a scheme that does not exist is refused"
        );
    }
    let exchanged =
        |changed: &mut Vec<u8>| changed[PAYLOAD_AT + LENGTH] = 1 - changed[PAYLOAD_AT + LENGTH];
    assert!(
        refused(scheme, &path, exchanged, &bytes),
        "the lists of one scheme are not those of the other"
    );
    let endless = |changed: &mut Vec<u8>| changed[PAYLOAD_AT..PAYLOAD_AT + LENGTH].fill(0xff);
    assert!(
        refused(scheme, &path, endless, &bytes),
        "a list longer than any memory is refused"
    );
}
