//! Parses a file of plans, and the files that it uses; each file is parsed once (docs/src/reference/language.md, 1).

use std::collections::BTreeSet;

use super::tree::{Name, Plan};
use super::{Arena, parse};
use crate::diagnostic::{Code, Diagnostic, SourceId, sort};

/// Finds and reads the files that plans use. No stage of the compiler reads a file itself.
pub trait Loader {
    /// Returns the file to which `path` in the file `from` refers. A file always has the same identifier, even if
    /// different paths lead to it.
    ///
    /// # Errors
    /// Returns the reason why the file cannot be read, in one line without a full stop.
    fn find(&mut self, from: SourceId, path: &str) -> Result<SourceId, String>;

    /// Returns the text of a file that `find` returned.
    fn text(&self, source: SourceId) -> &str;
}

/// A loader for a text that uses no files.
#[derive(Debug, Clone, Copy)]
pub struct NoFiles;

impl Loader for NoFiles {
    fn find(&mut self, _: SourceId, path: &str) -> Result<SourceId, String> {
        Err(format!("`{path}` cannot be used, since this text is in no file"))
    }

    fn text(&self, _: SourceId) -> &'static str {
        ""
    }
}

/// The plans of a file, and of the files that it uses.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Files<'s> {
    /// Plans in order; the plans of the file itself come first.
    pub plans: Vec<Plan<'s>>,
    /// Number of plans in the file itself.
    pub own: usize,
    /// `true` if plans may be missing, because a used file or the head of a plan could not be read.
    pub is_incomplete: bool,
}

/// A file whose used files are being parsed.
struct OpenFile<'s> {
    source: SourceId,
    uses: Vec<Name<'s>>,
    /// Number of used files that have been parsed.
    done: usize,
}

/// Parses a text and all files that it uses; returns their trees and all diagnostics.
#[must_use]
pub fn parse_with<'s>(
    source: SourceId,
    text: &'s str,
    arena: &'s Arena,
    loader: &mut dyn Loader,
) -> (Files<'s>, Vec<Diagnostic>) {
    let (file, mut found) = parse(source, text, arena);
    let mut files = Files { own: file.plans.len(), plans: file.plans, is_incomplete: file.is_incomplete };
    let mut met = BTreeSet::from([source]);
    let mut open = vec![OpenFile { source, uses: file.uses, done: 0 }];
    while let Some(here) = open.last_mut() {
        let Some(used) = here.uses.get(here.done).copied() else {
            open.pop();
            continue;
        };
        here.done += 1;
        match loader.find(here.source, used.node) {
            Err(reason) => {
                files.is_incomplete = true;
                found.push(unusable(used, reason));
            }
            Ok(source) if met.insert(source) => {
                let (file, more) = parse(source, arena.alloc_str(loader.text(source)), arena);
                files.plans.extend(file.plans);
                files.is_incomplete |= file.is_incomplete;
                found.extend(more);
                open.push(OpenFile { source, uses: file.uses, done: 0 });
            }
            Ok(source) => found.extend(cycle(&open, source)),
        }
    }
    sort(&mut found);
    (files, found)
}

fn unusable(used: Name<'_>, reason: String) -> Diagnostic {
    Diagnostic::new(Code::E0205, reason, used.span, "used here")
        .help("a path is looked up from the folder of the file that uses it")
}

/// Returns the diagnostic about a circular use; `None` if there is none. The last open file uses `source`, which is
/// circular if `source` is also open.
fn cycle(open: &[OpenFile<'_>], source: SourceId) -> Option<Diagnostic> {
    let from = open.iter().position(|file| file.source == source)?;
    let cycle = open.get(from..)?;
    let mut uses = cycle.iter().filter_map(|file| file.uses.get(file.done.checked_sub(1)?));
    let closing = uses.next_back()?;
    let message = if cycle.len() == 1 { "this file uses itself" } else { "these files use each other" };
    let found = Diagnostic::new(Code::E0206, message, closing.span, "the first file of the circle");
    let found = uses.fold(found, |found, used| found.also(used.span, format!("`{}` is used here", used.node)));
    Some(found.help("every file sees the plans of all used files: remove one of these lines"))
}
