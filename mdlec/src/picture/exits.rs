//! The element that follows when an element of a plan ends, with loops as they are written (docs/src/reference/semantics.md, 5.3).

use mdle_runtime::fsm::Kind;

use super::texts::{Texts, What};
use crate::fsm::Machine;

/// Where something leads when it ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Exit {
    /// To this atom, the first behind it; and whether only after the last pass of a loop.
    Behind { atom: usize, last_pass: bool },
    /// To the begin of this loop, for its next pass.
    Again { bracket: usize, times: Option<u64> },
    /// The plan is over; and whether only after the last pass of a loop.
    Over { last_pass: bool },
}

/// Where the bracket leads when it ends: to each loop outside it that ends with it, and behind all of these.
pub(super) fn exits(lowered: &Machine, bracket: usize) -> Vec<Exit> {
    let (mut exits, mut here, mut last_pass) = (Vec::new(), bracket, false);
    loop {
        let ended = &lowered.brackets[here];
        let holder = ended.parent as usize;
        // A bracket stands behind the one around it.
        if holder >= here {
            exits.push(Exit::Over { last_pass });
            return exits;
        }
        let around = &lowered.brackets[holder];
        if around.last != ended.last {
            exits.push(Exit::Behind { atom: ended.last as usize + 1, last_pass });
            return exits;
        }
        if let Kind::Loop { times, .. } = around.kind {
            let times = (times > 0).then_some(times);
            if times != Some(1) {
                exits.push(Exit::Again { bracket: holder, times });
                last_pass = true;
            }
            if times.is_none() {
                return exits;
            }
        }
        here = holder;
    }
}

/// How each bracket can end.
#[derive(Debug, Clone)]
pub(super) struct Ends {
    /// Whether it ends at all, by itself or with what it holds.
    pub(super) ever: Vec<bool>,
    /// Whether it ends with what it holds; of an atom, whether anything ends it.
    pub(super) at_its_end: Vec<bool>,
}

/// How the brackets of a machine can end.
pub(super) fn ends(texts: Texts<'_>) -> Ends {
    let count = texts.0.brackets.len();
    let mut ends = Ends { ever: vec![false; count], at_its_end: vec![false; count] };
    // Whether the last of what each bracket holds ends: it comes first, for inner brackets stand behind outer ones.
    let mut last = vec![None; count];
    for number in (0..count).rev() {
        let by_itself = texts.until(number).ends();
        let at_its_end = match texts.what(number) {
            What::Atom(..) => by_itself,
            What::Loop(None) => false,
            What::Loop(Some(_)) | What::Scope(_) => last[number] == Some(true),
        };
        (ends.ever[number], ends.at_its_end[number]) = (by_itself || at_its_end, at_its_end);
        last[texts.0.brackets[number].parent as usize].get_or_insert(ends.ever[number]);
    }
    ends
}
