//! Options of other programs, and which of ours does the same.

use clap::error::{ContextKind, ContextValue, ErrorKind};

/// What people try first, and what it is called here.
const OTHER_NAMES: [(&[&str], &str); 4] = [
    (&["--size", "--resolution", "--res", "--dimensions"], "the size is given by '--width' and '--height'"),
    (
        &["--samples", "--spp", "--antialias", "--antialiasing", "--supersampling"],
        "samples are given by '--aa grid:N'",
    ),
    (
        &["--out", "--outfile", "--output-file", "--file"],
        "the picture's name is given by '--output', '-o' for short",
    ),
    (&["--jobs", "-j", "--cores", "--cpus"], "threads are given by '--threads'"),
];

/// Adds to an error about an option that we do not have the name of the one that is meant, where that is known.
pub fn add_tip(error: &mut clap::Error) {
    if error.kind() != ErrorKind::UnknownArgument {
        return;
    }
    let Some(ContextValue::String(given)) = error.get(ContextKind::InvalidArg) else { return };
    let given = given.split('=').next().unwrap_or_default();
    let known = OTHER_NAMES.iter().find(|(names, _)| names.contains(&given));
    if let Some((_, tip)) = known {
        // Instead of a name that merely looks like it.
        error.remove(ContextKind::SuggestedArg);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![(*tip).into()]));
    }
}
