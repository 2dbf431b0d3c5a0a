//! Parameters as data: their declarations, the literals of requests, and the resolved values.

pub mod read;
mod resolve;

use crate::math::expression::Expression;

/// Maximum length of a name, in characters.
pub const MAX_PARAMETER_NAME: usize = 64;

/// The literal that a client wrote for one parameter, before its kind is known.
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

/// The declaration of one parameter, for the catalogue, the checks and the key.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Name in requests.
    pub name: &'static str,
    /// The values that may be written.
    pub kind: ParameterKind,
    /// Unit of the value (`"radians"`, `"pixels"`), empty when it has none.
    pub unit: &'static str,
    /// The value if the request leaves the parameter out.
    pub default: Default,
    /// One sentence for the catalogue.
    pub doc: &'static str,
}

impl Parameter {
    /// Declares a parameter without unit.
    pub const fn new(name: &'static str, kind: ParameterKind, default: Default, doc: &'static str) -> Self {
        Self { name, kind, unit: "", default, doc }
    }

    /// Declares a number in `[min, max]` without unit.
    pub const fn number(name: &'static str, [min, max]: [f64; 2], default: Default, doc: &'static str) -> Self {
        Self::new(name, ParameterKind::Number { min, max }, default, doc)
    }

    /// Returns whether the parameter must be given.
    pub fn is_required(&self) -> bool {
        matches!(self.default, Default::Required)
    }

    /// Declares a choice among names; the first one is the default.
    pub const fn choice(name: &'static str, names: &'static [&'static str], doc: &'static str) -> Self {
        Self::new(name, ParameterKind::Choice(names), Default::Text(names[0]), doc)
    }

    /// Declares a flag that is `false` by default.
    pub const fn flag(name: &'static str, doc: &'static str) -> Self {
        Self::new(name, ParameterKind::Flag, Default::Flag(false), doc)
    }

    /// Declares a parameter without unit that may be left out and then has no value.
    pub const fn optional(name: &'static str, kind: ParameterKind, doc: &'static str) -> Self {
        Self::new(name, kind, Default::Absent, doc)
    }

    /// Declares a parameter without unit that must be given.
    pub const fn required(name: &'static str, kind: ParameterKind, doc: &'static str) -> Self {
        Self::new(name, kind, Default::Required, doc)
    }

    /// Declares the parameter with a unit.
    #[must_use]
    pub const fn in_unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// Declares a whole number in `[min, max]` without unit.
    pub const fn integer(name: &'static str, [min, max]: [i64; 2], default: f64, doc: &'static str) -> Self {
        Self::new(name, ParameterKind::Integer { min, max }, Default::Number(default), doc)
    }
}

/// The kind of values that may be written for a parameter.
#[derive(Debug, Clone, Copy)]
pub enum ParameterKind {
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
    /// One expression, or a list of up to `most`, one per average after an upsampling.
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
    /// Three finite numbers, not all 0; only their direction matters.
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

/// The default of a parameter, in the notation of a client.
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
    /// The parameter was not given and has no default.
    Absent,
    /// A value of [`ParameterKind::Number`].
    Number(f64),
    /// A value of [`ParameterKind::Integer`].
    Integer(i64),
    /// A value of [`ParameterKind::Flag`].
    Flag(bool),
    /// A value of [`ParameterKind::Choice`].
    Choice(&'static str),
    /// A value of [`ParameterKind::Name`].
    Name(String),
    /// A value of [`ParameterKind::Choices`]; in the order of the declaration.
    Choices(Vec<&'static str>),
    /// A value of [`ParameterKind::Expression`].
    Expression(Expression),
    /// A value of [`ParameterKind::Expressions`]; never empty.
    Expressions(Vec<Expression>),
    /// A value of [`ParameterKind::Numbers`].
    Numbers(Vec<f64>),
    /// A value of [`ParameterKind::Color`]: red, green, blue, alpha (straight).
    Color([u8; 4]),
    /// A value of [`ParameterKind::Vector`], or of [`ParameterKind::Direction`] with the largest coordinate 1 or -1.
    Vector([f64; 3]),
    /// A value of [`ParameterKind::Group`].
    Group(Values),
    /// A value of [`ParameterKind::Groups`]; never empty.
    Groups(Vec<Values>),
}

/// Resolved parameters: one value per declaration, in order.
#[derive(Debug, Clone, PartialEq, std::default::Default)]
pub struct Values(Vec<NamedValue>);

#[derive(Debug, Clone)]
struct NamedValue {
    name: &'static str,
    value: Value,
    /// Whether the value is the default.
    usual: bool,
    /// The literal of a number, for exact evaluation.
    written: Option<Literal>,
}

impl PartialEq for NamedValue {
    /// Equal values are equal, however they were written.
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && self.value == other.value && self.usual == other.usual
    }
}

impl Values {
    /// Returns the values that differ from the defaults, in the order of their declarations.
    pub fn unusual(&self) -> impl Iterator<Item = (&'static str, &Value)> {
        self.0.iter().filter(|entry| !entry.usual).map(|entry| (entry.name, &entry.value))
    }

    /// Returns the values without the one of this name.
    #[must_use]
    pub fn without(&self, name: &str) -> Self {
        Self(self.0.iter().filter(|entry| entry.name != name).cloned().collect())
    }

    /// Returns the value of a declared parameter.
    pub fn get(&self, name: &str) -> &Value {
        self.0.iter().find(|entry| entry.name == name).map_or(&Value::Absent, |entry| &entry.value)
    }

    /// Returns the number given for a parameter, or `None` when absent.
    pub fn number(&self, name: &str) -> Option<f64> {
        if let Value::Number(x) = self.get(name) { Some(*x) } else { None }
    }

    /// Returns the literal of a number or of a list of numbers.
    pub fn written(&self, name: &str) -> Option<&Literal> {
        self.0.iter().find(|entry| entry.name == name)?.written.as_ref()
    }

    /// Returns the whole number given for a parameter, or `None` when absent.
    pub fn integer(&self, name: &str) -> Option<i64> {
        if let Value::Integer(x) = self.get(name) { Some(*x) } else { None }
    }

    /// Returns the flag given for a parameter; an absent one is false.
    pub fn flag(&self, name: &str) -> bool {
        matches!(self.get(name), Value::Flag(true))
    }

    /// Returns the choice given for a parameter, or `None` when absent.
    pub fn choice(&self, name: &str) -> Option<&'static str> {
        if let Value::Choice(x) = self.get(name) { Some(x) } else { None }
    }

    /// Returns the name given for a parameter, or `None` when absent.
    pub fn name(&self, name: &str) -> Option<&str> {
        if let Value::Name(x) = self.get(name) { Some(x) } else { None }
    }

    /// Returns whether a list of choices contains `item`.
    pub fn has(&self, name: &str, item: &str) -> bool {
        matches!(self.get(name), Value::Choices(items) if items.contains(&item))
    }

    /// Returns the list of numbers given for a parameter, empty when absent.
    pub fn numbers(&self, name: &str) -> &[f64] {
        if let Value::Numbers(x) = self.get(name) { x } else { &[] }
    }

    /// Returns the colour given for a parameter, or `None` when absent.
    pub fn color(&self, name: &str) -> Option<[u8; 4]> {
        if let Value::Color(x) = self.get(name) { Some(*x) } else { None }
    }

    /// Returns the vector given for a parameter, or `None` when absent.
    pub fn vector(&self, name: &str) -> Option<[f64; 3]> {
        if let Value::Vector(x) = self.get(name) { Some(*x) } else { None }
    }

    /// Returns the expression given for a parameter, or `None` when absent.
    pub fn expression(&self, name: &str) -> Option<&Expression> {
        if let Value::Expression(x) = self.get(name) { Some(x) } else { None }
    }

    /// Returns the list of expressions given for a parameter, empty when absent.
    pub fn expressions(&self, name: &str) -> &[Expression] {
        if let Value::Expressions(x) = self.get(name) { x } else { &[] }
    }

    /// Returns the values of a group, or `None` when absent.
    pub fn group(&self, name: &str) -> Option<&Self> {
        if let Value::Group(x) = self.get(name) { Some(x) } else { None }
    }

    /// Returns the values of a list of groups, empty when absent.
    pub fn groups(&self, name: &str) -> &[Self] {
        if let Value::Groups(x) = self.get(name) { x } else { &[] }
    }
}

impl ParameterKind {
    /// Describes in words what may be written.
    pub fn expected(&self) -> String {
        match self {
            Self::Number { min, max } => format!("a number or constant expression {}", range(*min, *max)),
            Self::Integer { min, max } => format!("a whole number from {min} to {max}"),
            Self::Flag => "true or false".into(),
            Self::Choice(names) => format!("one of {}", names.join(", ")),
            Self::Name => format!("a name of 1 to {MAX_PARAMETER_NAME} characters"),
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

/// Describes the numbers between two bounds in words.
fn range(min: f64, max: f64) -> String {
    match (min.is_finite(), max.is_finite()) {
        (true, true) => format!("from {min} to {max}"),
        (true, false) => format!("of at least {min}"),
        (false, true) => format!("of at most {max}"),
        (false, false) => "of any size".into(),
    }
}
