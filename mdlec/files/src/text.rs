//! Reads the text of a file that a user names, or standard input.

use std::path::Path;

use mdle_compiler::diagnostic::{Code, Diagnostic, Sources, Span};

use crate::{FaultyFile, InputError, read};

/// Reads a text file of at most `most` bytes, or standard input for `-`.
///
/// # Errors
/// Fails if the file cannot be read or is not text.
pub fn read_text(path: &Path, most: u64) -> Result<String, InputError> {
    let name = shown(path);
    let is_input = path == Path::new("-");
    let bytes = if is_input { read::standard_input(most) } else { read::file(path, most) };
    let bytes = bytes.map_err(|why| {
        InputError::Unusable(if why.is_missing() {
            format!("there is no file `{name}`{}", plan_nearby(path))
        } else {
            why.of(&name) + why.help()
        })
    })?;
    String::from_utf8(without_mark(bytes)).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        not_utf8(&name, error.as_bytes(), valid)
    })
}

/// Removes a byte order mark, which some editors write and which is not part of a plan.
#[must_use]
pub fn without_mark(bytes: Vec<u8>) -> Vec<u8> {
    bytes.strip_prefix(b"\xEF\xBB\xBF").map(<[u8]>::to_vec).unwrap_or(bytes)
}

/// Returns the name of a file for messages.
pub(crate) fn shown(path: &Path) -> String {
    if path == Path::new("-") { "standard input".into() } else { path.display().to_string() }
}

/// Returns the error for a file that is not text. The message shows the invalid character; the first `valid` bytes of
/// the file are valid UTF-8.
fn not_utf8(name: &str, bytes: &[u8], valid: usize) -> InputError {
    let mut sources = Sources::default();
    let source = sources.add(name, String::from_utf8_lossy(bytes));
    // The invalid bytes have been replaced by U+FFFD, which is three bytes long.
    let span = Span::new(source, valid, valid + 3);
    let found = Diagnostic::new(Code::E0109, "this file is not UTF-8 text", span, "no character of UTF-8")
        .help("save it as UTF-8 in your editor, or convert it: `iconv -f latin1 -t utf-8`");
    InputError::Faulty(FaultyFile { sources, diagnostics: vec![found], target: None })
}

/// Returns a hint for a path without the extension `.mdle`.
fn plan_nearby(path: &Path) -> String {
    let with_ending = path.with_extension("mdle");
    if with_ending.is_file() { format!("\nhelp: there is `{}`", with_ending.display()) } else { String::new() }
}
