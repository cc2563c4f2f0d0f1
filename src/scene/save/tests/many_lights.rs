//! As many lights as a scene may have by hand.

use super::*;

const COUNT: usize = 500;

fn text() -> String {
    let start = SCENE.split("# The lamp hangs").next().unwrap();
    let lights = (0..COUNT).map(|index| {
        format!("[[light]]\nkind = \"point\" # {index}\nposition = [0.0, {index}.5, 0.0]\nintensity = [1, 1, 1]\n\n")
    });
    format!("{start}{}", lights.collect::<String>())
}

/// How often the text was parsed, and what came of it.
fn parses(edit: impl Fn(&mut Scene)) -> (usize, String) {
    let text = text();
    let loaded = load(text.as_bytes(), &[]);
    let mut scene = loaded.clone();
    edit(&mut scene);
    let mut editor = Editor::new(&text);
    let parts = [&loaded, &scene].map(Parts::of);
    let changes = Changes::between(parts[0].edited(), parts[1].edited());
    changes.apply(&mut editor, &[]).unwrap();
    let count = editor.parse_count.get();
    let new = editor.into_text();
    assert_eq!(load(new.as_bytes(), &[]).lights, scene.lights);
    (count, new)
}

#[test]
fn a_text_is_parsed_for_what_changed_and_not_for_every_light() {
    let (count, new) = parses(|_| ());
    assert!(count <= 1 && new == text(), "{count}");
    let (count, new) = parses(|scene| point(&mut scene.lights[250]).position.y = 0.25);
    assert!(count <= 2, "{count}");
    assert_eq!(new, text().replace("250.5", "0.25"));
    let (count, _) = parses(|scene| {
        for light in &mut scene.lights {
            point(light).intensity = Vec3::splat(2.0);
        }
    });
    assert!(count <= 2, "{count} for all of them");
    // All others keep the names that they had by their places.
    let (count, new) = parses(|scene| drop(scene.lights.remove(0)));
    assert_eq!(new.matches("name = ").count(), COUNT - 1);
    assert!(count <= 4, "{count}");
}
