//! What the tables of keys are made of.

use super::quantity::Quantity;
use crate::table::{self, Unit};

/// The keys of a table.
#[derive(Debug)]
pub(crate) struct Keys {
    /// What the table is.
    pub about: &'static str,
    /// In the order of messages.
    pub keys: &'static [Key],
    /// The key whose word decides which others there are.
    pub decides: Option<Decision>,
}

/// A key whose word decides which others there are.
#[derive(Debug)]
pub(crate) struct Decision {
    /// The key.
    pub by: &'static str,
    /// The keys that there are for each word.
    pub always: &'static [&'static str],
    /// For each word the keys beside those.
    pub of: &'static [(&'static str, &'static [&'static str])],
}

/// A key of a table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Key {
    /// How it is written.
    pub name: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// More about it, for editors; perhaps nothing.
    pub about: &'static str,
    /// What holds without it, as TOML.
    pub default: Option<&'static str>,
    /// Whether a table must have it, whatever others it has.
    pub required: bool,
}

/// What a key takes. Texts complete "must be ...".
#[derive(Debug, Clone, Copy)]
pub(crate) enum Kind {
    /// A number. Whole numbers are numbers.
    Number(Quantity),
    /// A number, or one for x and one for y.
    OneOrTwo(Quantity),
    /// Such a number, or a formula that gives one.
    NumberOrFormula(Quantity),
    /// Such a number, or this word; what that is.
    NumberOrWord(Quantity, &'static str, &'static str),
    /// This word, or a table; what that is.
    WordOrTable(&'static str, &'static Keys, &'static str),
    /// A table of arrays of points.
    Curves(&'static str),
    /// A whole number of this range, its ends included.
    Count(&'static str, [usize; 2]),
    /// Such a number for each direction along the face and one for the depth; what that is in the plane and in space.
    Cells([&'static str; 2], [usize; 2]),
    /// True or false.
    Flag,
    /// A text without control characters.
    Text(&'static str),
    /// A name: a text, or a whole number as one.
    Label(&'static str),
    /// An array of names.
    Labels(&'static str),
    /// An array of names of phases and of times.
    Moments(&'static str),
    /// Two columns of a file, by number or title.
    Columns(&'static str),
    /// An array of texts.
    Texts(&'static str),
    /// One of these words.
    Choice(&'static [&'static str]),
    /// One of these words, or one for x and one for y.
    ChoiceOrPair(&'static [&'static str]),
    /// A unit of length.
    LengthUnit,
    /// The name of a file, or the table that a resolved scene has in its place.
    FileOrTable(&'static str, &'static Keys),
    /// Numbers, as many as there are.
    Numbers(&'static str),
    /// A table.
    Table(&'static Keys),
    /// An array of tables.
    Tables(&'static str, &'static Keys),
    /// A table, or an array of tables.
    OneOrTables(&'static Keys),
    /// Keys of scenes with arrays of values; one table or several.
    Vary,
    /// Keys of scenes with formulas.
    Follow,
}

impl Kind {
    /// Completes "must be ..." where that does not depend on the value.
    pub fn what(&self) -> &'static str {
        match self {
            Self::Number(quantity) | Self::OneOrTwo(quantity) | Self::NumberOrFormula(quantity) => quantity.what,
            Self::NumberOrWord(_, _, what)
            | Self::WordOrTable(_, _, what)
            | Self::Count(what, _)
            | Self::Cells([what, _], _)
            | Self::Curves(what)
            | Self::Text(what)
            | Self::Label(what)
            | Self::Labels(what)
            | Self::Moments(what)
            | Self::Columns(what)
            | Self::Texts(what)
            | Self::FileOrTable(what, _)
            | Self::Numbers(what)
            | Self::Tables(what, _) => what,
            Self::Flag => "true or false",
            Self::Choice(_) | Self::ChoiceOrPair(_) | Self::LengthUnit => "one of its words",
            Self::Table(_) | Self::OneOrTables(_) | Self::Vary | Self::Follow => "a table",
        }
    }

    /// The keys of the table that it is.
    pub fn table(&self) -> Option<&'static Keys> {
        match self {
            Self::Table(keys)
            | Self::WordOrTable(_, keys, _)
            | Self::FileOrTable(_, keys)
            | Self::Tables(_, keys)
            | Self::OneOrTables(keys) => Some(keys),
            _ => None,
        }
    }

    /// The words of a choice.
    pub fn words(&self) -> Option<Vec<&'static str>> {
        match self {
            Self::Choice(words) | Self::ChoiceOrPair(words) => Some(words.to_vec()),
            Self::LengthUnit => Some(Unit::names(table::Quantity::Length)),
            _ => None,
        }
    }
}

impl Keys {
    /// The key of this name.
    pub fn get(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.name == name)
    }

    /// The keys that there are beside what the deciding one says; all where it says nothing that is known.
    pub fn beside(&self, word: Option<&str>) -> Vec<&'static str> {
        let chosen = self.decides.as_ref().and_then(|Decision { by, always, of }| {
            let (_, others) = of.iter().find(|(known, _)| Some(*known) == word)?;
            Some(std::iter::once(*by).chain(always.iter().chain(*others).copied()).collect())
        });
        chosen.unwrap_or_else(|| self.keys.iter().map(|key| key.name).collect())
    }
}

impl Key {
    pub const fn new(name: &'static str, kind: Kind) -> Self {
        Self { name, kind, about: "", default: None, required: false }
    }

    pub const fn required(self) -> Self {
        Self { required: true, ..self }
    }

    pub const fn default(self, default: &'static str) -> Self {
        Self { default: Some(default), ..self }
    }

    pub const fn about(self, about: &'static str) -> Self {
        Self { about, ..self }
    }
}
