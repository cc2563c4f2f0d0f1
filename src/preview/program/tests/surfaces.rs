//! Surfaces that become glossy while they are seen, and their bakes.

use super::*;
use crate::scene::Bounces;

impl Table {
    /// A renderer of the scene that is to be prepared, with its bake.
    fn baked(&self) -> Renderer {
        let asked = self.effects.iter().find_map(|effect| match effect {
            Effect::Prepare(_, scene) => Some(Scene::clone(scene)),
            _ => None,
        });
        let mut scene = asked.expect("a scene is to be prepared");
        (scene.bake.max_edge, scene.bake.rays) = (Some(1.0), Some(64));
        let mut renderer = Renderer::new(scene, None);
        renderer.bake(&RunSettings::silent()).unwrap();
        renderer
    }

    /// The full picture by a renderer; what it brings about are the effects.
    fn full(&mut self, painter: &mut Painter) {
        let (wish, run) = (self.program.wish(), RunSettings::silent());
        loop {
            let drawn = painter
                .next(&wish, &run)
                .unwrap()
                .expect("it is not full yet");
            let sharpness = drawn.sharpness;
            let number = self.program.wishes;
            self.take(Message::Drawn {
                number,
                drawn: Box::new(drawn),
            });
            if sharpness == Sharpness::Full {
                return;
            }
            assert!(self.effects.is_empty(), "asked for by a draft");
        }
    }
}

/// A session with bounces whose first bake is there.
fn bounced() -> (Table, Painter) {
    let mut table = Table::new((160, 12));
    table.program.scene.render.bounces = Bounces::Count(1);
    let renderer = Box::new(table.baked());
    let painter = Painter::new(table.baked());
    table.take(Message::Prepared {
        number: 1,
        renderer,
    });
    for key in ["+", "]"] {
        table.key(key);
    }
    (table, painter)
}

#[test]
fn a_surface_that_becomes_glossy_gets_slices_by_a_bake() {
    let (mut table, mut painter) = bounced();
    table.full(&mut painter);
    assert_eq!(table.prepare_asked(), None, "nothing is glossy");
    table.key("}");
    let wish = table.program.wish();
    let drawn = painter
        .next(&wish, &RunSettings::silent())
        .unwrap()
        .unwrap();
    assert_eq!(drawn.lacks_slices_of.as_deref(), Some(""));
    table.take(Message::Drawn {
        number: table.program.wishes,
        drawn: Box::new(drawn),
    });
    assert_eq!(table.prepare_asked(), Some((2, true)));
    assert!(
        table
            .bottom()
            .contains("no bounced gloss of (no material) yet"),
        "{}",
        table.bottom()
    );
    let mut painter = Painter::new(table.baked());
    let renderer = Box::new(table.baked());
    table.take(Message::Prepared {
        number: 2,
        renderer,
    });
    table.full(&mut painter);
    assert_eq!(table.prepare_asked(), None, "it has slices now");
    assert!(!table.bottom().contains("gloss"), "{}", table.bottom());
    // Another lobe, or none, needs no bake.
    for key in ["}", "<", "}", "u", "u", "u", "u", "U"] {
        table.key(key);
        table.full(&mut painter);
        assert_eq!(table.prepare_asked(), None, "{key}");
    }
}

#[test]
fn what_shows_no_bounced_gloss_needs_no_slices() {
    let (mut table, mut painter) = bounced();
    for key in ["}", "3"] {
        table.key(key);
    }
    table.full(&mut painter);
    assert_eq!(table.prepare_asked(), None, "indirect light alone");
    table.key("4");
    let wish = table.program.wish();
    let drawn = painter
        .next(&wish, &RunSettings::silent())
        .unwrap()
        .unwrap();
    assert!(drawn.lacks_slices_of.is_some(), "glossy light alone");
}

#[test]
fn a_brdf_that_is_read_again_gets_slices_too() {
    let (mut table, mut painter) = bounced();
    table.program.hands.mark_saved();
    let plastic = format!("{SCENE}[[material]]\nname = \"\"\nbrdf = \"plastic\"\n");
    fs::write(table.path(), plastic.replace("bounces = 0", "bounces = 1")).unwrap();
    table.reload();
    assert!(table.bottom().contains("read again"), "{}", table.above());
    let wish = table.program.wish();
    let drawn = painter
        .next(&wish, &RunSettings::silent())
        .unwrap()
        .unwrap();
    table.take(Message::Drawn {
        number: table.program.wishes,
        drawn: Box::new(drawn),
    });
    assert_eq!(table.prepare_asked(), Some((2, true)));
}
