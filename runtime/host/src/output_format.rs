//! Checks the names of output files. If a name has an extension, it must be the extension of the option's format.

use std::path::{Path, PathBuf};

use clap::builder::{PathBufValueParser, TypedValueParser};

/// Returns a parser for an option that writes a file in `format`, such as `SVG`, with the ending `ending`, such as
/// `svg`. It accepts names with this ending in lower or upper case, and names without an ending.
pub fn output_format(format: &'static str, ending: &'static str) -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(move |path| match refusal(&path, format, ending) {
        Some(sentence) => Err(sentence),
        None => Ok(path),
    })
}

/// Returns the error message for `path` if it has an ending other than `ending`; `None` if the name is accepted.
fn refusal(path: &Path, format: &str, ending: &str) -> Option<String> {
    let given = path.extension().filter(|given| !given.eq_ignore_ascii_case(ending))?;
    let (given, name) = (given.to_string_lossy(), path.with_extension(ending));
    Some(format!("this option writes {format}, not {}; name the file `{}`", given.to_uppercase(), name.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ending_of_another_format_is_refused() {
        let refusal = |path: &str| refusal(Path::new(path), "SVG", "svg");
        for accepted in ["run.svg", "RUN.SVG", "run", "a.b/run", ".svg", "/dev/stdout", "../run.svg"] {
            assert_eq!(refusal(accepted), None, "{accepted}");
        }
        let sentence = "this option writes SVG, not PNG; name the file `out/run.svg`";
        assert_eq!(refusal("out/run.png").as_deref(), Some(sentence));
        assert!(["run.svgz", "run.", "run.svg.png"].into_iter().all(|path| refusal(path).is_some()));
    }
}
