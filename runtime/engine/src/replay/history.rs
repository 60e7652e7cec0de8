//! Collects the inputs of an engine's turns other than the robot's outputs: module values that plans and safety rules
//! read, states of other robots, recorded paths, and changes of plans.

use mdle_record::RecordedChange;
use mdle_runtime::{Links, ModuleRead, Nanos, Peer, StoredPath};

use crate::attribute::{AGE, AttributeKind, AttributeName};
use crate::board::{Board, Post};

/// Changes that the record of a run needs.
#[derive(Debug, Default)]
pub(crate) struct History {
    /// Attributes that the record contains, by their number in the record; `None` for a removed attribute.
    known: Vec<Option<RecordedAttribute>>,
    /// Changes of the current turn.
    changes: Vec<RecordedChange>,
}

/// An attribute that the record contains.
#[derive(Debug)]
struct RecordedAttribute {
    name: AttributeName,
    kind: AttributeKind,
    /// Time and bits of the value that was recorded last; `None` before the first.
    reading: Option<(Nanos, u64)>,
}

impl History {
    /// Begins a turn, and records the changes of plans since the last turn. `reads` contains the attributes that plans
    /// and safety rules read now or may read in later turns.
    pub(crate) fn begin(
        &mut self,
        plans: Vec<RecordedChange>,
        reads: impl Iterator<Item = &'static ModuleRead>,
        board: &Board,
    ) {
        self.changes = plans;
        let mut posts: Vec<&Post> = Vec::new();
        for read in reads {
            let of_module = board.of(read.module);
            let is_read = |post: &&Post| read.attribute == AGE || *post.name.attribute == *read.attribute;
            for post in of_module.filter(is_read) {
                if !posts.iter().any(|other| std::ptr::eq(*other, post)) {
                    posts.push(post);
                }
            }
        }
        self.forget(board);
        posts.into_iter().for_each(|post| self.see(post));
    }

    /// Records a change of the current turn.
    pub(crate) fn note(&mut self, change: RecordedChange) {
        self.changes.push(change);
    }

    /// Records the states of other robots that are known in the current turn.
    pub(crate) fn heard(&mut self, links: &Links) {
        let peers = links.peers().map(|Peer { name, rounds, state }| RecordedChange::Peer {
            name: (*name).to_owned(),
            rounds: *rounds,
            state: *state,
        });
        self.changes.extend(peers);
    }

    /// Records that a newly recorded path has replaced the path with the same name.
    pub(crate) fn replaced(&mut self, StoredPath { name, setpoints }: &StoredPath) {
        self.changes.push(RecordedChange::Path { name: (*name).to_owned(), setpoints: setpoints.to_vec() });
    }

    /// Takes the changes of the turn.
    pub(crate) fn take(&mut self) -> Vec<RecordedChange> {
        std::mem::take(&mut self.changes)
    }

    /// Records which attributes were removed from the board, even if they were added again afterwards.
    fn forget(&mut self, board: &Board) {
        for (number, known) in (0..).zip(&mut self.known) {
            let has_gone = |known: &mut RecordedAttribute| {
                let post = board.post(&known.name.module, &known.name.attribute);
                post.is_none_or(|post| {
                    post.about.kind != known.kind || post.reading.is_none() && known.reading.is_some()
                })
            };
            if known.take_if(has_gone).is_some() {
                self.changes.push(RecordedChange::Vanished(number));
            }
        }
    }

    /// Records an attribute if the attribute or its value is new.
    fn see(&mut self, post: &Post) {
        let is_same = |known: &Option<RecordedAttribute>| known.as_ref().is_some_and(|known| known.name == post.name);
        let number = self.known.iter().position(is_same).unwrap_or_else(|| {
            let (name, kind) = (post.name.clone(), post.about.kind);
            let (module, attribute) = (name.module.to_string(), name.attribute.to_string());
            self.changes.push(RecordedChange::Attribute { module, name: attribute, kind: kind.number() });
            self.known.push(Some(RecordedAttribute { name, kind, reading: None }));
            self.known.len() - 1
        });
        let reading = post.reading.as_ref().map(|reading| (reading.at, reading.value.bits()));
        let Some(Some(known)) = self.known.get_mut(number) else { return };
        if let Some((at, bits)) = reading.filter(|_| known.reading != reading) {
            known.reading = reading;
            let attribute = u32::try_from(number).unwrap_or(u32::MAX);
            self.changes.push(RecordedChange::Published { attribute, at, bits });
        }
    }
}
