//! What the program asks for, message by message, without a terminal.

mod files;
mod overrides;
mod surfaces;

use std::fs;

use super::*;
use crate::bake::RunSettings;
use crate::preview::input::{Action, Button, Held, Key, Mouse};
use crate::preview::painter::{Painter, Sharpness};
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
    /// The pictures of the last time that something was drawn.
    drawn: Vec<Look>,
}

/// A picture, and what the program asked to be prepared when it came.
struct Look {
    sharpness: Sharpness,
    prepare: Option<(u64, bool)>,
}

impl Table {
    fn new(size: (u16, u16)) -> Self {
        Self::under(size, &[])
    }

    /// With overrides.
    fn under(size: (u16, u16), sets: &[&str]) -> Self {
        let overrides = sets.iter().map(|set| Override::parse(set).unwrap());
        let overrides: Vec<Override> = overrides.collect();
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("floor.obj"), MESH).unwrap();
        let path = folder.path().join("scene.toml");
        fs::write(&path, SCENE).unwrap();
        let loaded = load(&path, &overrides);
        let file = SceneFile {
            path,
            overrides,
            bytes: loaded.bytes,
        };
        let scene = *loaded.scene.unwrap();
        let (program, effects) = Program::start(file, scene, loaded.at, (size, None));
        Self {
            program,
            folder,
            effects,
            drawn: Vec::new(),
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
        self.read();
    }

    /// What the program has asked to be read.
    fn read(&mut self) {
        let number = self.load_asked().expect("it asks for the files");
        let loaded = load(&self.path(), self.program.overrides());
        self.take(Message::Loaded { number, loaded });
    }

    fn load_asked(&self) -> Option<u64> {
        self.effects.iter().find_map(|effect| match effect {
            Effect::Load(number) => Some(*number),
            _ => None,
        })
    }

    /// The number and the bake of the scene that is to be prepared.
    fn prepare_asked(&self) -> Option<(u64, bool)> {
        self.effects.iter().find_map(|effect| match effect {
            Effect::Prepare(wanted, _) => Some((wanted.number, wanted.bake)),
            _ => None,
        })
    }

    /// A renderer of the scene arrives, without a bake.
    fn prepared(&mut self, number: u64) {
        let renderer = Box::new(Renderer::new(self.program.scene.clone(), None));
        self.take(Message::Prepared { number, renderer });
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
        self.drawn.clear();
        let mut painter = Painter::new(Renderer::new(self.program.scene.clone(), None));
        let run = RunSettings::silent();
        while let Some(drawn) = painter.next(&self.program.wish(), &run).unwrap() {
            let sharpness = drawn.sharpness;
            self.take(Message::Drawn {
                number: self.program.wishes,
                drawn: Box::new(drawn),
            });
            let prepare = self.prepare_asked();
            self.drawn.push(Look { sharpness, prepare });
        }
    }
}

#[test]
fn it_begins_with_a_scene_to_prepare_files_to_watch_and_a_wish() {
    let table = Table::new((80, 24));
    assert_eq!(table.prepare_asked(), Some((1, false)));
    assert!(table.asks(|it| matches!(it, Effect::Show(1, _))));
    let has_mesh = |it: &Watched| it.files.iter().any(|file| file.ends_with("floor.obj"));
    assert!(table.asks(|it| matches!(it, Effect::Watch(watched) if has_mesh(watched))));
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

fn mouse(action: Action, column: u16, row: u16) -> Message {
    Message::Input(Input::Mouse(Mouse {
        action,
        column,
        row,
        held: Held::NONE,
    }))
}

#[test]
fn a_click_selects_what_is_seen_there() {
    let mut table = Table::new((60, 31));
    table.draw();
    table.take(mouse(Action::Press(Button::Left), 30, 26));
    table.take(mouse(Action::Release(Button::Left), 30, 26));
    let bottom = table.bottom();
    assert!(bottom.contains("[(no material)]"), "{bottom}");
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
        number: 1,
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

#[test]
fn a_scene_that_comes_to_need_a_bake_gets_one() {
    let mut table = Table::new((60, 12));
    table.prepared(1);
    table.draw();
    assert_eq!(table.prepare_asked(), None, "no bounces, no bake");
    table.key("+");
    table.draw();
    let asked: Vec<_> = table.drawn.iter().filter_map(|it| it.prepare).collect();
    assert_eq!(asked, [(2, true)], "once, whatever the file asks for");
    table.key("P");
    assert!(table.effects.is_empty() && table.bottom().contains("the bake is not ready"));
    // One that fails is not made again and again.
    table.take(Message::NotPrepared {
        number: 2,
        error: "no".to_owned(),
    });
    table.key("+");
    table.draw();
    assert!(table.drawn.iter().all(|it| it.prepare.is_none()));
}

#[test]
fn the_fine_picture_stays_where_nothing_changes() {
    let mut table = Table::new((20, 6));
    table.program.cell_px = Some((8, 16));
    table.key("e");
    table.draw();
    assert_eq!(
        table.drawn.last().map(|it| it.sharpness),
        Some(Sharpness::Fine)
    );
    assert!(table.program.pixel_picture().is_some());
    table.take(Message::Input(Input::Resize {
        columns: 20,
        rows: 6,
    }));
    assert!(
        !table.asks(|it| matches!(it, Effect::Show(..))),
        "the same size"
    );
    table.key("Tab");
    table.key("m");
    table.key("m");
    table.draw();
    assert!(table.program.pixel_picture().is_some());
}

#[test]
fn one_question_stands_at_a_time_and_saving_ends_in_the_end() {
    let mut table = Table::new((160, 12));
    table.key("Tab");
    table.key("i");
    table.key("q");
    fs::write(table.path(), SCENE.replace("vfov = 40.0", "vfov = 50.0")).unwrap();
    table.take(Message::FilesChanged);
    assert!(
        table.bottom().contains("unsaved changes"),
        "{}",
        table.bottom()
    );
    table.take(mouse(Action::Release(Button::Left), 1, 1));
    assert!(table.bottom().contains("unsaved changes"));
    table.key("s");
    assert!(
        table.bottom().contains("changed meanwhile"),
        "{}",
        table.bottom()
    );
    table.key("o");
    assert_eq!(table.quits(), Some(0));
    let mut table = Table::new((160, 12));
    table.key("Tab");
    table.key("i");
    table.key("q");
    table.take(Message::FilesChanged);
    assert_eq!(table.load_asked(), None);
    table.key("Esc");
    assert!(table.load_asked().is_some(), "it has waited");
}
