//! Parameters as data: what operators, presets and formats declare, what requests give, and what resolving them yields.

mod read;

use crate::fault::{Fault, shortened, token, under};
use crate::math::expression::Expression;

use read::{
    MAX_NAME, choices, chosen, color, constant, direction, expression, expressions, groups, named, numbers, range,
    ranged, vector, whole,
};

/// What a client wrote for one parameter, before its kind is known.
#[derive(Debug, Clone, PartialEq)]
pub enum Literal {
    /// `null`.
    Null,
    /// `true` or `false`.
    Flag(bool),
    /// A number.
    Number(f64),
    /// A text: a choice, a colour, or an expression.
    Text(String),
    /// A list.
    List(Vec<Literal>),
    /// Named fields, in the order written.
    Map(Vec<(String, Literal)>),
}

impl Literal {
    fn kind(&self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Flag(_) => "a flag",
            Self::Number(_) => "a number",
            Self::Text(_) => "a text",
            Self::List(_) => "a list",
            Self::Map(_) => "an object",
        }
    }
}

/// One parameter: everything that the catalogue, the checks and the key need to know of it.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Name in requests.
    pub name: &'static str,
    /// What may be written.
    pub kind: Kind,
    /// Unit of the value (`"radians"`, `"pixels"`), empty when it has none.
    pub unit: &'static str,
    /// Value when the request leaves it out.
    pub default: Default,
    /// One sentence for the catalogue.
    pub doc: &'static str,
}

/// What may be written for a parameter.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// A finite number or constant expression in `[min, max]`.
    Number {
        /// Smallest value allowed.
        min: f64,
        /// Largest value allowed.
        max: f64,
    },
    /// A whole number in `[min, max]`.
    Integer {
        /// Smallest value allowed.
        min: i64,
        /// Largest value allowed.
        max: i64,
    },
    /// `true` or `false`.
    Flag,
    /// One of the names.
    Choice(&'static [&'static str]),
    /// A name that the client gave to something.
    Name,
    /// A list of distinct names out of those given.
    Choices(&'static [&'static str]),
    /// A number or an expression in the named variable.
    Expression {
        /// The variable that may be used, `alpha` or `valence`.
        variable: &'static str,
    },
    /// One such expression, or a list of up to `most`, one for each average after an upsampling.
    Expressions {
        /// The variable that may be used.
        variable: &'static str,
        /// Longest list allowed.
        most: usize,
    },
    /// A list of up to `most` finite numbers or constant expressions.
    Numbers {
        /// Longest list allowed.
        most: usize,
    },
    /// A colour: `#rgb`, `#rrggbb`, `#rrggbbaa` or `transparent`.
    Color,
    /// Three finite numbers.
    Vector,
    /// Three finite numbers, not all 0; their length does not count.
    Direction,
    /// An object with these fields.
    Group(&'static [Parameter]),
    /// A list of objects with these fields.
    Groups {
        /// Fields of each.
        fields: &'static [Parameter],
        /// Longest list allowed.
        most: usize,
    },
}

/// Default of a parameter, in the notation a client would use.
#[derive(Debug, Clone, Copy)]
pub enum Default {
    /// None: the value is [`Value::Absent`] unless given.
    Absent,
    /// None, and leaving it out is a fault.
    Required,
    /// A number.
    Number(f64),
    /// A flag.
    Flag(bool),
    /// A text (choice, colour or expression).
    Text(&'static str),
    /// A list of texts.
    Texts(&'static [&'static str]),
    /// Every field of the group has its own default.
    Fields,
}

/// The resolved value of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Not given, and no default.
    Absent,
    /// See [`Kind::Number`].
    Number(f64),
    /// See [`Kind::Integer`].
    Integer(i64),
    /// See [`Kind::Flag`].
    Flag(bool),
    /// See [`Kind::Choice`].
    Choice(&'static str),
    /// See [`Kind::Name`].
    Name(String),
    /// See [`Kind::Choices`]; in the order of the declaration.
    Choices(Vec<&'static str>),
    /// See [`Kind::Expression`].
    Expression(Expression),
    /// See [`Kind::Expressions`]; never empty.
    Expressions(Vec<Expression>),
    /// See [`Kind::Numbers`].
    Numbers(Vec<f64>),
    /// See [`Kind::Color`]: red, green, blue, alpha (straight).
    Color([u8; 4]),
    /// See [`Kind::Vector`] and [`Kind::Direction`], of which the largest coordinate is 1 or -1.
    Vector([f64; 3]),
    /// See [`Kind::Group`].
    Group(Values),
    /// See [`Kind::Groups`]; never empty.
    Groups(Vec<Values>),
}

/// Resolved parameters: one value for each declaration, in its order.
#[derive(Debug, Clone, PartialEq, std::default::Default)]
pub struct Values(Vec<Entry>);

#[derive(Debug, Clone, PartialEq)]
struct Entry {
    name: &'static str,
    value: Value,
    /// Whether it is the value that the parameter has when it is left out.
    usual: bool,
}

impl Values {
    /// Checks `given` against the declarations and fills in the defaults.
    ///
    /// # Errors
    /// Every fault found: unknown names, wrong kinds, values out of range, required ones missing. Pointers start at the
    /// object that holds the parameters.
    pub fn resolve(declared: &'static [Parameter], given: &[(String, Literal)]) -> Result<Self, Vec<Fault>> {
        let mut faults: Vec<Fault> = given
            .iter()
            .filter(|(name, _)| declared.iter().all(|p| p.name != name))
            .map(|(name, _)| Fault::new(format!("/{}", token(name)), unknown(name, declared)))
            .collect();
        let mut values = Vec::with_capacity(declared.len());
        for parameter in declared {
            let written = given.iter().find(|(name, _)| name == parameter.name).map(|(_, literal)| literal);
            match parameter.value(written) {
                Ok(value) => {
                    let usual = written.is_none() || parameter.value(None).is_ok_and(|usual| usual == value);
                    values.push(Entry { name: parameter.name, value, usual });
                }
                Err(found) => faults.extend(under(&format!("/{}", parameter.name), found)),
            }
        }
        if faults.is_empty() { Ok(Self(values)) } else { Err(faults) }
    }

    /// The values of parameters that are all left out; required ones are absent.
    pub fn usual(declared: &[Parameter]) -> Self {
        let entry = |parameter: &Parameter| {
            let value = parameter.value(None).unwrap_or(Value::Absent);
            Entry { name: parameter.name, value, usual: true }
        };
        Self(declared.iter().map(entry).collect())
    }

    /// Sets the value of a parameter, if it is one of those declared.
    pub fn set(&mut self, parameter: &Parameter, value: Value) {
        if let Some(entry) = self.0.iter_mut().find(|entry| entry.name == parameter.name) {
            *entry = Entry { usual: parameter.value(None).is_ok_and(|usual| usual == value), value, ..*entry };
        }
    }

    /// The values that differ from those of parameters left out, in the order of their declarations.
    pub fn unusual(&self) -> impl Iterator<Item = (&'static str, &Value)> {
        self.0.iter().filter(|entry| !entry.usual).map(|entry| (entry.name, &entry.value))
    }

    /// The value of a declared parameter.
    pub fn get(&self, name: &str) -> &Value {
        self.0.iter().find(|entry| entry.name == name).map_or(&Value::Absent, |entry| &entry.value)
    }

    /// A number, or `None` when absent.
    pub fn number(&self, name: &str) -> Option<f64> {
        if let Value::Number(x) = self.get(name) { Some(*x) } else { None }
    }

    /// A whole number, or `None` when absent.
    pub fn integer(&self, name: &str) -> Option<i64> {
        if let Value::Integer(x) = self.get(name) { Some(*x) } else { None }
    }

    /// A flag; an absent one is false.
    pub fn flag(&self, name: &str) -> bool {
        matches!(self.get(name), Value::Flag(true))
    }

    /// A choice, or `None` when absent.
    pub fn choice(&self, name: &str) -> Option<&'static str> {
        if let Value::Choice(x) = self.get(name) { Some(x) } else { None }
    }

    /// A name, or `None` when absent.
    pub fn name(&self, name: &str) -> Option<&str> {
        if let Value::Name(x) = self.get(name) { Some(x) } else { None }
    }

    /// Whether a list of choices contains `item`.
    pub fn has(&self, name: &str, item: &str) -> bool {
        matches!(self.get(name), Value::Choices(items) if items.contains(&item))
    }

    /// A colour, or `None` when absent.
    pub fn color(&self, name: &str) -> Option<[u8; 4]> {
        if let Value::Color(x) = self.get(name) { Some(*x) } else { None }
    }

    /// A vector, or `None` when absent.
    pub fn vector(&self, name: &str) -> Option<[f64; 3]> {
        if let Value::Vector(x) = self.get(name) { Some(*x) } else { None }
    }

    /// An expression, or `None` when absent.
    pub fn expression(&self, name: &str) -> Option<&Expression> {
        if let Value::Expression(x) = self.get(name) { Some(x) } else { None }
    }

    /// A list of expressions, empty when absent.
    pub fn expressions(&self, name: &str) -> &[Expression] {
        if let Value::Expressions(x) = self.get(name) { x } else { &[] }
    }

    /// The values of a group, or `None` when absent.
    pub fn group(&self, name: &str) -> Option<&Self> {
        if let Value::Group(x) = self.get(name) { Some(x) } else { None }
    }

    /// The values of a list of groups, empty when absent.
    pub fn groups(&self, name: &str) -> &[Self] {
        if let Value::Groups(x) = self.get(name) { x } else { &[] }
    }
}

fn unknown(name: &str, declared: &[Parameter]) -> String {
    let known = declared.iter().map(|p| p.name).collect::<Vec<_>>().join(", ");
    let known = if known.is_empty() { "there are none here".into() } else { format!("known here: {known}") };
    format!("unknown parameter \"{}\"; {known}", shortened(name))
}

impl Parameter {
    /// The value for what was written, or for the default when nothing was.
    fn value(&self, written: Option<&Literal>) -> Result<Value, Vec<Fault>> {
        match (written, self.default) {
            (Some(literal), _) => self.kind.value(literal),
            (None, Default::Absent) => Ok(Value::Absent),
            (None, Default::Required) => Err(vec![Fault::new("", format!("\"{}\" is required", self.name))]),
            (None, Default::Number(x)) => self.kind.value(&Literal::Number(x)),
            (None, Default::Flag(x)) => self.kind.value(&Literal::Flag(x)),
            (None, Default::Text(x)) => self.kind.value(&Literal::Text(x.into())),
            (None, Default::Texts(x)) => {
                self.kind.value(&Literal::List(x.iter().map(|&t| Literal::Text(t.into())).collect()))
            }
            (None, Default::Fields) => self.kind.value(&Literal::Map(Vec::new())),
        }
    }
}

impl Kind {
    fn value(&self, literal: &Literal) -> Result<Value, Vec<Fault>> {
        let one = |detail: String| vec![Fault::new("", detail)];
        match (self, literal) {
            (Self::Number { min, max }, Literal::Number(_) | Literal::Text(_)) => {
                constant(literal).and_then(|x| ranged(x, *min, *max)).map(Value::Number).map_err(one)
            }
            (Self::Integer { min, max }, Literal::Number(x)) => whole(*x, *min, *max).map(Value::Integer).map_err(one),
            (Self::Flag, Literal::Flag(x)) => Ok(Value::Flag(*x)),
            (Self::Choice(names), Literal::Text(text)) => chosen(names, text).map(Value::Choice).map_err(one),
            (Self::Name, Literal::Text(text)) => named(text).map(Value::Name).map_err(one),
            (Self::Choices(names), Literal::List(items)) => choices(names, items).map(Value::Choices),
            (Self::Expression { variable }, Literal::Number(_) | Literal::Text(_)) => {
                expression(literal, variable).map(Value::Expression).map_err(one)
            }
            (Self::Expressions { variable, .. }, Literal::Number(_) | Literal::Text(_)) => {
                expression(literal, variable).map(|e| Value::Expressions(vec![e])).map_err(one)
            }
            (Self::Expressions { variable, most }, Literal::List(items)) => expressions(items, variable, *most),
            (Self::Numbers { most }, Literal::List(items)) => numbers(items, *most).map(Value::Numbers),
            (Self::Color, Literal::Text(text)) => color(text).map(Value::Color).map_err(one),
            (Self::Vector, Literal::List(items)) => vector(items).map(Value::Vector).map_err(one),
            (Self::Direction, Literal::List(items)) => direction(items).map(Value::Vector).map_err(one),
            (Self::Group(fields), Literal::Map(given)) => Values::resolve(fields, given).map(Value::Group),
            (Self::Groups { fields, most }, Literal::List(items)) => groups(items, fields, *most).map(Value::Groups),
            _ => Err(one(format!("expected {}, got {}", self.expected(), literal.kind()))),
        }
    }

    /// What may be written, in words.
    pub fn expected(&self) -> String {
        match self {
            Self::Number { min, max } => format!("a number or constant expression {}", range(*min, *max)),
            Self::Integer { min, max } => format!("a whole number from {min} to {max}"),
            Self::Flag => "true or false".into(),
            Self::Choice(names) => format!("one of {}", names.join(", ")),
            Self::Name => format!("a name of 1 to {MAX_NAME} characters"),
            Self::Choices(names) => format!("a list out of {}", names.join(", ")),
            Self::Expression { variable } => format!("a number or an expression in {variable}"),
            Self::Expressions { variable, most } => {
                format!("a number or an expression in {variable}, or a list of at most {most} of them")
            }
            Self::Numbers { most } => format!("a list of at most {most} numbers or constant expressions"),
            Self::Color => "a colour (\"#rgb\", \"#rrggbb\", \"#rrggbbaa\" or \"transparent\")".into(),
            Self::Vector => "a list of three numbers".into(),
            Self::Direction => "a list of three numbers that are not all 0".into(),
            Self::Group(_) => "an object".into(),
            Self::Groups { most, .. } => format!("a list of 1 to {most} objects"),
        }
    }
}
