//! The blackboard: named entries through which the nodes of a tree exchange values. Several trees can share a
//! blackboard. Names are looked up when a tree is built; a tick uses slots. `build` resolves the scopes of subtrees.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::value::{LONGEST_TEXT, Value, ValueType};

/// Maximum number of entries of one blackboard. It is more than all ports of the largest tree that people draw.
pub const MOST_ENTRIES: usize = 8192;

/// The index of an entry. It stays the same while the blackboard exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Slot(u32);

impl Slot {
    const fn index(self) -> usize {
        self.0 as usize
    }
}

/// A named place for one value, which ports and scripts read and write.
#[derive(Clone, Debug, PartialEq)]
pub struct BlackboardEntry {
    name: Arc<str>,
    ty: ValueType,
    value: Option<Value>,
    written: u64,
    /// True once a port names the entry or a value was written to it. Only then may a script write the entry with
    /// `=`.
    is_there: bool,
}

impl BlackboardEntry {
    /// The name of the entry. In a subtree it begins with the path of the subtree.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The type of the entry's values; `Any` until a port gives it another type.
    #[must_use]
    pub const fn value_type(&self) -> ValueType {
        self.ty
    }

    /// The value that was written last; `None` if no value was written, or if it was removed.
    #[must_use]
    pub const fn value(&self) -> Option<&Value> {
        self.value.as_ref()
    }

    /// The number of the last write to this entry. Later writes on the blackboard have higher numbers.
    #[must_use]
    pub const fn written(&self) -> u64 {
        self.written
    }
}

/// Why a value cannot be put on the blackboard, or why an entry cannot be created there.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unfit {
    /// The entry has another type, to which the value cannot be converted without loss.
    #[error("the entry {{{name}}} is of type {} and cannot hold \"{value}\"", ty.word())]
    Type {
        /// The entry's name on the blackboard, with the path of its subtree.
        name: Arc<str>,
        /// The type that a port gave the entry.
        ty: ValueType,
        /// The value to be written, in the form of a file.
        value: String,
    },
    /// Two ports give the entry two different types. Only `Any` is compatible with every type.
    #[error("the entry {{{name}}} is of type {} elsewhere, and of type {} here", before.word(), now.word())]
    TwoTypes {
        /// The entry's name on the blackboard, with the path of its subtree.
        name: Arc<str>,
        /// The type that the first bound port gives the entry.
        before: ValueType,
        /// The type that the refused port gives the entry.
        now: ValueType,
    },
    /// The text is longer than [`LONGEST_TEXT`].
    #[error("the text for the entry {{{name}}} is {length} bytes long; the limit is {LONGEST_TEXT} bytes")]
    TooLong {
        /// The entry's name on the blackboard, with the path of its subtree.
        name: Arc<str>,
        /// The length of the text in bytes.
        length: usize,
    },
    /// The blackboard already has [`MOST_ENTRIES`], or the slot belongs to another blackboard.
    #[error("there are more than {MOST_ENTRIES} entries on the blackboard")]
    TooMany,
}

/// Entries by name and by slot. Several trees can be built on one blackboard.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Blackboard {
    entries: Vec<BlackboardEntry>,
    by_name: BTreeMap<Arc<str>, Slot>,
    writes: u64,
}

impl Blackboard {
    /// A blackboard without entries. Building a tree on it creates the entries that the tree names.
    #[must_use]
    pub fn new() -> Blackboard {
        Blackboard::default()
    }

    /// All entries, in the order of their creation.
    pub fn entries(&self) -> impl Iterator<Item = &BlackboardEntry> {
        self.entries.iter()
    }

    /// Number of writes so far. Removing a value counts as a write.
    #[must_use]
    pub const fn writes(&self) -> u64 {
        self.writes
    }

    /// The slot of the entry with this name. It never changes, so look it up only once.
    #[must_use]
    pub fn slot(&self, name: &str) -> Option<Slot> {
        self.by_name.get(name).copied()
    }

    /// The value of the entry with this name; `None` if the entry has no value or does not exist.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.value(self.slot(name)?)
    }

    /// Writes a value to the entry with this name, and creates the entry if necessary.
    ///
    /// # Errors
    /// If the value does not fit the type of the entry, or there are too many entries.
    pub fn set(&mut self, name: &str, value: Value) -> Result<(), Unfit> {
        let slot = self.declare(name, ValueType::Any)?;
        self.put(slot, value)
    }

    /// Creates an entry with this name and type, or finds the existing one.
    ///
    /// # Errors
    /// If the existing entry has another type, or a value of another type, or if there are too many entries.
    pub fn declare(&mut self, name: &str, ty: ValueType) -> Result<Slot, Unfit> {
        if let Some(slot) = self.slot(name) {
            let entry = &mut self.entries[slot.index()];
            entry.is_there = true;
            if ty == ValueType::Any || ty == entry.ty {
                return Ok(slot);
            }
            if entry.ty != ValueType::Any {
                return Err(Unfit::TwoTypes { name: entry.name.clone(), before: entry.ty, now: ty });
            }
            if let Some(value) = &entry.value {
                let fitting = value.converted(ty);
                entry.value =
                    Some(fitting.ok_or_else(|| Unfit::Type { name: entry.name.clone(), ty, value: value.to_string() })?);
            }
            entry.ty = ty;
            return Ok(slot);
        }
        let slot = self.mention(name)?;
        let entry = &mut self.entries[slot.index()];
        entry.is_there = true;
        entry.ty = ty;
        Ok(slot)
    }

    /// Returns the slot with this name, and reserves it if necessary. The entry need not exist yet: some scripts
    /// create it, and others require it to exist.
    pub(crate) fn mention(&mut self, name: &str) -> Result<Slot, Unfit> {
        if let Some(slot) = self.slot(name) {
            return Ok(slot);
        }
        if self.entries.len() >= MOST_ENTRIES {
            return Err(Unfit::TooMany);
        }
        let slot = Slot(u32::try_from(self.entries.len()).map_err(|_| Unfit::TooMany)?);
        let name: Arc<str> = Arc::from(name);
        self.entries.push(BlackboardEntry { name: name.clone(), ty: ValueType::Any, value: None, written: 0, is_there: false });
        self.by_name.insert(name, slot);
        Ok(slot)
    }

    /// The value of the entry in this slot; `None` if it has no value. The slot must be one of this blackboard.
    #[must_use]
    pub fn value(&self, slot: Slot) -> Option<&Value> {
        self.entries.get(slot.index())?.value.as_ref()
    }

    /// Whether a script may write this entry with `=`. That is so if a port names the entry, or a value was written
    /// to it.
    pub(crate) fn is_there(&self, slot: Slot) -> bool {
        self.entries.get(slot.index()).is_some_and(|entry| entry.is_there)
    }

    /// The entry in this slot. The slot must be one of this blackboard.
    #[must_use]
    pub fn entry(&self, slot: Slot) -> Option<&BlackboardEntry> {
        self.entries.get(slot.index())
    }

    /// Writes a value to a slot. The value is converted to the type of the entry if nothing is lost.
    ///
    /// # Errors
    /// If the value does not fit the entry.
    pub fn put(&mut self, slot: Slot, value: Value) -> Result<(), Unfit> {
        let Some(entry) = self.entries.get_mut(slot.index()) else { return Err(Unfit::TooMany) };
        if let Value::Text(text) = &value
            && text.len() > LONGEST_TEXT
        {
            return Err(Unfit::TooLong { name: entry.name.clone(), length: text.len() });
        }
        let value = if entry.ty == ValueType::Any || value.value_type() == entry.ty {
            value
        } else {
            let fitting = value.converted(entry.ty);
            fitting.ok_or_else(|| Unfit::Type { name: entry.name.clone(), ty: entry.ty, value: value.to_string() })?
        };
        self.writes += 1;
        entry.value = Some(value);
        entry.is_there = true;
        entry.written = self.writes;
        Ok(())
    }

    /// Turns the text in this slot into a number, so that scripts can calculate with it. The text must be a
    /// number, and no port may give the entry a type.
    pub(crate) fn take_for_number(&mut self, slot: Slot) {
        if let Some(entry) = self.entries.get_mut(slot.index())
            && entry.ty == ValueType::Any
            && let Some(Value::Text(text)) = &entry.value
            && text.starts_with(|letter: char| letter.is_ascii_digit() || letter == '-' || letter == '.')
            && text.trim_end() == &**text
            && let Some(number) = [ValueType::Int, ValueType::Number].into_iter().find_map(|ty| Value::parse(text, ty))
        {
            entry.value = Some(number);
        }
    }

    /// Removes an entry for scripts. It must be created again before the next `=`. Its slot and its type stay.
    pub(crate) fn remove(&mut self, slot: Slot) {
        self.unset(slot);
        if let Some(entry) = self.entries.get_mut(slot.index()) {
            entry.is_there = false;
        }
    }

    /// Removes the value of an entry, which counts as a write. The entry and its type stay.
    pub fn unset(&mut self, slot: Slot) {
        if let Some(entry) = self.entries.get_mut(slot.index()) {
            self.writes += 1;
            entry.value = None;
            entry.written = self.writes;
        }
    }

    /// Restores stored values. All other entries lose their values. The trees must have been built before this call.
    ///
    /// # Errors
    /// If a value does not fit its entry.
    pub fn restore<'k>(&mut self, kept: impl IntoIterator<Item = (&'k str, Value)>) -> Result<(), Unfit> {
        self.clear();
        kept.into_iter().try_for_each(|(name, value)| self.set(name, value))
    }

    /// Removes the values of all entries for a new run, including the barriers of `Sync`. Texts that were written
    /// when a tree was built (`<SubTree … speed="2"/>`) are removed too. It is therefore best to build a new tree for
    /// a new run.
    pub fn clear(&mut self) {
        for index in 0..self.entries.len() {
            self.unset(Slot(u32::try_from(index).unwrap_or(u32::MAX)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_keeps_its_type_and_takes_what_can_be_read_as_one() {
        let mut blackboard = Blackboard::new();
        let slot = blackboard.declare("speed", ValueType::Number).expect("it is new");
        blackboard.put(slot, Value::text("1.5")).expect("a text that is a number");
        assert_eq!(blackboard.get("speed"), Some(&Value::Number(1.5)));
        let refused = blackboard.put(slot, Value::text("fast")).expect_err("no number");
        assert_eq!(refused.to_string(), "the entry {speed} is of type number and cannot hold \"fast\"");
        let refused = blackboard.declare("speed", ValueType::Cell).expect_err("two types");
        assert_eq!(refused.to_string(), "the entry {speed} is of type number elsewhere, and of type cell here");
        assert_eq!(blackboard.get("speed"), Some(&Value::Number(1.5)));
    }

    #[test]
    fn what_was_put_before_a_type_was_known_is_read_as_that_type() {
        let mut blackboard = Blackboard::new();
        blackboard.set("goal", Value::text("3;4")).expect("a new entry takes all");
        blackboard.declare("goal", ValueType::Cell).expect("a cell is in it");
        assert_eq!(blackboard.get("goal").and_then(Value::as_cell), Some(crate::value::Cell { x: 3, y: 4 }));
        blackboard.set("other", Value::text("x")).expect("a new entry takes all");
        assert!(blackboard.declare("other", ValueType::Int).is_err());
    }

    #[test]
    fn every_write_has_a_number_of_its_own() {
        let mut blackboard = Blackboard::new();
        blackboard.set("a", Value::Int(1)).expect("it fits");
        blackboard.set("b", Value::Int(1)).expect("it fits");
        blackboard.set("a", Value::Int(1)).expect("it fits");
        let written: Vec<u64> = blackboard.entries().map(BlackboardEntry::written).collect();
        assert_eq!(written, [3, 2]);
        blackboard.clear();
        assert!(blackboard.entries().all(|entry| entry.value().is_none() && entry.written() > 3));
    }

    #[test]
    fn a_blackboard_is_bounded() {
        let mut blackboard = Blackboard::new();
        for number in 0..MOST_ENTRIES {
            blackboard.declare(&number.to_string(), ValueType::Any).expect("there is room");
        }
        assert_eq!(blackboard.declare("one more", ValueType::Any), Err(Unfit::TooMany));
        let long = Value::text(&"x".repeat(LONGEST_TEXT + 1));
        assert!(matches!(blackboard.set("0", long), Err(Unfit::TooLong { .. })));
    }
}
