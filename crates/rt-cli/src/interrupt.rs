//! Ctrl-C and SIGTERM: the first lets a rendering finish the tiles in flight and write what there is, the second
//! ends the process on the spot.
//!
//! SIGHUP is left alone on purpose: `nohup` has it ignored, and a handler would undo that.

use crate::failure::{Failure, Signal};
use crate::output;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};

/// Set by the first signal; the renderer starts no further tile then.
pub static STOP: AtomicBool = AtomicBool::new(false);
/// Whether there is work that can be ended early and written.
static RENDERING: AtomicBool = AtomicBool::new(false);
/// The number of the first signal, 0 before.
static FIRST: AtomicI32 = AtomicI32::new(0);

/// Takes over both signals. Until [`rendering`] is called, a signal ends the process at once.
pub fn install() -> Result<(), Failure> {
    let failed = |source: io::Error| Failure::Stream { action: "handle signals", source };
    watch().map_err(failed)
}

/// From here on the first signal asks for an orderly end.
pub fn rendering() {
    RENDERING.store(true, Ordering::SeqCst);
}

/// The signal that came, if any.
pub fn signal() -> Option<Signal> {
    match FIRST.load(Ordering::SeqCst) {
        0 => None,
        signal_hook::consts::SIGTERM => Some(Signal::Terminate),
        _ => Some(Signal::Interrupt),
    }
}

/// Takes note of a signal.
#[cfg_attr(not(unix), allow(dead_code))]
fn arrived(number: i32) {
    let first = FIRST.compare_exchange(0, number, Ordering::SeqCst, Ordering::SeqCst).is_ok();
    STOP.store(true, Ordering::SeqCst);
    if !first || !RENDERING.load(Ordering::SeqCst) {
        output::abandon();
        let code = if number == signal_hook::consts::SIGTERM { Signal::Terminate } else { Signal::Interrupt };
        std::process::exit(i32::from(code.exit_code()));
    }
}

#[cfg(unix)]
fn watch() -> io::Result<()> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM])?;
    std::thread::Builder::new().name("signals".into()).spawn(move || signals.forever().for_each(arrived))?;
    Ok(())
}

/// Elsewhere Ctrl-C ends the process as the system has it; files are whole all the same.
#[cfg(not(unix))]
fn watch() -> io::Result<()> {
    Ok(())
}
