//! What `--set` gives and what is edited, side by side.

use super::*;

/// A spot whose target has more decimals than a target needs.
const LONG: &str = r#"mesh = "m.obj"
[camera]
position = [0.0, 1.0, 6.8]
target = [0.0, 1.0, 0.0]
vfov = 39.3
size = [64, 48]
[[light]]
name = "s"
kind = "spot"
position = [0.1, 2.0, 0.7]
target = [0.33333333333333, 0.123456789, 0.05] # there
intensity = [1.0, 1.0, 1.0]
"#;

/// How overrides begin, to say which are left.
fn saved(text: &str, sets: &[&str], edit: impl Fn(&mut Scene)) -> (String, Vec<String>) {
    let (new, left) = save_under(text, sets, edit).unwrap();
    let left = sets.iter().filter(|set| {
        let target = Override::parse(set).unwrap();
        left.iter().any(|left| left.target() == target.target())
    });
    (new, left.map(|set| (*set).to_owned()).collect())
}

#[test]
fn values_of_overrides_stay_out_of_the_file() {
    let sets = [
        "light.lamp.position=[9, 9, 9]",
        "camera.vfov=80",
        "render.exposure=3",
        "material.wall.albedo=[1, 0, 0]",
    ];
    let new = save_with(SCENE, &sets, |scene| {
        point(&mut scene.lights[0]).intensity = Vec3::ONE;
    });
    let expected = with(SCENE, &[["[3.3, 2.9, 2.3]", "[1.0, 1.0, 1.0]"]]);
    assert_eq!(new.unwrap(), expected);
    let new = save_with(SCENE, &sets, |scene| scene.camera.vfov_deg = 70.0);
    assert_eq!(new.unwrap(), with(SCENE, &[["39.3", "70.0"]]));
    let new = save_with(
        SCENE,
        &["light.lamp.kind=spot", "light.lamp.target=[0, 0, 0]"],
        |scene| {
            let spot = spot(&mut scene.lights[0]);
            (spot.cutoff_deg, spot.beam_deg) = (20.0, 5.0);
        },
    );
    let read = load(new.unwrap().as_bytes(), &[]);
    assert!(matches!(
        read.lights[0].kind,
        LightKind::Spot(Spot {
            cutoff_deg: 20.0,
            ..
        })
    ));
    let new = save_with(SCENE, &sets, |scene| drop(scene.lights.remove(0)));
    assert!(new.is_ok(), "an override of a light that is gone");
}

#[test]
fn a_target_stays_digit_by_digit_while_another_key_is_edited() {
    let brighter = |scene: &mut Scene| spot(&mut scene.lights[0]).intensity = Vec3::splat(2.0);
    let wider = |scene: &mut Scene| spot(&mut scene.lights[0]).cutoff_deg = 40.0;
    let bright = with(LONG, &[["[1.0, 1.0, 1.0]", "[2.0, 2.0, 2.0]"]]);
    assert_eq!(save(LONG, brighter), bright);
    let there = "[0.33333333333333, 0.123456789, 0.05] # there\n";
    assert!(save(LONG, wider).contains(there));
    for set in [
        "light.s.target=[0.9, 0.9, 0.1]",
        "light.s.direction=[0, 0, 1]",
        "light.s.position=[0, 3, 0]",
    ] {
        let expected = (bright.clone(), vec![set.to_owned()]);
        assert_eq!(saved(LONG, &[set], brighter), expected, "{set}");
    }
}

#[test]
fn what_aims_a_spot_is_written_whole_or_not_at_all() {
    let moved = |scene: &mut Scene| spot(&mut scene.lights[0]).position.x = 0.5;
    let turned = |scene: &mut Scene| spot(&mut scene.lights[0]).direction = Vec3::NEG_Y;
    // A spot that moves keeps the direction that the override gave it.
    let set = "light.s.target=[0.1, 0.0, 0.7]";
    let (new, left) = saved(LONG, &[set], moved);
    let read = &load(new.as_bytes(), &[]).lights[0];
    let LightKind::Spot(read) = read.kind else {
        panic!("{read:?}")
    };
    assert_eq!(read.direction, Vec3::NEG_Y);
    assert!(left.is_empty() && new.contains(" # there"), "{new}");
    // A direction stays whatever moves.
    let set = "light.s.direction=[0, 0, 1]";
    let expected = with(LONG, &[["[0.1, 2.0, 0.7]", "[0.5, 2.0, 0.7]"]]);
    assert_eq!(saved(LONG, &[set], moved), (expected, vec![set.to_owned()]));
    let (new, left) = saved(LONG, &[set], turned);
    assert!(left.is_empty() && new.contains("target = [0.1, "), "{new}");
    // A target would be right for the override's position alone.
    let set = "light.s.position=[0, 3, 0]";
    let (new, left) = saved(LONG, &[set], turned);
    assert!(
        new.contains("direction = [0.0, -1.0, 0.0] # there"),
        "{new}"
    );
    assert_eq!(left, [set]);
}

#[test]
fn a_key_that_was_edited_and_saved_has_no_override_any_more() {
    let sets = [
        "light.lamp.intensity=[9, 9, 9]",
        "light.lamp.position=[0, 1, 0]",
        "camera.vfov=80",
        "camera.size=[32, 32]",
        "render.exposure=3",
        "material.wall.albedo=[1, 0, 0]",
        "material.floor.albedo=[0, 0, 1]",
        "bake.max_edge=0.5",
    ];
    let (_, left) = saved(SCENE, &sets, |scene| {
        point(&mut scene.lights[0]).intensity = Vec3::splat(2.0);
        scene.camera.vfov_deg = 70.0;
        scene.render.exposure = 1.0;
        scene.materials[1].albedo = Vec3::splat(0.3);
    });
    assert_eq!(left, [sets[1], sets[3], sets[6], sets[7]]);
    // What the file says already is not written, and holds all the same.
    let (new, left) = saved(SCENE, &sets[..1], |scene| {
        point(&mut scene.lights[0]).intensity = Vec3::new(3.3, 2.9, 2.3);
    });
    assert_eq!((new.as_str(), left.len()), (SCENE, 0));
}

#[test]
fn a_light_that_is_gone_or_new_has_no_overrides() {
    let sets = [
        "light.lamp.intensity=[9, 9, 9]",
        "light.light2.intensity=[2, 2, 2]",
    ];
    let (_, left) = saved(SCENE, &sets, |scene| drop(scene.lights.remove(0)));
    assert_eq!(left, [sets[1]]);
    let (new, left) = saved(SCENE, &sets, |scene| {
        scene.lights[0].kind = scene.lights[1].kind.clone();
    });
    assert_eq!(left, [sets[1]]);
    assert!(new.contains("name = \"lamp\"\nkind = \"spot\""), "{new}");
}

#[test]
fn a_cone_is_whole_with_and_without_overrides() {
    let angle = |cutoff_deg: f32, beam_deg: f32| {
        move |scene: &mut Scene| {
            let spot = spot(&mut scene.lights[0]);
            (spot.cutoff_deg, spot.beam_deg) = (cutoff_deg, beam_deg);
        }
    };
    // The file gives no cutoff, so that its own would be less than this beam.
    let (new, left) = saved(LONG, &["light.s.cutoff=80"], angle(80.0, 45.0));
    assert!(left.is_empty());
    assert!(new.contains("beam = 45.0\ncutoff = 80.0"), "{new}");
    // The override's beam stays out of the file.
    let (new, left) = saved(LONG, &["light.s.beam=10"], angle(50.0, 10.0));
    assert!(!new.contains("beam") && left.len() == 1, "{new}");
}

#[test]
fn a_light_that_an_override_made_another_kind_becomes_it_in_the_file() {
    let sets = ["light.lamp.kind=spot", "light.lamp.target=[0, 0, 0.3]"];
    let (new, left) = saved(SCENE, &sets, |scene| {
        spot(&mut scene.lights[0]).intensity = Vec3::ONE;
    });
    assert!(left.is_empty());
    let read = &load(new.as_bytes(), &[]).lights[0].kind;
    let LightKind::Spot(read) = read else {
        panic!("{read:?}")
    };
    assert_eq!((read.direction, read.intensity), (Vec3::NEG_Y, Vec3::ONE));
}

#[test]
fn other_values_are_not_given_out() {
    let loaded = load(SCENE.as_bytes(), &[]);
    let parts = Parts::of(&loaded);
    let finder = files();
    let finder = Finder::new(&finder);
    let read = |text: &str| {
        Document::parse(text, Path::new("s.toml"), &[], &Images::new(&finder)).unwrap()
    };
    let says = |text: &str, edited: &Parts| {
        let checked = check(&read(text), parts.edited(), edited.edited());
        checked.err().map(|error| error.to_string())
    };
    assert_eq!(says(SCENE, &parts), None);
    let mut darker = loaded.clone();
    darker.materials[1].albedo = Vec3::splat(0.125);
    let darker = Parts::of(&darker);
    let painted = format!("{SCENE}[[material]]\nname = \"wall\"\nalbedo = [0.125, 0.125, 0.125]\n");
    assert!(says(SCENE, &darker).unwrap().contains("a material"));
    assert_eq!(says(&painted, &darker), None);
    assert!(says(&painted, &parts).unwrap().contains("a material"));
    let moved = SCENE.replace("1.5, # y", "1.25, # y");
    assert!(says(&moved, &parts).unwrap().contains("a light"));
}
