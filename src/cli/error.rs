//! Why a command failed, and the code that it ends with.

use std::fmt;

use crate::fault::Fault;

/// The kinds of failure; each is a code, so that scripts can tell them apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    /// What no other kind is, and several inputs that failed in different ways.
    Other = 1,
    /// The command line, a setting or a variable is wrong.
    Usage = 2,
    /// An input is no job and no mesh, or what it asks for cannot be done.
    Refused = 3,
    /// It can be done, but is beyond a limit.
    TooLarge = 4,
    /// Something cannot be read or written.
    Files = 5,
}

/// The codes that commands end with, as the help tells them.
pub(super) const CODES: &str = "\
Exit codes:
    0  all is done
    1  several inputs failed, in different ways; or what no other code names. `compare`, `figures --check` and
       `reproduce`: they differ
    2  the command line, a setting or a variable is wrong; nothing was begun
    3  an input was refused: it is no job and no mesh, or what is asked of it cannot be done
    4  a limit is exceeded
    5  something cannot be read or written, an address cannot be listened on, or a service gives no result
  130  interrupted (SIGINT); 143 terminated (SIGTERM); no unfinished file is left
Where several inputs fail in one way, the code is that of this way.";

/// Why a command failed.
#[derive(Debug)]
pub(super) struct CliError {
    /// The kind.
    pub(super) kind: Kind,
    /// What is wrong, one line for each thing; nothing where it was told already.
    pub(super) details: Vec<String>,
}

impl fmt::Display for CliError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.details.as_slice() {
            [one] => f.write_str(one),
            several => {
                write!(f, "{} things are wrong:", several.len())?;
                several.iter().try_for_each(|detail| write!(f, "\n  {detail}"))
            }
        }
    }
}

impl CliError {
    fn of(kind: Kind, text: &impl fmt::Display) -> Self {
        Self { kind, details: vec![text.to_string()] }
    }

    /// Failures that were told already.
    pub(super) fn told(kind: Kind) -> Self {
        Self { kind, details: Vec::new() }
    }

    /// The failure with the name of what it is about before it.
    pub(super) fn about(mut self, subject: &impl fmt::Display) -> Self {
        self.details.iter_mut().for_each(|detail| detail.insert_str(0, &format!("{subject}: ")));
        self
    }

    /// A failure that no other kind names.
    pub(super) fn other(text: impl fmt::Display) -> Self {
        Self::of(Kind::Other, &text)
    }

    /// A wrong command line or setting.
    pub(super) fn usage(text: impl fmt::Display) -> Self {
        Self::of(Kind::Usage, &text)
    }

    /// An input that is refused.
    pub(super) fn refused(text: impl fmt::Display) -> Self {
        Self::of(Kind::Refused, &text)
    }

    /// A limit that is exceeded.
    pub(super) fn too_large(text: impl fmt::Display) -> Self {
        Self::of(Kind::TooLarge, &text)
    }

    /// Something that cannot be read or written.
    pub(super) fn files(text: impl fmt::Display) -> Self {
        Self::of(Kind::Files, &text)
    }

    /// Faults, of the command line or of an input.
    pub(super) fn faults(kind: Kind, faults: &[Fault]) -> Self {
        Self { kind, details: faults.iter().map(ToString::to_string).collect() }
    }
}
