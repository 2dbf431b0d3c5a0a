//! The prims of a layer with their properties, as parsed.

use super::tokens::{Tokens, UsdaToken, unescaped};
use crate::input::room::{GROWN, MemoryBudget};
use crate::input::text::quoted;

/// Maximum depth of nested prims.
const MAX_PRIM_DEPTH: usize = 64;
/// Maximum depth of nested lists; lists of matrices are three deep.
const MAX_LISTS: usize = 8;
/// Bytes of memory of a number, of a word, of a property and of a prim, each kept in lists that grow.
const USDA_NUMBER_BYTES: usize = GROWN * 8;
const USDA_WORD_BYTES: usize = GROWN * 16;
const USDA_PROPERTY_BYTES: usize = GROWN * size_of::<UsdaProperty<'static>>();
const USDA_PRIM_BYTES: usize = GROWN * size_of::<Prim<'static>>();

/// A layer.
#[derive(Debug, Default)]
pub(super) struct Layer<'a> {
    pub(super) metadata: Vec<(&'a str, UsdaValue<'a>)>,
    pub(super) prims: Vec<Prim<'a>>,
    /// The number of variant sets that were skipped.
    pub(super) variants: usize,
}

/// A prim: a node of the scene.
#[derive(Debug, Default)]
pub(super) struct Prim<'a> {
    /// `def`, `over` or `class`.
    pub(super) specifier: &'a str,
    /// The type, or empty.
    pub(super) kind: &'a str,
    pub(super) name: &'a str,
    pub(super) metadata: Vec<(&'a str, UsdaValue<'a>)>,
    /// Properties with distinct names, sorted by name.
    pub(super) properties: Vec<UsdaProperty<'a>>,
    pub(super) children: Vec<Prim<'a>>,
}

/// An attribute or a relationship.
#[derive(Debug, Default)]
pub(super) struct UsdaProperty<'a> {
    /// The type of an attribute without brackets; `rel` for a relationship.
    pub(super) kind: &'a str,
    pub(super) name: &'a str,
    pub(super) value: UsdaValue<'a>,
    pub(super) metadata: Vec<(&'a str, UsdaValue<'a>)>,
}

/// All numbers of a value, and all its words, texts and paths, in order.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct UsdaValue<'a> {
    pub(super) numbers: Vec<f64>,
    pub(super) words: Vec<&'a str>,
    /// Whether the value refers to files.
    pub(super) has_assets: bool,
    /// Whether the value is the first of several time samples.
    pub(super) is_sampled: bool,
}

impl<'a> UsdaValue<'a> {
    /// Returns the first word.
    pub(super) fn word(&self) -> Option<&'a str> {
        self.words.first().copied()
    }

    /// Returns the first number; booleans become 1 and 0.
    pub(super) fn number(&self) -> Option<f64> {
        let truth = match self.word() {
            Some("true") => Some(1.0),
            Some("false") => Some(0.0),
            _ => None,
        };
        self.numbers.first().copied().or(truth)
    }
}

/// Returns the metadata value with this name.
pub(super) fn metadata_value<'p, 'a>(
    metadata: &'p [(&'a str, UsdaValue<'a>)],
    name: &str,
) -> Option<&'p UsdaValue<'a>> {
    metadata.iter().find(|(found, _)| *found == name).map(|(_, value)| value)
}

impl<'a> Prim<'a> {
    /// Returns the property with this name.
    pub(super) fn property(&self, name: &str) -> Option<&UsdaProperty<'a>> {
        let at = self.properties.partition_point(|property| property.name < name);
        self.properties.get(at).filter(|property| property.name == name)
    }

    /// Returns the value of a property.
    pub(super) fn value(&self, name: &str) -> Option<&UsdaValue<'a>> {
        self.property(name).map(|property| &property.value)
    }

    /// Returns the first word of a property.
    pub(super) fn word(&self, name: &str) -> Option<&'a str> {
        self.value(name)?.word()
    }

    /// Returns the numbers of a property; empty if it is absent.
    pub(super) fn numbers(&self, name: &str) -> &[f64] {
        self.value(name).map_or(&[], |value| &value.numbers)
    }

    /// Returns the display name, or else the name.
    pub(super) fn label(&self) -> String {
        let shown =
            metadata_value(&self.metadata, "displayName").and_then(UsdaValue::word).filter(|name| !name.is_empty());
        shown.map_or_else(|| self.name.to_owned(), unescaped)
    }
}

/// Reads a layer.
///
/// # Errors
/// The text is not valid USD, which the message reports by line, or takes more than is allowed.
pub(super) fn read<'a>(text: &'a str, room: &mut MemoryBudget) -> Result<Layer<'a>, String> {
    let mut reading = UsdaParser { tokens: Tokens::new(text), room, variants: 0 };
    let metadata = reading.metadata()?;
    let mut prims = Vec::new();
    loop {
        match reading.tokens.next()? {
            UsdaToken::End => break,
            UsdaToken::Word(specifier @ ("def" | "over" | "class")) => prims.push(reading.prim(specifier, 0)?),
            UsdaToken::Word("reorder") => reading.pass_reorder()?,
            UsdaToken::Mark(b';') => {}
            _ => return Err(reading.tokens.unexpected("def, over or class")),
        }
    }
    Ok(Layer { metadata, prims, variants: reading.variants })
}

struct UsdaParser<'a, 'r> {
    tokens: Tokens<'a>,
    room: &'r mut MemoryBudget,
    variants: usize,
}

impl<'a> UsdaParser<'a, '_> {
    fn prim(&mut self, specifier: &'a str, depth: usize) -> Result<Prim<'a>, String> {
        self.room.take(USDA_PRIM_BYTES)?;
        if depth == MAX_PRIM_DEPTH {
            return Err(self.tokens.fault(format!("prims lie deeper in each other than {MAX_PRIM_DEPTH}")));
        }
        let mut prim = Prim { specifier, ..Prim::default() };
        if let UsdaToken::Word(kind) = self.tokens.peek()? {
            prim.kind = kind;
            self.tokens.next()?;
        }
        let UsdaToken::Text(name) = self.tokens.next()? else {
            return Err(self.tokens.unexpected("the name of a prim in quotes"));
        };
        prim.name = name;
        prim.metadata = self.metadata()?;
        self.tokens.expect(b'{')?;
        self.body(&mut prim, depth)?;
        // a constant value precedes time samples of the same name
        prim.properties.sort_by_key(|property| (property.name, property.value.is_sampled));
        prim.properties.dedup_by_key(|property| property.name);
        // small lists have capacity for four
        prim.properties.shrink_to_fit();
        prim.children.shrink_to_fit();
        Ok(prim)
    }

    /// Reads the body of a prim.
    fn body(&mut self, prim: &mut Prim<'a>, depth: usize) -> Result<(), String> {
        loop {
            match self.tokens.next()? {
                UsdaToken::Mark(b'}') => return Ok(()),
                UsdaToken::Mark(b';') => {}
                UsdaToken::Word(specifier @ ("def" | "over" | "class")) => {
                    prim.children.push(self.prim(specifier, depth + 1)?);
                }
                UsdaToken::Word("variantSet") => self.pass_variants(depth)?,
                UsdaToken::Word("reorder") => self.pass_reorder()?,
                UsdaToken::Word(first) => {
                    if let Some(property) = self.property(first)? {
                        prim.properties.push(property);
                    }
                }
                _ => return Err(self.tokens.unexpected("a property, a prim or }")),
            }
        }
    }

    /// Reads a property whose first word was read; `None` for a list operation `delete`.
    fn property(&mut self, first: &'a str) -> Result<Option<UsdaProperty<'a>>, String> {
        self.room.take(USDA_PROPERTY_BYTES)?;
        let mut kind = first;
        let takes_away = first == "delete";
        while matches!(kind, "custom" | "uniform" | "varying" | "config" | "prepend" | "append" | "add" | "delete") {
            kind = self.word("a type")?;
        }
        if self.tokens.takes(b'[')? {
            self.tokens.expect(b']')?;
        }
        let name = self.word("the name of a property")?;
        let mut property = UsdaProperty { kind, name, ..UsdaProperty::default() };
        if self.tokens.takes(b'=')? {
            property.value = self.value()?;
        }
        property.metadata = self.metadata()?;
        if let Some(stem) = name.strip_suffix(".timeSamples") {
            property.name = stem;
            property.value.is_sampled = true;
        }
        Ok((!takes_away).then_some(property))
    }

    fn word(&mut self, what: &str) -> Result<&'a str, String> {
        let UsdaToken::Word(word) = self.tokens.next()? else { return Err(self.tokens.unexpected(what)) };
        Ok(word)
    }

    /// Reads metadata, if any follow.
    fn metadata(&mut self) -> Result<Vec<(&'a str, UsdaValue<'a>)>, String> {
        let mut all = Vec::new();
        if !self.tokens.takes(b'(')? {
            return Ok(all);
        }
        loop {
            match self.tokens.next()? {
                UsdaToken::Mark(b')') => return Ok(all),
                UsdaToken::Mark(b';' | b',') | UsdaToken::Text(_) => {}
                UsdaToken::Word(mut name) => {
                    // list operations are read as lists, and the types of dictionary entries are ignored
                    while let UsdaToken::Word(next) = self.tokens.peek()? {
                        name = next;
                        self.tokens.next()?;
                    }
                    self.tokens.expect(b'=')?;
                    self.room.take(USDA_PROPERTY_BYTES)?;
                    let value = self.value()?;
                    self.pass_of_reference(&value)?;
                    all.push((name, value));
                }
                _ => return Err(self.tokens.unexpected("metadata or )")),
            }
        }
    }

    /// Reads a value: the first of time samples, and nothing of dictionaries.
    fn value(&mut self) -> Result<UsdaValue<'a>, String> {
        let mut value = UsdaValue::default();
        if !self.tokens.takes(b'{')? {
            self.values(&mut value, 0)?;
            return Ok(value);
        }
        let is_sampled = matches!(self.tokens.peek()?, UsdaToken::Number(_));
        if is_sampled {
            self.tokens.next()?;
            self.tokens.expect(b':')?;
            self.values(&mut value, 0)?;
        }
        self.pass(b'{', b'}')?;
        Ok(value)
    }

    /// Reads one value or a list into `value`.
    fn values(&mut self, value: &mut UsdaValue<'a>, depth: usize) -> Result<(), String> {
        match self.tokens.next()? {
            UsdaToken::Number(x) => {
                self.room.take(USDA_NUMBER_BYTES)?;
                value.numbers.push(x);
            }
            UsdaToken::Word(word) | UsdaToken::Text(word) | UsdaToken::Path(word) => {
                self.room.take(USDA_WORD_BYTES)?;
                value.words.push(word);
            }
            UsdaToken::Asset => {
                value.has_assets = true;
                if let UsdaToken::Path(_) = self.tokens.peek()? {
                    self.tokens.next()?;
                }
            }
            UsdaToken::Mark(open @ (b'[' | b'(')) => {
                if depth == MAX_LISTS {
                    return Err(self.tokens.fault(format!("lists lie deeper in each other than {MAX_LISTS}")));
                }
                let close = if open == b'[' { b']' } else { b')' };
                while !self.tokens.takes(close)? {
                    self.values(value, depth + 1)?;
                    self.pass_of_reference(value)?;
                    if !self.tokens.takes(b',')? {
                        self.tokens.expect(close)?;
                        break;
                    }
                }
            }
            _ => return Err(self.tokens.unexpected("a value")),
        }
        Ok(())
    }

    /// Skips the parentheses after a reference to a file.
    fn pass_of_reference(&mut self, value: &UsdaValue<'a>) -> Result<(), String> {
        if value.has_assets && self.tokens.takes(b'(')? { self.pass(b'(', b')') } else { Ok(()) }
    }

    /// Skips everything up to the mark that closes `open`.
    fn pass(&mut self, open: u8, close: u8) -> Result<(), String> {
        let mut depth = 1_usize;
        while depth > 0 {
            match self.tokens.next()? {
                UsdaToken::Mark(mark) if mark == open => depth += 1,
                UsdaToken::Mark(mark) if mark == close => depth -= 1,
                UsdaToken::End => return Err(self.tokens.unexpected(char::from(close))),
                _ => {}
            }
        }
        Ok(())
    }

    /// Skips variants, whose braces hold prims.
    fn pass_variants(&mut self, depth: usize) -> Result<(), String> {
        let UsdaToken::Text(name) = self.tokens.next()? else {
            return Err(self.tokens.unexpected("the name of a set of variants"));
        };
        if depth == MAX_PRIM_DEPTH {
            return Err(self.tokens.fault(format!("the variants {} lie too deep", quoted(name))));
        }
        self.variants += 1;
        self.tokens.expect(b'=')?;
        self.tokens.expect(b'{')?;
        self.pass(b'{', b'}')
    }

    /// Skips an order of names; prims keep the order of the text.
    fn pass_reorder(&mut self) -> Result<(), String> {
        self.word("what is put in order")?;
        self.tokens.expect(b'=')?;
        self.value().map(drop)
    }
}
