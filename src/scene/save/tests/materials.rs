//! How materials reflect, with and without a `brdf` of the file.

use super::*;

/// The room with a wall that is said to be plastic.
fn plastic_wall(more: &str) -> String {
    format!(
        "{SCENE}\n[[material]]\nname = \"wall\" # the left one\nbrdf = \"plastic\" # a toy's\n\
         emission = [0, 0, 0]\n{more}"
    )
}

#[test]
fn only_keys_that_changed_are_written() {
    let new = save(SCENE, |scene| {
        scene.materials[0].specular = Vec3::splat(0.04);
        scene.materials[0].roughness = Some(0.55);
        scene.materials[1].roughness = Some(0.25);
    });
    let floor =
        "\n[[material]]\nname = \"floor\"\nspecular = [0.04, 0.04, 0.04]\nroughness = 0.55\n";
    let wall = "\n[[material]]\nname = \"wall\"\nroughness = 0.25\n";
    assert_eq!(new, format!("{SCENE}{floor}{wall}"));
    let again = save(&new, |scene| {
        scene.materials[0].specular.y = 0.5;
        scene.materials[1].albedo = Vec3::ONE;
    });
    let expected = with(
        &new,
        &[
            ["[0.04, 0.04, 0.04]", "[0.04, 0.5, 0.04]"],
            [
                "roughness = 0.25\n",
                "roughness = 0.25\nalbedo = [1.0, 1.0, 1.0]\n",
            ],
        ],
    );
    assert_eq!(again, expected);
}

#[test]
fn a_brdf_stays_under_another_roughness() {
    let text = plastic_wall("");
    let new = save(&text, |scene| scene.materials[1].roughness = Some(0.4));
    let emission = "emission = [0, 0, 0]\n";
    let expected = with(
        &text,
        &[[emission, &format!("{emission}roughness = 0.4\n")]],
    );
    assert_eq!(new, expected);
}

#[test]
fn other_colours_stand_where_the_brdf_stood() {
    let metal = |scene: &mut Scene| {
        let wall = &mut scene.materials[1];
        (wall.albedo, wall.specular) = (Vec3::ZERO, wall.albedo);
    };
    let text = plastic_wall("");
    let emission = "emission = [0, 0, 0]\n";
    let expected = with(
        &text,
        &[
            [
                "brdf = \"plastic\" # a toy's",
                "albedo = [0.0, 0.0, 0.0] # a toy's",
            ],
            [
                emission,
                &format!("{emission}specular = [0.25, 0.25, 0.25]\nroughness = 0.3\n"),
            ],
        ],
    );
    assert_eq!(save(&text, metal), expected);
    // Where all three keys are there already, its line goes.
    let keys = "albedo = [0.5, 0.5, 0.5]\nspecular = [0.1, 0.1, 0.1] # weak\nroughness = 0.2\n";
    let new = save(&plastic_wall(keys), |scene| {
        scene.materials[1].albedo.x = 0.75;
    });
    let expected = with(
        &plastic_wall(keys),
        &[
            ["brdf = \"plastic\" # a toy's\n", ""],
            ["[0.5, 0.5, 0.5]\nspecular", "[0.75, 0.5, 0.5]\nspecular"],
        ],
    );
    assert_eq!(new, expected);
    let inline = format!("material = [{{ name = 'wall', brdf = 'satin' }}] # all\n{SCENE}");
    let new = save(&inline, metal);
    let keys = "albedo = [0.0, 0.0, 0.0], specular = [0.25, 0.25, 0.25], roughness = 0.55 }] # all";
    assert!(new.contains(keys), "{new}");
}

#[test]
fn a_brdf_of_an_override_does_not_win_over_an_edit() {
    let sets = [
        "material.wall.brdf=\"brushed metal\"",
        "material.floor.brdf=satin",
        "material.wall.emission=[1, 1, 1]",
    ];
    let (new, left) = save_under(SCENE, &sets, |scene| {
        scene.materials[1].specular = Vec3::splat(0.5);
        scene.materials[0].roughness = Some(0.6);
    })
    .unwrap();
    let wall =
        "name = \"wall\"\nalbedo = [0.0, 0.0, 0.0]\nspecular = [0.5, 0.5, 0.5]\nroughness = 0.5\n";
    assert!(new.contains(wall), "{new}");
    assert!(new.contains("name = \"floor\"\nroughness = 0.6\n"), "{new}");
    let kept = sets[1..].iter().map(|set| Override::parse(set).unwrap());
    let targets = |sets: &[Override]| {
        let targets = sets.iter().map(|set| set.target().clone());
        targets.collect::<Vec<_>>()
    };
    assert_eq!(targets(&left), targets(&kept.collect::<Vec<_>>()));
}

#[test]
fn a_brdf_that_would_win_is_not_given_out() {
    let loaded = load(SCENE.as_bytes(), &[]);
    let mut edited = loaded.clone();
    edited.materials[1].albedo = Vec3::splat(0.125);
    let [loaded, edited] = [loaded, edited].map(|scene| Parts::of(&scene));
    let finder = files();
    let finder = Finder::new(&finder);
    let text = plastic_wall("albedo = [0.125, 0.125, 0.125]\n");
    let read = Document::parse(&text, Path::new("s.toml"), &[], &Images::new(&finder)).unwrap();
    let error = check(&read, loaded.edited(), edited.edited()).unwrap_err();
    assert!(error.to_string().contains("a material"), "{error}");
}
