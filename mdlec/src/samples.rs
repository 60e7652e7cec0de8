//! What unit tests share: alphabets, and a text with what the compiler says of it in one snapshot.

use crate::alphabet::{self, Alphabet, AlphabetFile};
use crate::diagnostic::{SourceId, Sources};
use crate::{Compiled, compile, link};

/// The alphabet of a built-in target, or of a robot that has everything; its places are in [`sources`].
pub(crate) fn alphabet(target: Option<&str>) -> Alphabet {
    let mut sources = Sources::default();
    let read = |(source, file): (SourceId, &link::Alphabet)| -> AlphabetFile {
        let (alphabet, found) = alphabet::read(source, file.text);
        assert_eq!(found, [], "{}", file.file);
        alphabet.expect("an alphabet has a head")
    };
    let placed = link::alphabets().iter().map(|file| (sources.add(file.file, file.text), file));
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

/// The files of the alphabets; a plan's comes behind them.
pub(crate) fn sources() -> Sources {
    let mut sources = Sources::default();
    for file in link::alphabets() {
        sources.add(file.file, file.text);
    }
    sources
}

/// The plans of a text that has no error.
pub(crate) fn compiled(text: &str) -> Vec<Compiled> {
    let (compiled, said) = said(text, None);
    assert!(!compiled.is_empty(), "{said}");
    compiled
}

/// A text with what the compiler says of it, and the plan without degeneracy if there is one.
pub(crate) fn judged(text: &str, target: Option<&str>) -> String {
    let (compiled, said) = said(text, target);
    let plans: Vec<_> = compiled.iter().map(|compiled| compiled.nondegenerate.plan().to_string()).collect();
    format!("{}\n----\n{said}{}", text.trim_end(), plans.join(""))
}

fn said(text: &str, target: Option<&str>) -> (Vec<Compiled>, String) {
    let mut sources = sources();
    let source = sources.add("plan.mdle", text);
    let (compiled, found) = compile(source, text, &alphabet(target), None);
    let said = found.iter().map(|diagnostic| sources.render(diagnostic)).collect();
    (compiled, said)
}
