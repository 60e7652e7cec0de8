//! Helpers for unit tests: alphabets, and snapshots of a text with its messages.

use crate::alphabet::{self, Alphabet, AlphabetFile};
use crate::diagnostic::{SourceId, Sources};
use crate::syntax::Loader;
use crate::{Compiled, builtin, compile, compile_with};

/// Returns the alphabet of a built-in target, or of a robot with every capability; its spans refer to [`sources`].
pub(crate) fn alphabet(target: Option<&str>) -> Alphabet {
    let mut sources = Sources::default();
    let read = |(source, file): (SourceId, &builtin::Alphabet)| -> AlphabetFile {
        let (alphabet, found) = alphabet::read(source, file.text);
        assert_eq!(found, [], "{}", file.file);
        alphabet.expect("an alphabet has a head")
    };
    let placed = builtin::alphabets().iter().map(|file| (sources.add(file.file, file.text), file));
    let (targets, shared): (Vec<_>, Vec<_>) = placed.partition(|(_, file)| file.target);
    let shared: Vec<_> = shared.into_iter().map(read).collect();
    match target {
        None => Alphabet::shared(shared[0].clone()),
        Some(name) => {
            let own = read(targets.into_iter().find(|(_, file)| file.name == name).expect(name));
            let (alphabet, found) = alphabet::combine(own, &shared);
            assert_eq!(found, []);
            alphabet
        }
    }
}

/// Returns the files of the alphabets; a plan's file is added after them.
pub(crate) fn sources() -> Sources {
    let mut sources = Sources::default();
    for file in builtin::alphabets() {
        sources.add(file.file, file.text);
    }
    sources
}

/// Compiles a text that must have no errors.
pub(crate) fn compiled(text: &str) -> Vec<Compiled> {
    let (compiled, messages) = diagnosed(text, None);
    assert!(!compiled.is_empty(), "{messages}");
    compiled
}

/// Returns a text with its messages, and the plan without degeneracy if there is one.
pub(crate) fn judged(text: &str, target: Option<&str>) -> String {
    let (compiled, messages) = diagnosed(text, target);
    let plans: Vec<_> = compiled.iter().map(|compiled| compiled.nondegenerate.plan().to_string()).collect();
    format!("{}\n----\n{messages}{}", text.trim_end(), plans.join(""))
}

/// Returns the first of these files with its messages and its plans; the file may use the others by their names.
pub(crate) fn judged_files(files: &[(&str, &str)]) -> String {
    struct Given(Sources, Vec<(String, SourceId)>);
    impl Loader for Given {
        fn find(&mut self, _: SourceId, path: &str) -> Result<SourceId, String> {
            let found = self.1.iter().find(|(name, _)| name == path.trim_start_matches("./"));
            found.map(|(_, source)| *source).ok_or_else(|| format!("there is no file `{path}`"))
        }

        fn text(&self, source: SourceId) -> &str {
            self.0.text(source)
        }
    }
    let mut given = Given(sources(), Vec::new());
    for (name, text) in files {
        let source = given.0.add(*name, *text);
        given.1.push(((*name).to_owned(), source));
    }
    let (source, text) = (given.1[0].1, files[0].1);
    let (compiled, found) = compile_with(source, text, &alphabet(None), None, &mut given);
    let messages: String = found.iter().map(|diagnostic| given.0.render(diagnostic)).collect();
    let plans: Vec<_> = compiled.iter().map(|compiled| compiled.nondegenerate.plan().to_string()).collect();
    let texts: Vec<_> = files.iter().map(|(name, text)| format!("{name}\n{}\n", text.trim_end())).collect();
    format!("{}----\n{messages}{}", texts.concat(), plans.concat())
}

/// Compiles a text; returns its plans and its rendered messages.
fn diagnosed(text: &str, target: Option<&str>) -> (Vec<Compiled>, String) {
    let mut sources = sources();
    let source = sources.add("plan.mdle", text);
    let (compiled, found) = compile(source, text, &alphabet(target), None);
    let messages = found.iter().map(|diagnostic| sources.render(diagnostic)).collect();
    (compiled, messages)
}
