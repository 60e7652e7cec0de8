//! The files of this repository, for tests that read its own sources.

use std::fs;
use std::path::{Path, PathBuf};

/// A text file of the repository.
#[derive(Debug, Clone)]
pub struct TextFile {
    /// Path of the file from the root, with `/`.
    pub path: String,
    /// Content of the file.
    pub text: String,
}

/// Returns the folder of the repository.
#[must_use]
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// Returns every file whose name ends with one of these endings, sorted by path. Build folders, symbolic links and
/// hidden folders are left out.
#[must_use]
pub fn files(endings: &[&str]) -> Vec<TextFile> {
    let mut found = Vec::new();
    let mut folders = vec![root()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap();
            if path.is_symlink() {
                // The link points to a file of another package, which is read there.
                continue;
            }
            if path.is_dir() {
                // Cargo marks the folders that it creates; a folder that was created in another way may lack the mark.
                let is_build = path == root().join("target") || path.join("CACHEDIR.TAG").exists();
                if !name.starts_with('.') && !is_build {
                    folders.push(path);
                }
            } else if endings.iter().any(|ending| name.ends_with(ending)) {
                found.push(read(&path));
            }
        }
    }
    found.sort_by(|one, other| one.path.cmp(&other.path));
    found
}

fn read(path: &Path) -> TextFile {
    let parts = path.strip_prefix(root()).unwrap().components();
    let path_text = parts.map(|part| part.as_os_str().to_str().unwrap()).collect::<Vec<_>>().join("/");
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{path_text}: {error}"));
    TextFile { path: path_text, text }
}

/// Returns the names that code uses from `root`: the name after `root::`, or each name in `root::{…}`. Comments are
/// ignored.
#[must_use]
pub fn names_from(text: &str, root: &str) -> Vec<String> {
    let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
    let start = format!("{root}::");
    let mut names = Vec::new();
    for (place, _) in code.match_indices(&start) {
        let is_whole_word = !code[..place].ends_with(|letter: char| letter.is_alphanumeric() || letter == '_');
        if is_whole_word {
            names.extend(names_at(&code[place + start.len()..]));
        }
    }
    names
}

/// Returns the first name of a path, or the first names of all paths in a group.
fn names_at(rest: &str) -> Vec<String> {
    let Some(group) = rest.strip_prefix('{') else { return vec![first_word(rest)] };
    let mut depth = 0_usize;
    let mut names = vec![first_word(group)];
    for (place, letter) in group.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => names.push(first_word(&group[place + 1..])),
            _ => {}
        }
    }
    names.retain(|name| !name.is_empty());
    names
}

fn first_word(text: &str) -> String {
    text.trim_start().chars().take_while(|letter| letter.is_alphanumeric() || *letter == '_').collect()
}
