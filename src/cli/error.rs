//! Errors of commands, and their exit codes.

use std::fmt;

use crate::fault::Fault;

/// The kinds of errors; the value of each is its exit code, so that scripts can tell them apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum ExitKind {
    /// None of the other kinds, or several inputs that failed in different ways.
    Other = 1,
    /// The command line, a setting or an environment variable is wrong.
    Usage = 2,
    /// An input is neither a job nor a mesh, or its request is impossible.
    Refused = 3,
    /// The request is possible, but exceeds a limit.
    TooLarge = 4,
    /// Something cannot be read or written.
    Files = 5,
}

/// The exit codes, as the help shows them.
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

/// The error of a command.
#[derive(Debug)]
pub(super) struct CliError {
    /// The kind, which determines the exit code.
    pub(super) kind: ExitKind,
    /// The error messages, one line each; empty if they were printed already.
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
    fn of(kind: ExitKind, text: &impl fmt::Display) -> Self {
        Self { kind, details: vec![text.to_string()] }
    }

    /// Creates an error whose messages were printed already.
    pub(super) fn printed(kind: ExitKind) -> Self {
        Self { kind, details: Vec::new() }
    }

    /// Prefixes each message with the name of its subject.
    pub(super) fn about(mut self, subject: &impl fmt::Display) -> Self {
        self.details.iter_mut().for_each(|detail| detail.insert_str(0, &format!("{subject}: ")));
        self
    }

    /// Creates an error of no other kind.
    pub(super) fn other(text: impl fmt::Display) -> Self {
        Self::of(ExitKind::Other, &text)
    }

    /// Creates an error for a wrong command line or setting.
    pub(super) fn usage(text: impl fmt::Display) -> Self {
        Self::of(ExitKind::Usage, &text)
    }

    /// Creates an error for a refused input.
    pub(super) fn refused(text: impl fmt::Display) -> Self {
        Self::of(ExitKind::Refused, &text)
    }

    /// Creates an error for an exceeded limit.
    pub(super) fn too_large(text: impl fmt::Display) -> Self {
        Self::of(ExitKind::TooLarge, &text)
    }

    /// Creates an error for something that cannot be read or written.
    pub(super) fn files(text: impl fmt::Display) -> Self {
        Self::of(ExitKind::Files, &text)
    }

    /// Creates an error from faults of the command line or of an input.
    pub(super) fn faults(faults: impl IntoIterator<Item = Fault>) -> Self {
        Self { kind: ExitKind::Refused, details: faults.into_iter().map(|fault| fault.to_string()).collect() }
    }
}
