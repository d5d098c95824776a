//! Why a command ends early, and the exit code that tells it.

use std::io;
use std::path::PathBuf;

/// The exit codes: 0 done, 1 input/output or rendering failed, 2 wrong usage, 3 bad scene or input, 130 and 143
/// interrupted.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// A file could not be read or written.
    #[error("cannot {action} {}: {source}", path.display())]
    File { action: &'static str, path: PathBuf, source: io::Error },
    /// Standard input or output failed.
    #[error("cannot {action}: {source}")]
    Stream { action: &'static str, source: io::Error },
    /// Something else prevented the work.
    #[error("{0}")]
    Work(String),
    /// The options do not make sense together.
    #[error("{0}")]
    Usage(String),
    /// The scene or the input is wrong; the text is complete, with its places.
    #[error("{0}")]
    Input(String),
    /// Whoever read our standard output has gone: nothing is left to say.
    #[error("standard output was closed")]
    Closed,
    /// A signal ended the work early; what was finished has been written.
    #[error("interrupted")]
    Interrupted(Signal),
}

/// The signals that end a rendering.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    /// Ctrl-C, SIGINT.
    Interrupt,
    /// SIGTERM.
    Terminate,
}

impl Signal {
    /// 128 plus the number of the signal, as shells report it.
    pub fn exit_code(self) -> u8 {
        match self {
            Signal::Interrupt => 130,
            Signal::Terminate => 143,
        }
    }
}

impl Failure {
    pub fn file(action: &'static str, path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Failure {
        let path = path.into();
        move |source| Failure::File { action, path, source }
    }

    /// A failure of standard output.
    pub fn stdout(source: io::Error) -> Failure {
        if source.kind() == io::ErrorKind::BrokenPipe {
            return Failure::Closed;
        }
        Failure::Stream { action: "write to standard output", source }
    }

    pub fn exit_code(&self) -> u8 {
        match self {
            Failure::File { .. } | Failure::Stream { .. } | Failure::Work(_) | Failure::Closed => 1,
            Failure::Usage(_) => 2,
            Failure::Input(_) => 3,
            Failure::Interrupted(signal) => signal.exit_code(),
        }
    }

    /// What to print on standard error, if anything.
    pub fn report(&self) -> Option<String> {
        match self {
            Failure::Closed | Failure::Interrupted(_) => None,
            // Already complete: `file:line:column: error: ...`.
            Failure::Input(text) => Some(text.clone()),
            other => Some(format!("error: {other}")),
        }
    }
}
