//! `--set PATH=VALUE`: one key of the scene file, given on the command line.

use super::target::Target;
use super::tree::{Node, Table, Value, parse_value};
use crate::scene::SceneError;
use crate::scene::place::Place;

/// A key of the scene file with a value that replaces the file's.
///
/// ```
/// # use relume::Override;
/// Override::parse("light.lamp.position=[0, 1, 2]")?;
/// Override::parse("render.tone=filmic")?;
/// # Ok::<(), relume::SceneError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Override {
    target: Target,
    node: Node,
}

impl Override {
    /// Parses `PATH=VALUE`. The path is `light.NAME.KEY`, `material.NAME.KEY`,
    /// `camera.KEY`, `render.KEY`, `bake.KEY` or a key outside every section;
    /// the value is TOML. A word that is not TOML counts as a string.
    ///
    /// # Errors
    /// A text without `=`, an unknown section, a value that is not TOML.
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        let Some((path, value)) = split_at_equals(text) else {
            return Err(error(
                text,
                "must be PATH=VALUE, such as light.lamp.position=[0, 1, 2]",
            ));
        };
        let (path, value) = (path.trim(), value.trim());
        let target = Target::parse(path).map_err(|message| error(path, &message))?;
        let place = Place::Set { path: path.into() };
        let node = parse_value(value, &place).or_else(|message| {
            bare_word(value, &place).ok_or_else(|| {
                let message = format!(
                    "the value {value:?} is not valid TOML: {message}; put a string in quotes"
                );
                error(path, &message)
            })
        })?;
        Ok(Self { target, node })
    }

    /// The key that is replaced.
    pub(crate) fn target(&self) -> &Target {
        &self.target
    }

    /// The light whose key is replaced, if it is a light's.
    pub(crate) fn light_name(&self) -> Option<&str> {
        self.target.light_name()
    }

    /// Replaces the key in the tree.
    pub(crate) fn apply(&self, table: &mut Table) -> Result<(), SceneError> {
        table.graft(&self.target, self.node.clone())
    }
}

/// Splits at the first `=` outside quotes.
fn split_at_equals(text: &str) -> Option<(&str, &str)> {
    let mut quote = None;
    for (offset, character) in text.char_indices() {
        match (quote, character) {
            (None, '=') => return Some((&text[..offset], &text[offset + 1..])),
            (None, '"' | '\'') => quote = Some(character),
            (Some(open), _) if open == character => quote = None,
            _ => {}
        }
    }
    // A lone apostrophe of a name opens no quote.
    text.split_once('=')
}

/// A word that can only have been meant as a string: it starts like a name or
/// a path and holds nothing that has a meaning in TOML.
fn bare_word(value: &str, place: &Place) -> Option<Node> {
    let starts_well = value.starts_with(|c: char| c.is_alphabetic() || "_./".contains(c));
    let ambiguous = |c: char| c.is_whitespace() || c.is_control() || "[]{}\"'#=,\\".contains(c);
    let is_number = value.parse::<f64>().is_ok();
    (starts_well && !is_number && !value.contains(ambiguous)).then(|| Node {
        value: Value::String(value.to_owned()),
        place: place.clone(),
        written: format!("{value:?}"),
    })
}

fn error(path: &str, message: &str) -> SceneError {
    SceneError::Key {
        place: format!("--set {path}"),
        message: message.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_strings_where_nothing_else_fits() {
        let value = |text: &str| Override::parse(text).map(|set| set.node.value);
        assert!(matches!(value("render.tone=filmic"), Ok(Value::String(s)) if s == "filmic"));
        assert!(matches!(value("mesh = ../a/b.obj"), Ok(Value::String(s)) if s == "../a/b.obj"));
        assert!(matches!(value("render.bounces=3"), Ok(Value::Integer(3))));
        assert!(matches!(
            value("bake.fixed_albedo=true"),
            Ok(Value::Boolean(true))
        ));
        assert!(
            value("camera.vfov=.5").is_err(),
            "a number that TOML does not know"
        );
        assert!(value("camera.size=[640, 480").is_err());
        assert!(value("camera.position=1,2,3").is_err());
        assert!(value("camera.up=").is_err());
    }

    #[test]
    fn errors_say_which_argument() {
        let text = |argument| Override::parse(argument).unwrap_err().to_string();
        assert!(
            text("light.lamp.position")
                .starts_with("--set light.lamp.position: must be PATH=VALUE")
        );
        assert!(text("camera.position=[0 1]").starts_with("--set camera.position: the value"));
        assert!(text("lamp.x=1").contains("unknown section `lamp`"));
    }

    #[test]
    fn equals_signs_inside_quotes_belong_to_the_name() {
        assert_eq!(
            split_at_equals("material.\"a=b\".albedo=[1, 1, 1]"),
            Some(("material.\"a=b\".albedo", "[1, 1, 1]"))
        );
        assert_eq!(
            split_at_equals("light.it's.x=1"),
            Some(("light.it's.x", "1"))
        );
    }
}
