//! The `--set` overrides of a scene whose file is written: one holds until the file
//! gives its key as it was edited.

use crate::scene::Override;
use crate::scene::file::Target;

/// The overrides that hold so far.
pub(super) struct InForce {
    overrides: Vec<Override>,
}

impl InForce {
    pub(super) fn new(overrides: &[Override]) -> Self {
        Self {
            overrides: overrides.to_vec(),
        }
    }

    pub(super) fn into_overrides(self) -> Vec<Override> {
        self.overrides
    }

    /// The one of these keys of a light that an override gives; of several the
    /// last, which is the one that counts.
    pub(super) fn given<'k>(&self, light: &str, keys: &[&'k str]) -> Option<&'k str> {
        let last_first = self.overrides.iter().rev();
        let mut given = last_first.filter_map(|set| {
            let mut keys = keys.iter();
            keys.find(|key| is_of_entry(set, "light", light, key))
        });
        given.next().copied()
    }

    /// Whether an override gives a key of a light or a material.
    pub(super) fn gives(&self, list: &str, name: &str, key: &str) -> bool {
        let mut overrides = self.overrides.iter();
        overrides.any(|set| is_of_entry(set, list, name, key))
    }

    /// The file gives a key of a section from now on.
    pub(super) fn settle_section(&mut self, section: &str, key: &str) {
        let target = Target::Section {
            section: section.to_owned(),
            key: key.to_owned(),
        };
        self.overrides.retain(|set| *set.target() != target);
    }

    /// The file gives a key of a light or a material from now on.
    pub(super) fn settle_entry(&mut self, list: &str, name: &str, key: &str) {
        self.overrides
            .retain(|set| !is_of_entry(set, list, name, key));
    }

    /// The file gives all of a light from now on but for keys that are `still`
    /// given by overrides; or it gives the light no more.
    pub(super) fn settle_light(&mut self, name: &str, still: &[&str]) {
        self.overrides.retain(|set| {
            let is_still = |key: &&str| is_of_entry(set, "light", name, key);
            set.light_name() != Some(name) || still.iter().any(is_still)
        });
    }
}

fn is_of_entry(set: &Override, of_list: &str, of_name: &str, of_key: &str) -> bool {
    matches!(
        set.target(),
        Target::Named { list, name, key } if list == of_list && name == of_name && key == of_key
    )
}
