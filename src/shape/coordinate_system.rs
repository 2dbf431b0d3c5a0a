//! The unit of length and the up axis of an input's coordinates.

/// The unit of length of an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Unit {
    /// Metres.
    #[default]
    Metre,
    /// Millimetres.
    Millimetre,
    /// Centimetres.
    Centimetre,
    /// Inches.
    Inch,
}

impl Unit {
    /// The length of the unit in metres.
    pub fn metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Millimetre => 0.001,
            Self::Centimetre => 0.01,
            Self::Inch => 0.0254,
        }
    }

    /// The name of the unit in requests and in comments of files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Inch => "in",
        }
    }
}

/// The axis of an input that points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Up {
    /// The second, as in glTF.
    #[default]
    Y,
    /// The third.
    Z,
}

impl Up {
    /// The direction, in coordinates of the input.
    pub fn direction(self) -> [f64; 3] {
        match self {
            Self::Y => [0.0, 1.0, 0.0],
            Self::Z => [0.0, 0.0, 1.0],
        }
    }

    /// The name of the axis in requests and in comments of files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Y => "y",
            Self::Z => "z",
        }
    }
}

/// The coordinate system of an input: its unit of length and its up axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CoordinateSystem {
    /// Unit of length.
    pub unit: Unit,
    /// The axis that points up.
    pub up: Up,
}

impl CoordinateSystem {
    /// Returns whether the system is the default, metres with y up, which files need not state.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the comment lines that files carry about the system: unit and axis, named as in requests, if they differ
    /// from the defaults.
    pub fn remarks(&self) -> Vec<String> {
        let unit = (self.unit != Unit::default()).then(|| format!("unit {}", self.unit.name()));
        let up = (self.up != Up::default()).then(|| format!("up {}", self.up.name()));
        unit.into_iter().chain(up).collect()
    }
}
