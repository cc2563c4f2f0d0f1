//! Lights that come and go, in every layout of lists.

use super::*;

#[test]
fn lights_go_with_their_own_comments() {
    let new = save(SCENE, |scene| drop(scene.lights.remove(0)));
    let start = SCENE.find("# The lamp hangs").unwrap();
    let end = SCENE.find("# A spot without").unwrap();
    let without = format!("{}{}", &SCENE[..start], &SCENE[end..]);
    // The spot was the second light and keeps the name it had by that.
    let expected = with(
        &without,
        &[[
            "[[light]]\n  kind",
            "[[light]]\n  name = \"light2\"\n  kind",
        ]],
    );
    assert_eq!(new, expected);

    let new = save(SCENE, |scene| drop(scene.lights.remove(1)));
    let start = SCENE.find("# A spot without").unwrap();
    let end = SCENE.find("# The sky comes last").unwrap();
    assert_eq!(new, format!("{}{}", &SCENE[..start], &SCENE[end..]));

    let text = SCENE.split("\n# What frames").next().unwrap();
    let last = text.find("# The sky comes last").unwrap();
    let new = save(text, |scene| drop(scene.lights.pop()));
    assert_eq!(new, text[..last]);
    let new = save(text.trim_end(), |scene| drop(scene.lights.pop()));
    assert_eq!(new, text[..last].trim_end());
    let new = save(text, |scene| scene.lights.clear());
    assert_eq!(
        new,
        format!(
            "{}\n",
            text[..text.find("\n# The lamp").unwrap()].trim_end()
        )
    );
}

#[test]
fn tables_in_braces_and_keys_with_dots_stay_so() {
    let text = "mesh = 'm.obj'\ncamera.position = [0, 0, 5] # eye\ncamera.target = [0, 0, 0]\n\
                camera.vfov = 40\ncamera.size = [8, 8]\n\
                light = [{ kind = 'point', position = [0, 0, 1], intensity = [1, 1, 1] }, {kind='environment',radiance=[1,1,1]}] # two\n\
                render = { bounces = 1 }\nmaterial = [{ name = 'floor' }]\n";
    let new = save(text, |scene| {
        scene.camera.position.z = 4.5;
        scene.camera.up = DVec3::X;
        point(&mut scene.lights[0]).position.z = 2.0;
        scene.render.exposure = 1.0;
        scene.materials[0].albedo = Vec3::ONE;
        scene.lights.push(lamp("new"));
    });
    let expected = with(
        text,
        &[
            ["[0, 0, 5]", "[0, 0, 4.5]"],
            [
                "camera.size = [8, 8]\n",
                "camera.size = [8, 8]\ncamera.up = [1.0, 0.0, 0.0]\n",
            ],
            ["position = [0, 0, 1]", "position = [0, 0, 2.0]"],
            [
                "radiance=[1,1,1]}]",
                "radiance=[1,1,1]}, { name = \"new\", kind = \"point\", \
                 position = [0.1, 1.0, 0.0], intensity = [2.5, 2.5, 2.5] }]",
            ],
            ["{ bounces = 1 }", "{ bounces = 1, exposure = 1.0 }"],
            [
                "{ name = 'floor' }",
                "{ name = 'floor', albedo = [1.0, 1.0, 1.0] }",
            ],
        ],
    );
    assert_eq!(new, expected);
    let new = save(text, |scene| drop(scene.lights.remove(1)));
    assert_eq!(
        new,
        with(text, &[[", {kind='environment',radiance=[1,1,1]}", ""]])
    );
    let new = save(text, |scene| drop(scene.lights.remove(0)));
    let first = "{ kind = 'point', position = [0, 0, 1], intensity = [1, 1, 1] }, ";
    assert_eq!(
        new,
        with(
            text,
            &[
                [first, ""],
                ["radiance=[1,1,1]}", "radiance=[1,1,1], name = \"light2\"}"]
            ]
        )
    );
    let new = save(text, |scene| {
        scene.lights.clear();
        scene.lights.push(lamp("light1"));
    });
    assert!(
        new.contains("light = [{ kind = 'point', position = [0.1, 1.0, 0.0]"),
        "{new}"
    );
    let new = save(text, |scene| scene.lights.clear());
    assert!(new.contains("light = [] # two\n"), "{new}");
}

#[test]
fn lists_in_braces_over_several_lines_keep_their_comments() {
    let light = |name: &str| {
        format!(
            "{{ name = '{name}', kind = 'point', position = [0, 0, 1], intensity = [1, 1, 1] }}"
        )
    };
    let [a, b, c] = ["a", "b", "c"].map(light);
    let text = format!(
        "mesh = 'm.obj'\ncamera = {{ position = [0, 0, 5], target = [0, 0, 0], vfov = 40, size = [8, 8] }}\n\
         light = [ # all\n  # left\n  {a}, # A\n  # middle\n  {b}, # B\n  {c} # C\n]\n"
    );
    let new = save(&text, |scene| drop(scene.lights.remove(1)));
    assert_eq!(
        new,
        with(&text, &[[&format!("  # middle\n  {b}, # B\n"), ""]])
    );
    let added = "{ name = \"new\", kind = \"point\", position = [0.1, 1.0, 0.0], intensity = [2.5, 2.5, 2.5] }";
    let new = save(&text, |scene| scene.lights.push(lamp("new")));
    assert_eq!(
        new,
        with(
            &text,
            &[[&format!("  {c} # C\n"), &format!("  {c}, # C\n  {added}\n")]]
        )
    );
    let new = save(&text, |scene| {
        scene.lights.pop();
        scene.lights.push(lamp("new"));
    });
    assert_eq!(
        new,
        with(
            &text,
            &[[&format!("  {c} # C\n"), &format!("  {added},\n")]]
        )
    );
    let new = save(&text, |scene| scene.lights.clear());
    assert!(new.ends_with("light = [ # all\n]\n"), "{new}");
}

#[test]
fn an_empty_line_parts_new_lights_from_what_follows() {
    let text = SCENE.replace(
        "radiance = [0.1, 0.1, 0.1]\n\n# What frames are like.\n",
        "radiance = [0.1, 0.1, 0.1]\n",
    );
    let sky = Light {
        name: "new".to_owned(),
        kind: LightKind::Environment(crate::scene::Environment {
            radiance: crate::scene::Radiance::Constant(Vec3::ONE),
            scale: 1.0,
            rotation_deg: 0.0,
        }),
    };
    let new = save(&text, |scene| scene.lights.push(sky.clone()));
    let block = "\n[[light]]\nname = \"new\"\nkind = \"environment\"\nradiance = [1.0, 1.0, 1.0]\n\n[render]";
    assert_eq!(new, with(&text, &[["[render]", block]]));
}

#[test]
fn lights_in_the_middle_are_written_between_the_others() {
    let block = "[[light]]\nname = \"new\"\nkind = \"point\"\nposition = [0.1, 1.0, 0.0]\n\
                 intensity = [2.5, 2.5, 2.5]\n";
    let new = save(SCENE, |scene| scene.lights.insert(0, lamp("new")));
    let named = [
        "[[light]]\n  kind",
        "[[light]]\n  name = \"light2\"\n  kind",
    ];
    let first = ["# The lamp hangs", &format!("{block}\n# The lamp hangs")];
    assert_eq!(new, with(SCENE, &[first, named]));
    let new = save(SCENE, |scene| scene.lights.insert(1, lamp("new")));
    let between = [
        "\n# A spot without",
        &format!("\n{block}\n# A spot without"),
    ];
    assert_eq!(new, with(SCENE, &[between, named]));
    let new = save(SCENE, |scene| scene.lights.rotate_left(1));
    assert!(new.find("Глобус") < new.find("\"lamp\""), "{new}");
    assert!(new.contains("# the floor"), "{new}");
    for at in 0..3 {
        let list = "mesh = 'm.obj'\ncamera = { position = [0, 0, 5], target = [0, 0, 0], vfov = 40, size = [8, 8] }\n\
            light = [A{name='a',kind='environment',radiance=[1,1,1]},B{name='b',kind='environment',radiance=[1,1,1]}C]\n";
        for [a, b, c] in [
            ["", " ", ""],
            ["\n  # a\n  ", " # A\n  ", " # B\n"],
            ["", "\n", ",\n"],
        ] {
            let text = list
                .replace("[A{", &format!("[{a}{{"))
                .replace(",B{", &format!(",{b}{{"));
            let text = text.replace("}C]", &format!("}}{c}]"));
            save(&text, |scene| scene.lights.insert(at, lamp("new")));
            save(&text, |scene| {
                scene.lights.swap(0, 1);
                scene.lights.insert(at, lamp("new"));
            });
            save(&text, |scene| drop(scene.lights.remove(at / 2)));
        }
    }
}
