//! `[[animate]]`: a key of the scene that changes linearly between frames.

use super::fields::{Fields, LARGEST, key_error, number_of};
use super::target::Target;
use super::tree::{Node, Table, Value};
use crate::scene::place::Place;
use crate::scene::{Animation, SceneError};

const KEYS: [&str; 3] = ["target", "frames", "values"];

/// Sections whose keys can change from frame to frame.
const MOVING: [&str; 2] = ["camera", "render"];

/// Keys of those sections that are settings, not quantities.
const FIXED: [&str; 3] = ["size", "bounces", "light_samples"];

/// The material that an animation changes, and where it is named.
type NamedMaterial = Option<(String, Place)>;

/// Reads an entry. Each value is checked by grafting it onto the tree and
/// reading the whole scene file as it is at that frame, so an animated key
/// obeys the same rules as a written one.
pub(super) fn read(
    mut fields: Fields,
    table: &Table,
    check: &dyn Fn(Table) -> Result<(), SceneError>,
) -> Result<(Animation, NamedMaterial), SceneError> {
    fields.allow(&KEYS)?;
    let target_item = fields.require("target", "such as \"light.lamp.position\"")?;
    let path = target_item.name()?.to_owned();
    let target = Target::parse(&path)
        .and_then(|target| animatable(&target).map(|()| target))
        .map_err(|message| {
            let place = target_item.place();
            key_error(
                place,
                format!("`target` {path:?} cannot be animated: {message}"),
            )
        })?;
    let frames = frames(&mut fields)?;
    let values_item = fields.require("values", "one value a frame")?;
    let nodes = values_item.list()?;
    if nodes.len() != frames.len() {
        let allowed = format!(
            "a list of {} values, one for each of `frames`",
            frames.len()
        );
        return Err(values_item.error(&allowed));
    }
    let values = components_of_all(nodes).ok_or_else(|| {
        values_item.error("a list of numbers, or of equally long lists of numbers")
    })?;
    for node in nodes {
        let mut changed = table.clone();
        changed.graft(&target, node.clone())?;
        check(changed)?;
    }
    let material = match target {
        Target::Named { list, name, .. } if list == "material" => {
            Some((name, target_item.place().clone()))
        }
        _ => None,
    };
    let animation = Animation {
        target: path,
        frames,
        values,
    };
    Ok((animation, material))
}

fn animatable(target: &Target) -> Result<(), String> {
    match target {
        Target::Named { key, .. } if key == "name" || key == "kind" => {
            Err(format!("`{key}` is no quantity"))
        }
        Target::Named { .. } => Ok(()),
        Target::Section { section, key } if MOVING.contains(&section.as_str()) => {
            if FIXED.contains(&key.as_str()) {
                Err(format!("`{key}` is the same in all frames"))
            } else {
                Ok(())
            }
        }
        _ => Err("only keys of lights, materials, [camera] and [render] can".to_owned()),
    }
}

/// Frame numbers: at least one, each above the one before.
fn frames(fields: &mut Fields) -> Result<Vec<f64>, SceneError> {
    let item = fields.require("frames", "the numbers of the key frames")?;
    let allowed = "a list of numbers, each above the one before";
    let in_range = |node| number_of(node).filter(|x| (-LARGEST..=LARGEST).contains(x));
    let frames: Option<Vec<f64>> = item.list()?.iter().map(in_range).collect();
    frames
        .filter(|frames| !frames.is_empty() && frames.windows(2).all(|pair| pair[0] < pair[1]))
        .ok_or_else(|| item.error(allowed))
}

/// The components of every value, if all have equally many.
fn components_of_all(nodes: &[Node]) -> Option<Vec<Vec<f64>>> {
    let values: Vec<Vec<f64>> = nodes.iter().map(components).collect::<Option<_>>()?;
    let length = values.first()?.len();
    values
        .iter()
        .all(|value| value.len() == length)
        .then_some(values)
}

fn components(node: &Node) -> Option<Vec<f64>> {
    match &node.value {
        Value::Array(nodes) => nodes.iter().map(number_of).collect(),
        _ => number_of(node).map(|number| vec![number]),
    }
}
