//! Citations of the book in comments and tables: the path of a page, and numbers of its sections.

use crate::repository::TextFile;

/// Folder of the book's pages. Every citation begins with it.
const BOOK: &str = "docs/src/";

/// A citation, such as `PAGE, 5.2 and 6`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Citation {
    /// Path of the page from the root of the repository.
    pub path: String,
    /// Numbers of the sections; empty if the whole page is cited.
    pub sections: Vec<String>,
    /// `true` if a quotation mark follows the path, as in code that opens the file.
    pub is_quoted: bool,
}

/// Returns the citations in a text. A citation may continue on the next line, after the mark of a comment.
#[must_use]
pub fn citations(text: &str) -> Vec<Citation> {
    let lines = text.lines().map(|line| line.trim_start().trim_start_matches(['/', '!', '#']).trim());
    let text = lines.collect::<Vec<_>>().join(" ");
    let found = text.match_indices(BOOK).filter_map(|(at, _)| {
        let rest = text.get(at..)?;
        let end = rest.find(|letter: char| !(letter.is_ascii_alphanumeric() || "/_-.".contains(letter)));
        let (path, rest) = rest.split_at(end.unwrap_or(rest.len()));
        let path = path.trim_end_matches('.');
        let is_quoted = rest.starts_with('"');
        path.ends_with(".md").then(|| Citation { path: path.to_owned(), sections: sections(rest), is_quoted })
    });
    found.collect()
}

/// Returns the section numbers after a path, as in `, 5.2 and 6`.
fn sections(mut rest: &str) -> Vec<String> {
    let mut sections = Vec::new();
    let mut joints: &[&str] = &[", "];
    while let Some(numbered) = joints.iter().find_map(|joint| rest.strip_prefix(joint)) {
        let number = number(numbered);
        if number.is_empty() {
            break;
        }
        sections.push(number.to_owned());
        rest = numbered.get(number.len()..).unwrap_or_default();
        joints = &[", ", " and ", " to "];
    }
    sections
}

/// Returns the section number at the beginning of a text: digits, with points only between digits.
fn number(text: &str) -> &str {
    let end = text.find(|letter: char| !(letter.is_ascii_digit() || letter == '.')).unwrap_or(text.len());
    text.get(..end).unwrap_or_default().trim_end_matches('.')
}

/// Returns the section numbers at the beginning of a page's headings.
#[must_use]
pub fn numbered_sections(page: &TextFile) -> Vec<&str> {
    let headings = page.text.lines().filter(|line| line.starts_with('#'));
    let numbers = headings.map(|line| number(line.trim_start_matches('#').trim_start()));
    numbers.filter(|number| !number.is_empty()).collect()
}

/// Returns the reason why a citation is wrong, or `None` if its page and all its sections exist.
#[must_use]
pub fn dangling(citation: &Citation, pages: &[TextFile]) -> Option<String> {
    let Some(page) = pages.iter().find(|page| page.path == citation.path) else {
        return Some(format!("there is no page {}", citation.path));
    };
    let known = numbered_sections(page);
    let missing = citation.sections.iter().find(|section| !known.contains(&section.as_str()));
    missing.map(|section| format!("{} has no section {section}", citation.path))
}
