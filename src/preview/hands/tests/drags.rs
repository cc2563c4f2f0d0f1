//! What the mouse does.

use super::*;

#[test]
fn a_dragged_light_stays_under_the_pointer_and_at_its_depth() {
    for (index, held) in [(0, Held::NONE), (1, Held::NONE), (3, Held::NONE)] {
        let mut room = Room::new();
        let eye = room.view.eye(&room.hands.document().camera);
        let before = eye.project(room.position(index));
        let [column, row] = room.cell_of(index);
        room.drag(Button::Left, held, &[[column, row], [column - 4, row + 3]]);
        let after = eye.project(room.position(index));
        assert!((after.depth - before.depth).abs() < 1e-6, "{index}");
        let by = after.px - before.px;
        assert!(
            (by - DVec2::new(-4.0, 6.0)).length() < 1e-4,
            "{index}: {by}"
        );
    }
}

#[test]
fn ctrl_alt_shift_and_the_right_button_drag_along_the_view() {
    let alt = Held {
        alt: true,
        ..Held::NONE
    };
    for (button, held) in [(Button::Right, Held::NONE), (Button::Left, alt)] {
        let mut room = Room::new();
        let eye = room.view.eye(&room.hands.document().camera);
        let before = eye.project(room.position(0));
        let [column, row] = room.cell_of(0);
        room.drag(button, held, &[[column, row], [column, row - 2]]);
        let after = eye.project(room.position(0));
        assert!((after.px - before.px).length() < 1e-4);
        assert!(after.depth > before.depth * 1.2);
    }
}

#[test]
fn a_sun_follows_the_pointer_and_a_sky_turns() {
    let mut room = Room::new();
    let [column, row] = room.cell_of(2);
    let before = room.hands.marks(&room.view)[2].px;
    room.drag(
        Button::Left,
        Held::NONE,
        &[[column, row], [column + 3, row + 1]],
    );
    let by = room.hands.marks(&room.view)[2].px - before;
    assert!((by - DVec2::new(3.0, 2.0)).length() < 1e-3, "{by}");
    let [column, row] = room.cell_of(4);
    room.drag(
        Button::Left,
        Held::NONE,
        &[[column, row], [column - 4, row]],
    );
    let LightKind::Environment(sky) = room.light(4) else {
        panic!()
    };
    assert_eq!(sky.rotation_deg, 6.0, "36 degrees on from -30");
}

#[test]
fn clicks_select_marks_then_surfaces_and_drags_elsewhere_orbit() {
    let mut room = Room::new();
    let click = |room: &mut Room, cell| {
        room.mouse(Action::Press(Button::Left), cell, Held::NONE);
        room.mouse(Action::Release(Button::Left), cell, Held::NONE)
    };
    let cell = room.cell_of(0);
    click(&mut room, cell);
    assert_eq!(room.hands.selection(), Selection::Light(0));
    click(&mut room, [30, 13]);
    assert_eq!(room.hands.selection(), Selection::Surface(1));
    room.keys("I");
    let reflections = &room.hands.document().reflections;
    assert!(reflections[1].albedo.x < room.scene.materials[1].albedo.x);
    click(&mut room, [4, 14]);
    assert_eq!(room.hands.selection(), Selection::Nothing);
    let camera = room.hands.document().camera;
    room.drag(Button::Left, Held::NONE, &[[4, 14], [8, 14]]);
    let orbited = room.hands.document().camera;
    assert!(orbited.position != camera.position && orbited.target == camera.target);
    room.drag(Button::Middle, Held::NONE, &[[4, 14], [8, 14]]);
    assert!(room.hands.document().camera.target != camera.target);
    room.mouse(Action::ScrollUp, [8, 8], Held::NONE);
    room.keys("v");
    assert_eq!(room.hands.document().camera, camera);
    assert_eq!(
        room.mouse(Action::Press(Button::Left), [60, 14], Held::NONE),
        Outcome::default()
    );
}

#[test]
fn a_drag_that_begins_without_effect_is_undone_too() {
    let mut room = Room::new();
    let sky = room.cell_of(4);
    // Up and down turns no sky.
    let cells = [sky, [sky[0], sky[1] + 1], [sky[0] - 3, sky[1] + 1]];
    room.drag(Button::Left, Held::NONE, &cells);
    assert!(room.hands.is_unsaved());
    room.keys("u");
    assert!(!room.hands.is_unsaved());
}
