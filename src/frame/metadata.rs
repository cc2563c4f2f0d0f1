//! What an image file says of how it was made.

/// Entries of name and value, in the order in which they are written. They hold
/// neither a time nor a path: the same scene under the same settings gives the
/// same entries.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Metadata {
    entries: Vec<(String, String)>,
}

/// An entry in which two images differ.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MetadataDifference {
    /// Name of the entry.
    pub name: String,
    /// The reference's value; `None`: it has no such entry.
    pub reference: Option<String>,
    /// The candidate's value; `None`: it has no such entry.
    pub candidate: Option<String>,
}

impl Metadata {
    /// Name of the entry with the program and its version, which PNG and EXR
    /// both know (`Software`, `software`).
    pub const SOFTWARE: &'static str = "software";
    /// What the names of all other entries begin with, so that they are told
    /// from those of other programs.
    pub const PREFIX: &'static str = "relume:";

    /// The program and its version, and nothing else yet.
    pub fn of_program() -> Self {
        let version = concat!("relume ", env!("CARGO_PKG_VERSION"));
        let mut metadata = Self::default();
        metadata.set(Self::SOFTWARE, version);
        metadata
    }

    /// Sets an entry; one of the same name is replaced where it stands.
    pub fn set(&mut self, name: &str, value: impl Into<String>) {
        let value = value.into();
        match self.entries.iter_mut().find(|(known, _)| known == name) {
            Some(entry) => entry.1 = value,
            None => self.entries.push((name.to_owned(), value)),
        }
    }

    /// Sets an entry of relume's own: its name gets [`Self::PREFIX`].
    pub fn set_own(&mut self, name: &str, value: impl Into<String>) {
        self.set(&format!("{}{name}", Self::PREFIX), value);
    }

    /// Value of an entry.
    pub fn get(&self, name: &str) -> Option<&str> {
        let found = self.entries.iter().find(|(known, _)| known == name);
        found.map(|(_, value)| value.as_str())
    }

    /// All entries in their order.
    pub fn entries(&self) -> impl Iterator<Item = (&str, &str)> {
        let entries = self.entries.iter();
        entries.map(|(name, value)| (name.as_str(), value.as_str()))
    }

    /// Whether there are no entries, as in files of most other programs.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The entries in which the candidate's metadata is not the reference's, in
    /// the order of the reference, its own last.
    pub fn differences(&self, candidate: &Self) -> Vec<MetadataDifference> {
        let added = candidate.entries.iter().map(|(name, _)| name);
        let added = added.filter(|name| self.get(name).is_none());
        let names = self.entries.iter().map(|(name, _)| name).chain(added);
        let differences = names.map(|name| MetadataDifference {
            name: name.clone(),
            reference: self.get(name).map(str::to_owned),
            candidate: candidate.get(name).map(str::to_owned),
        });
        differences
            .filter(|difference| difference.reference != difference.candidate)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_name_both_sides() {
        let mut reference = Metadata::of_program();
        reference.set_own("size", "4x3");
        reference.set_own("bounces", "4");
        let mut candidate = reference.clone();
        assert_eq!(reference.differences(&candidate), []);
        candidate.set_own("size", "8x6");
        candidate.set_own("seed", "1");
        let found = reference.differences(&candidate);
        let names: Vec<&str> = found.iter().map(|d| d.name.as_str()).collect();
        assert_eq!(names, ["relume:size", "relume:seed"]);
        assert_eq!(found[0].reference.as_deref(), Some("4x3"));
        assert_eq!(found[0].candidate.as_deref(), Some("8x6"));
        assert_eq!(found[1].reference, None);
        let all = reference.differences(&Metadata::default());
        assert_eq!(all.len(), 3, "a side without metadata lacks every entry");
    }
}
