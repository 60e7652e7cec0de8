//! The book in `docs/`: its pages, the examples in them, and the chapter that is generated.

use std::fmt::Write;

use mdle_compiler::diagnostic::Code;

use crate::repository::{TextFile, files, root};

/// A fenced block of a page: the words after its backticks, which are separated by commas, and its content, with
/// included files inserted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fence {
    /// Words of the block: first its kind, then its other properties.
    pub words: Vec<String>,
    /// Content of the block.
    pub text: String,
}

impl Fence {
    /// Returns the name of the file to which the block is written, or `None` if the block names no file.
    #[must_use]
    pub fn file(&self) -> Option<&str> {
        self.words.iter().skip(1).map(String::as_str).find(|word| word.contains('.'))
    }

    /// Returns the codes of the messages that the block is expected to cause.
    #[must_use]
    pub fn codes(&self) -> Vec<&str> {
        self.words.iter().skip(1).map(String::as_str).filter(|word| !word.contains('.')).collect()
    }
}

/// Returns every page, including the table of contents.
#[must_use]
pub fn pages() -> Vec<TextFile> {
    files(&[".md"]).into_iter().filter(|file| file.path.starts_with("docs/src/")).collect()
}

/// Returns the name of a page's file.
#[must_use]
pub fn name(page: &TextFile) -> &str {
    page.path.trim_start_matches("docs/src/")
}

/// Returns the name of the page to which `link`, a path relative to the folder of `page`, leads.
#[must_use]
pub fn leads_to(page: &TextFile, link: &str) -> String {
    if link.is_empty() {
        return name(page).to_owned();
    }
    let mut parts: Vec<_> = name(page).split('/').collect();
    parts.pop();
    for part in link.split('/') {
        match part {
            ".." => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// Returns the fenced blocks of a page in order.
#[must_use]
pub fn fences(page: &TextFile) -> Vec<Fence> {
    let mut found: Vec<Fence> = Vec::new();
    let mut is_inside = false;
    for line in page.text.lines() {
        match (line.strip_prefix("```"), is_inside) {
            (Some(""), true) => is_inside = false,
            (Some(words), false) => {
                assert!(!words.is_empty(), "{}: say what a block holds", page.path);
                let words = words.split(',').map(str::to_owned).collect();
                found.push(Fence { words, text: String::new() });
                is_inside = true;
            }
            (Some(_), true) => panic!("{}: a block in a block: {line}", page.path),
            (None, true) => {
                let fence = found.last_mut().expect("a block");
                fence.text += &included(line);
                fence.text += "\n";
            }
            (None, false) => {}
        }
    }
    assert!(!is_inside, "{}: a block does not end", page.path);
    found
}

/// Returns a line or, if the line includes a file, the text of the file, without the last line break.
fn included(line: &str) -> String {
    let Some(path) = line.strip_prefix("{{#include ").and_then(|line| line.strip_suffix("}}")) else {
        return line.to_owned();
    };
    let text = std::fs::read_to_string(root().join("docs/src").join(path)).unwrap_or_else(|_| panic!("no {path}"));
    text.trim_end().to_owned()
}

/// Returns the targets of a page's links, except those in blocks of code.
#[must_use]
pub fn links(page: &TextFile) -> Vec<&str> {
    let mut is_inside = false;
    let lines = page.text.lines().filter(|line| {
        let is_fence = line.starts_with("```");
        is_inside ^= is_fence;
        !is_inside && !is_fence && !line.starts_with("    ")
    });
    lines.flat_map(|line| line.split("](").skip(1).filter_map(|rest| rest.split(')').next())).collect()
}

/// Returns the anchors of a page. An anchor consists of the words of a heading in lower case, joined by `-`.
#[must_use]
pub fn anchors(page: &TextFile) -> Vec<String> {
    let headings =
        page.text.lines().filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    let kept = |letter: char| match letter {
        ' ' => Some('-'),
        _ => (letter.is_alphanumeric() || "_-".contains(letter)).then(|| letter.to_ascii_lowercase()),
    };
    headings.map(|heading| heading.chars().filter_map(kept).collect()).collect()
}

/// Returns the generated chapter of all messages, with the texts of `mdlec explain`.
#[must_use]
pub fn messages() -> String {
    let mut text = "# All messages\n\n\
        Every message has a code. Those that begin with E are errors: nothing is built. Those with W are warnings, which stop\n\
        nothing unless `--deny-warnings` is given. `mdlec explain CODE` prints what this page says.\n"
        .to_owned();
    for code in Code::ALL {
        write!(text, "\n## {code}\n\n**{}.**\n\n{}", capital(code.title()), code.explanation().text()).expect("a text");
    }
    text
}

fn capital(title: &str) -> String {
    let mut letters = title.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}
