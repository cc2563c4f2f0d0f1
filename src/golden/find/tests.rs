use super::*;

/// Files of a folder by path and text.
fn folder_with(files: &[(&str, &str)]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let top = folder.path().canonicalize().unwrap();
    for (path, text) in files {
        let file = top.join(path);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, text).unwrap();
    }
    (folder, top)
}

fn below(top: &Path, paths: &[&Path]) -> Vec<String> {
    let inside = |path: &&Path| path.strip_prefix(top).unwrap().display().to_string();
    paths.iter().map(inside).collect()
}

fn scenes(top: &Path, suite: &Suite) -> Vec<String> {
    let scenes: Vec<&Path> = suite.scenes.iter().map(GoldenScene::scene).collect();
    below(top, &scenes)
}

fn strays(top: &Path, suite: &Suite) -> Vec<String> {
    let strays: Vec<&Path> = suite.without_scene.iter().map(PathBuf::as_path).collect();
    below(top, &strays)
}

#[test]
fn scenes_are_told_from_other_files() {
    let (_folder, top) = folder_with(&[
        ("Cargo.toml", "[package]\nname = \"x\"\nmesh = \"a\"\n"),
        ("b/scene.toml", "# a scene\n mesh = \"a.obj\"\n"),
        ("b/broken.toml", "mesh= \"a.obj\nunits ?\n"),
        ("b/quoted.toml", "\"mesh\" = 'a.obj'\n"),
        ("a/odd.toml", "this is no TOML"),
        ("a/odd.golden.png", ""),
        ("target/CACHEDIR.TAG", ""),
        ("target/scene.toml", "mesh = \"a.obj\""),
        (".hidden/scene.toml", "mesh = \"a.obj\""),
    ]);
    let suite = find(std::slice::from_ref(&top)).unwrap();
    let expected = [
        "a/odd.toml",
        "b/broken.toml",
        "b/quoted.toml",
        "b/scene.toml",
    ];
    assert_eq!(scenes(&top, &suite), expected);
    assert!(suite.without_scene.is_empty(), "{suite:?}");
}

#[test]
fn a_file_that_is_given_counts_and_none_counts_twice() {
    let (_folder, top) = folder_with(&[("a/any.toml", ""), ("a/s.toml", "mesh = \"a.obj\"")]);
    let given = ["a/any.toml", "a", "."].map(|it| top.join(it));
    let suite = find(&given).unwrap();
    assert_eq!(scenes(&top, &suite), ["a/any.toml", "a/s.toml"]);
    assert!(find(&[top.join("missing")]).is_err());
}

#[test]
fn goldens_without_a_scene_are_found_where_the_scene_would_be() {
    let (_folder, top) = folder_with(&[
        ("scenes/a/one.toml", "mesh = \"a.obj\""),
        ("golden/scenes/a/one.png", ""),
        ("golden/scenes/a/gone.png", ""),
        ("golden/scenes/a/one.mask.png", ""),
        ("golden/scenes/b/gone.exr", ""),
        ("golden/notes.txt", ""),
        ("scenes/a/lost.golden.png", ""),
        ("scenes/a/texture.png", ""),
    ]);
    let all = find(std::slice::from_ref(&top)).unwrap();
    assert_eq!(scenes(&top, &all), ["scenes/a/one.toml"]);
    let mut found = strays(&top, &all);
    found.sort();
    let expected = [
        "golden/scenes/a/gone.png",
        "golden/scenes/b/gone.exr",
        "scenes/a/lost.golden.png",
    ];
    assert_eq!(found, expected);
    let part = find(&[top.join("scenes/a/../a")]).unwrap();
    let mut found = strays(&top, &part);
    found.sort();
    assert_eq!(
        found,
        ["golden/scenes/a/gone.png", "scenes/a/lost.golden.png"]
    );
}
