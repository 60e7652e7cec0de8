//! Reads the JSON output of cargo: the errors of rustc with their places, and the test executables.

use std::path::PathBuf;

use serde::Deserialize;

/// A line of cargo's output, with the fields that are used here.
#[derive(Debug, Deserialize)]
struct CargoMessage {
    reason: String,
    message: Option<Message>,
    manifest_path: Option<PathBuf>,
    executable: Option<PathBuf>,
    profile: Option<Profile>,
}

#[derive(Debug, Deserialize)]
struct Profile {
    test: bool,
}

#[derive(Debug, Deserialize)]
struct Message {
    level: String,
    rendered: Option<String>,
    spans: Vec<Span>,
    children: Vec<Message>,
}

#[derive(Debug, Deserialize)]
struct Span {
    file_name: String,
    byte_start: usize,
    is_primary: bool,
    expansion: Option<Box<Expansion>>,
}

#[derive(Debug, Deserialize)]
struct Expansion {
    span: Span,
}

/// An error of rustc.
#[derive(Debug)]
pub(crate) struct Refusal {
    /// Text of the error as rustc prints it.
    pub(crate) text: String,
    /// Places to which the error refers, the most important one first, each as a file and a byte offset.
    pub(crate) places: Vec<(String, usize)>,
}

/// A test executable, and the folder in which it runs.
#[derive(Debug)]
pub(crate) struct Executable {
    pub(crate) path: PathBuf,
    pub(crate) folder: PathBuf,
}

/// Returns the errors in the output of cargo.
pub(crate) fn refusals(printed: &str) -> Vec<Refusal> {
    let errors = lines(printed).filter_map(|line| line.message).filter(|message| message.level == "error");
    let refusals = errors.map(|message| {
        let mut places = Vec::new();
        for is_primary in [true, false] {
            places_of(&message, is_primary, &mut places);
        }
        Refusal { text: message.rendered.unwrap_or_default(), places }
    });
    // A summary such as "aborting due to …" has no place.
    refusals.filter(|refusal| !refusal.places.is_empty()).collect()
}

/// Returns the test executables in the output of cargo.
pub(crate) fn executables(printed: &str) -> Vec<Executable> {
    let tests = lines(printed).filter(|line| line.profile.as_ref().is_some_and(|profile| profile.test));
    let tests = tests.filter_map(|line| {
        let folder = line.manifest_path?.parent()?.to_owned();
        Some(Executable { path: line.executable?, folder })
    });
    tests.collect()
}

fn lines(printed: &str) -> impl Iterator<Item = CargoMessage> {
    let lines = printed.lines().filter_map(|line| serde_json::from_str::<CargoMessage>(line).ok());
    lines.filter(|line| matches!(&*line.reason, "compiler-message" | "compiler-artifact"))
}

/// Adds the places to which a message points. For a place inside a macro, also adds the places at which the macro is
/// called.
fn places_of(message: &Message, is_primary: bool, places: &mut Vec<(String, usize)>) {
    for span in message.spans.iter().filter(|span| span.is_primary == is_primary) {
        let mut inside = Some(span);
        while let Some(span) = inside {
            places.push((span.file_name.clone(), span.byte_start));
            inside = span.expansion.as_ref().map(|expansion| &expansion.span);
        }
    }
    message.children.iter().for_each(|child| places_of(child, is_primary, places));
}

#[cfg(test)]
mod tests {
    use super::{executables, refusals};

    const SPAN: &str = r#""file_name":"a.rs","is_primary""#;

    #[test]
    fn an_error_is_about_its_place_and_where_the_macro_was_called() {
        let inside = format!(r#"{{{SPAN}:true,"byte_start":3,"expansion":null}}"#);
        let printed = format!(
            r#"{{"reason":"compiler-message","message":{{"level":"error","rendered":"no","children":[],"spans":[
                {{{SPAN}:false,"byte_start":1,"expansion":null}},
                {{{SPAN}:true,"byte_start":2,"expansion":{{"span":{inside}}}}}]}}}}"#
        );
        let warning = printed.replace(r#""error""#, r#""warning""#);
        let printed = format!("no JSON\n{}\n{}\n", printed.replace('\n', ""), warning.replace('\n', ""));
        let [refusal] = &*refusals(&printed) else { panic!("one error") };
        assert_eq!(refusal.text, "no");
        assert_eq!(refusal.places, [2, 3, 1].map(|byte| ("a.rs".to_owned(), byte)));
    }

    #[test]
    fn executables_of_tests_run_in_the_folder_of_their_package() {
        let artifact = |test| {
            format!(
                r#"{{"reason":"compiler-artifact","manifest_path":"/p/Cargo.toml","executable":"/t/{test}","profile":{{"test":{test}}}}}"#
            )
        };
        let printed = [artifact(true), artifact(false)].join("\n");
        let [executable] = &*executables(&printed) else { panic!("one test") };
        assert_eq!([&executable.path, &executable.folder], ["/t/true", "/p"].map(std::path::Path::new));
    }
}
