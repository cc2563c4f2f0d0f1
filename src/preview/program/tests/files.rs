//! The scene's files: saved, changed by others, read again.

use super::*;

#[test]
fn a_file_that_changed_meanwhile_is_not_written_over_unasked() {
    let mut table = Table::new((120, 24));
    table.key("Tab");
    table.key("i");
    let other = SCENE.replace("vfov = 40.0", "vfov = 50.0");
    fs::write(table.path(), &other).unwrap();
    table.key("ctrl+s");
    assert!(table.bottom().contains("changed meanwhile"));
    assert_eq!(fs::read_to_string(table.path()).unwrap(), other);
    table.key("Esc");
    table.key("ctrl+s");
    table.key("o");
    let saved = fs::read_to_string(table.path()).unwrap();
    assert!(saved.contains("vfov = 40.0") && saved != SCENE);
    assert!(!table.program.is_unsaved());
}

#[test]
fn a_file_that_changes_is_shown_and_one_that_is_wrong_leaves_the_last() {
    let mut table = Table::new((160, 24));
    fs::write(table.path(), SCENE.replace("0.3, 0.8", "0.4, 0.9")).unwrap();
    table.reload();
    assert!(table.asks(|it| matches!(it, Effect::Show(..))));
    assert_eq!(table.prepare_asked(), None, "a light needs no bake");
    assert_eq!(table.program.wish().lights, table.program.scene.lights);
    let good = table.program.wish();

    fs::write(
        table.path(),
        SCENE.replace("vfov = 40.0", "vfov = \"wide\""),
    )
    .unwrap();
    table.reload();
    assert!(table.above().contains("scene.toml:5"), "{}", table.above());
    assert_eq!(table.program.wish(), good);

    fs::write(table.path(), SCENE).unwrap();
    fs::remove_file(table.folder.path().join("floor.obj")).unwrap();
    table.reload();
    assert!(table.above().contains("floor.obj"), "{}", table.above());
    assert_eq!(table.program.wish(), good);

    fs::write(
        table.folder.path().join("floor.obj"),
        MESH.replace("-1 0 1", "-1 0 2"),
    )
    .unwrap();
    table.reload();
    assert_eq!(table.prepare_asked(), Some((2, false)), "another mesh");
    assert!(table.bottom().contains("read again"));
}

#[test]
fn reading_again_asks_where_it_would_cost_edits_and_can_be_undone() {
    let mut table = Table::new((120, 24));
    table.key("Tab");
    table.key("i");
    let edited = table.program.wish();
    fs::write(table.path(), SCENE.replace("0.3, 0.8", "0.4, 0.9")).unwrap();
    table.reload();
    assert!(table.bottom().contains("the scene file was changed"));
    table.key("r");
    table.read();
    assert!(table.program.wish() != edited);
    table.key("u");
    assert_eq!(table.program.wish().lights, edited.lights);
}

#[test]
fn a_file_that_a_broken_scene_names_is_watched() {
    let mut table = Table::new((120, 12));
    fs::write(table.path(), SCENE.replace("floor.obj", "new.obj")).unwrap();
    table.reload();
    let names_new = |it: &Watched| it.files.iter().any(|file| file.ends_with("new.obj"));
    assert!(table.asks(|it| matches!(it, Effect::Watch(watched) if names_new(watched))));
}

#[test]
fn two_pictures_are_two_files_and_quitting_waits_for_them() {
    let mut table = Table::new((120, 12));
    table.prepared(1);
    let mut paths = Vec::new();
    for _ in 0..2 {
        table.key("P");
        let written = table.effects.iter().find_map(|effect| match effect {
            Effect::Send(Errand::Write { path, .. }) => Some(path.clone()),
            _ => None,
        });
        paths.push(written.expect("a picture is to be written"));
    }
    assert_ne!(paths[0], paths[1]);
    table.key("q");
    assert_eq!(table.quits(), None, "{}", table.bottom());
    for (path, quits) in paths.into_iter().zip([None, Some(0)]) {
        table.take(Message::Wrote {
            path,
            written: Ok("digest".to_owned()),
        });
        assert_eq!(table.quits().or(quits), quits);
    }
}

#[test]
fn a_late_bake_and_a_late_reading_say_nothing() {
    let mut table = Table::new((120, 12));
    table.prepared(1);
    table.take(Message::Baking {
        number: 0,
        stage: "transfer",
        share: 0.5,
    });
    assert!(table.program.status.baking.is_none());
    table.take(Message::FilesChanged);
    let first = table.load_asked().unwrap();
    table.take(Message::FilesChanged);
    assert!(table.load_asked().unwrap() > first);
    let loaded = load(&table.path(), &[]);
    table.take(Message::Loaded {
        number: first,
        loaded,
    });
    assert!(table.effects.is_empty());
    // What was edited while the files were read is not lost unasked.
    fs::write(table.path(), SCENE.replace("0.3, 0.8", "0.4, 0.9")).unwrap();
    table.take(Message::FilesChanged);
    let number = table.load_asked().unwrap();
    table.key("Tab");
    table.key("i");
    let edited = table.program.wish();
    let loaded = load(&table.path(), &[]);
    table.take(Message::Loaded { number, loaded });
    assert!(table.bottom().contains("the scene file was changed"));
    assert_eq!(table.program.wish(), edited);
}

#[test]
fn what_was_not_saved_is_beside_the_scene() {
    let mut table = Table::new((80, 12));
    assert_eq!(table.program.rescue(), None, "nothing has changed");
    table.key("Tab");
    table.key("i");
    let path = table.program.rescue().expect("there is something");
    assert_eq!(path, table.folder.path().join("scene.toml.unsaved"));
    let rescued = fs::read_to_string(path).unwrap();
    assert!(rescued != SCENE && rescued.contains("# the only one"));
    assert_eq!(fs::read_to_string(table.path()).unwrap(), SCENE);
}

#[test]
fn a_mesh_and_its_materials_change_under_what_was_edited() {
    let mut table = Table::new((160, 12));
    let mtl = |kd: &str| format!("newmtl grey\nKd {kd}\nnewmtl red\nKd 1 0 0\n");
    let obj = format!("mtllib floor.mtl\nusemtl grey\n{MESH}usemtl red\nf 1 2 3\n");
    let write = |table: &Table, name: &str, text: &str| {
        fs::write(table.folder.path().join(name), text).unwrap();
    };
    write(&table, "floor.obj", &obj);
    write(&table, "floor.mtl", &mtl("0.5 0.5 0.5"));
    table.reload();
    // A lamp and one of the two materials are edited.
    for key in ["Tab", "i", "]", "]", "I"] {
        table.key(key);
    }
    let edited = table.program.wish();
    write(&table, "floor.mtl", &mtl("0.2 0.3 0.4"));
    table.reload();
    assert!(table.bottom().contains("read again"), "{}", table.bottom());
    let now = table.program.wish();
    assert_eq!(now.lights, edited.lights, "they stay");
    assert_eq!(now.materials[0].albedo.to_array(), [0.2, 0.3, 0.4]);
    assert_eq!(
        now.materials[1].albedo, edited.materials[1].albedo,
        "it stays"
    );
    // What is undone and saved does not bring back what the MTL said.
    table.key("u");
    table.key("ctrl+s");
    let saved = fs::read_to_string(table.path()).unwrap();
    assert!(!saved.contains("[[material]]"), "{saved}");
    assert_eq!(
        table.program.wish().materials[0].albedo.to_array(),
        [0.2, 0.3, 0.4]
    );
}

#[test]
fn a_save_while_files_are_read_is_not_undone_by_them() {
    let mut table = Table::new((120, 12));
    table.take(Message::FilesChanged);
    let before = (table.load_asked().unwrap(), load(&table.path(), &[]));
    table.key("Tab");
    table.key("i");
    table.key("ctrl+s");
    assert!(table.load_asked().is_some(), "it is read anew");
    let saved = table.program.wish();
    let (number, loaded) = before;
    table.take(Message::Loaded { number, loaded });
    assert_eq!(table.program.wish(), saved);
}
