//! What `--set` gave before and after it was edited and saved.

use super::*;

/// The file is written by someone else, and read again.
fn touch(table: &mut Table) {
    let text = fs::read_to_string(table.path()).unwrap();
    let text = text.replace("# a floor", "# the floor");
    fs::write(table.path(), text).unwrap();
    table.reload();
    assert!(table.bottom().contains("read again"), "{}", table.above());
}

#[test]
fn what_was_edited_and_saved_is_not_overridden_when_it_is_read_again() {
    let sets = [
        "light.lamp.intensity=[9, 9, 9]",
        "render.exposure=2",
        "camera.vfov=50",
    ];
    let mut table = Table::under((160, 24), &sets);
    for key in ["Tab", "i", "e", "ctrl+s"] {
        table.key(key);
    }
    assert!(table.bottom().contains("saved"), "{}", table.bottom());
    let saved = table.program.wish();
    touch(&mut table);
    assert_eq!(table.program.wish(), saved);
    assert_eq!(saved.frame.camera.vfov_deg, 50.0, "was not edited");
    let text = fs::read_to_string(table.path()).unwrap();
    assert!(text.contains("vfov = 40.0"), "{text}");
}

#[test]
fn a_light_that_is_gone_is_not_overridden_any_more() {
    let mut table = Table::under((160, 24), &["light.lamp.intensity=[9, 9, 9]"]);
    for key in ["Tab", "Delete", "ctrl+s"] {
        table.key(key);
    }
    assert!(table.bottom().contains("saved"), "{}", table.bottom());
    touch(&mut table);
    assert!(table.program.wish().lights.is_empty());
    // Two steps back is the lamp, as the override had it; it is a new light now.
    for key in ["u", "u", "ctrl+s"] {
        table.key(key);
    }
    let text = fs::read_to_string(table.path()).unwrap();
    assert!(text.contains("intensity = [9.0, 9.0, 9.0]"), "{text}");
}

#[test]
fn an_override_holds_until_the_file_is_written() {
    let mut table = Table::under((160, 24), &["light.lamp.intensity=[9, 9, 9]"]);
    table.key("Tab");
    table.key("i");
    fs::write(table.path(), SCENE.replace("# a floor", "# the floor")).unwrap();
    table.key("ctrl+s");
    assert!(table.bottom().contains("changed meanwhile"));
    assert_eq!(table.program.overrides().len(), 1);
    table.key("o");
    assert_eq!(table.program.overrides().len(), 0);
}
