//! What the program asks for, message by message, without a terminal.

use std::fs;

use super::*;
use crate::bake::RunSettings;
use crate::preview::input::Key;
use crate::preview::painter::Painter;
use crate::relight::Renderer;

const MESH: &str = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 4 3 2 1\n";
const SCENE: &str = "mesh = \"floor.obj\" # a floor\n\
    [camera]\nposition = [0.0, 2.0, 1.5]\ntarget = [0.0, 0.0, 0.0]\nvfov = 40.0\nsize = [64, 48]\n\
    [[light]]\nname = \"lamp\" # the only one\nkind = \"point\"\nposition = [0.3, 0.8, 0.1]\n\
    intensity = [1.0, 1.0, 1.0]\n[render]\nbounces = 0\n";

/// A session on a scene of a folder of its own.
struct Table {
    program: Program,
    folder: tempfile::TempDir,
    effects: Vec<Effect>,
}

impl Table {
    fn new(size: (u16, u16)) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("floor.obj"), MESH).unwrap();
        let path = folder.path().join("scene.toml");
        fs::write(&path, SCENE).unwrap();
        let (bytes, scene) = load(&path, &[]);
        let file = SceneFile {
            path,
            overrides: Vec::new(),
            bytes,
        };
        let (program, effects) = Program::start(file, *scene.unwrap(), size, None);
        Self {
            program,
            folder,
            effects,
        }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("scene.toml")
    }

    fn take(&mut self, message: Message) {
        self.effects = self.program.take(message, Duration::ZERO);
    }

    fn key(&mut self, name: &str) {
        self.take(Message::Input(Input::Key(Key::parse(name).unwrap())));
    }

    /// What the scene's files hold now is read, as when they changed.
    fn reload(&mut self) {
        self.take(Message::FilesChanged);
        assert!(self.asks(|it| matches!(it, Effect::Load)));
        let (bytes, scene) = load(&self.path(), &[]);
        self.take(Message::Loaded { bytes, scene });
    }

    fn asks(&self, is_it: impl Fn(&Effect) -> bool) -> bool {
        self.effects.iter().any(is_it)
    }

    fn quits(&self) -> Option<u8> {
        self.effects.iter().find_map(|effect| match effect {
            Effect::Quit(code) => Some(*code),
            _ => None,
        })
    }

    fn bottom(&self) -> String {
        self.program.cells().lines().pop().unwrap()
    }

    /// What stands above the last row.
    fn above(&self) -> String {
        let lines = self.program.cells().lines();
        lines[lines.len() - 2].clone()
    }

    /// Draws what is wished for until it is sharp.
    fn draw(&mut self) {
        let mut painter = Painter::new(Renderer::new(self.program.scene.clone(), None));
        while let Some(drawn) = painter
            .next(&self.program.wish(), &RunSettings::silent())
            .unwrap()
        {
            let number = self.program.wishes;
            self.take(Message::Drawn {
                number,
                drawn: Box::new(drawn),
            });
        }
    }
}

#[test]
fn it_begins_with_a_scene_to_prepare_files_to_watch_and_a_wish() {
    let table = Table::new((80, 24));
    assert!(table.asks(|it| matches!(it, Effect::Prepare(1, _))));
    assert!(table.asks(|it| matches!(it, Effect::Show(1, _))));
    let watched = |files: &Vec<PathBuf>| files.iter().any(|it| it.ends_with("floor.obj"));
    assert!(table.asks(|it| matches!(it, Effect::Watch(files) if watched(files))));
    assert!(table.bottom().contains("? shows the keys"));
}

#[test]
fn quitting_asks_where_something_is_unsaved() {
    let mut table = Table::new((120, 24));
    table.key("q");
    assert_eq!(table.quits(), Some(0), "nothing has changed");
    table.key("Tab");
    table.key("i");
    table.key("q");
    assert_eq!(table.quits(), None);
    assert!(table.bottom().contains("unsaved changes"));
    table.key("x");
    assert!(table.bottom().contains("unsaved changes"), "x is no answer");
    table.key("Esc");
    assert!(!table.bottom().contains("unsaved changes"));
    table.key("q");
    table.key("s");
    assert_eq!(table.quits(), Some(0));
    let saved = fs::read_to_string(table.path()).unwrap();
    assert!(saved != SCENE && saved.contains("# the only one") && saved.contains("# a floor"));
    table.key("i");
    table.key("q");
    table.key("d");
    assert_eq!(table.quits(), Some(0));
    assert_eq!(fs::read_to_string(table.path()).unwrap(), saved);
    table.key("ctrl+c");
    assert_eq!(table.quits(), Some(130), "without a question");
}

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
    assert!(
        !table.asks(|it| matches!(it, Effect::Prepare(..))),
        "a light needs no bake"
    );
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
    assert!(
        table.asks(|it| matches!(it, Effect::Prepare(2, _))),
        "another mesh"
    );
    assert!(table.bottom().contains("read again"));
}

#[test]
fn reading_again_asks_where_it_would_cost_edits_and_can_be_undone() {
    let mut table = Table::new((120, 24));
    table.key("Tab");
    table.key("i");
    let edited = table.program.wish();
    fs::write(table.path(), SCENE.replace("0.3, 0.8", "0.4, 0.9")).unwrap();
    table.take(Message::FilesChanged);
    assert!(table.bottom().contains("the scene file was changed"));
    table.key("r");
    assert!(table.asks(|it| matches!(it, Effect::Load)));
    let (bytes, scene) = load(&table.path(), &[]);
    table.take(Message::Loaded { bytes, scene });
    assert!(table.program.wish() != edited);
    table.key("u");
    assert_eq!(table.program.wish().lights, edited.lights);
}

#[test]
fn any_size_of_screen_shows_something() {
    for size in [(1, 1), (1, 2), (10, 5), (3, 1), (500, 2)] {
        let mut table = Table::new(size);
        table.draw();
        assert!(table.program.drawn.is_some(), "{size:?}");
        assert_eq!(table.program.cells().lines().len(), usize::from(size.1));
        for key in ["?", "Down", "PgDn", "End", "?", "q", "Tab", "i", "q"] {
            table.key(key);
            table.program.cells();
        }
    }
    let mut table = Table::new((80, 24));
    table.take(Message::Input(Input::Resize {
        columns: 0,
        rows: 0,
    }));
    table.draw();
    assert!(table.program.cells().lines().is_empty());
}

#[test]
fn a_click_selects_what_is_seen_there() {
    let mut table = Table::new((60, 31));
    table.draw();
    let click = |action| {
        Message::Input(Input::Mouse(crate::preview::input::Mouse {
            action,
            column: 30,
            row: 26,
            held: crate::preview::input::Held::NONE,
        }))
    };
    use crate::preview::input::{Action, Button};
    table.take(click(Action::Press(Button::Left)));
    table.take(click(Action::Release(Button::Left)));
    assert!(
        table.bottom().contains("[(no material)]"),
        "{}",
        table.bottom()
    );
    let before = table.program.wish();
    table.key("I");
    let after = table.program.wish();
    assert!(after.materials != before.materials && after.lights == before.lights);
}

#[test]
fn late_pictures_and_late_scenes_are_not_shown() {
    let mut table = Table::new((40, 12));
    table.draw();
    let drawn = table.program.drawn.clone().unwrap();
    table.program.drawn = None;
    let late = table.program.wishes;
    let arrives = |number| Message::Drawn {
        number,
        drawn: Box::new(drawn.clone()),
    };
    // While something moves, the last picture but one is better than none.
    table.key("Tab");
    table.key("i");
    table.take(arrives(late));
    assert!(table.program.drawn.is_some());
    table.program.drawn = None;
    table.take(Message::Input(Input::Resize {
        columns: 20,
        rows: 6,
    }));
    table.take(arrives(late + 1));
    assert!(table.program.drawn.is_none(), "of another size");
    let renderer = Renderer::new(table.program.scene.clone(), None);
    table.take(Message::Prepared {
        number: 99,
        renderer: Box::new(renderer),
    });
    assert!(table.effects.is_empty());
}

#[test]
fn a_bake_is_told_and_a_picture_waits_for_it() {
    let mut table = Table::new((120, 12));
    table.take(Message::Baking {
        stage: "transfer",
        share: 0.42,
    });
    assert!(
        table
            .program
            .cells()
            .lines()
            .iter()
            .any(|line| line.contains("transfer 42 %"))
    );
    table.key("P");
    assert!(table.effects.is_empty() && table.bottom().contains("the bake is not ready"));
    table.take(Message::NotPrepared {
        number: 1,
        error: "no basis".to_owned(),
    });
    assert!(table.bottom().contains("no basis"));
}
