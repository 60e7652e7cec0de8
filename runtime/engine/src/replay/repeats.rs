//! Repeats the changes of a recorded run in an engine. The board contains the values that modules published in that
//! run, but the modules themselves are not loaded.

use mdle_record::RecordedChange;
use mdle_runtime::{Links, Peer, PeerState};

use crate::attribute::{AttributeKind, AttributeName, Reading, Value};
use crate::board::Board;

/// State of a replayed run.
#[derive(Debug, Default)]
pub(crate) struct Repeats {
    /// Attributes in the record, by their number.
    attributes: Vec<(AttributeName, AttributeKind)>,
    /// Name, number of rounds, and known state of each other robot in the current turn.
    peers: Vec<(String, u64, Option<PeerState>)>,
    progress: PlanProgress,
}

/// Progress of the plan's turn in the recorded run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum PlanProgress {
    /// The plan made its turn in time.
    #[default]
    Made,
    /// No thread started the turn in time.
    Skipped,
    /// A thread started the turn, but did not finish it in time.
    Late,
    /// The plan was still busy with an earlier turn, so it made no turn.
    Away,
    /// The plan finished an earlier turn.
    Back,
}

impl Repeats {
    /// Repeats a change of an attribute, of another robot, or of the progress of the plan's turn; ignores all other
    /// changes.
    pub(crate) fn repeat(&mut self, change: &RecordedChange, board: &mut Board) {
        match change {
            RecordedChange::Attribute { module, name, kind } => {
                let Some(kind) = AttributeKind::of_number(*kind) else { return };
                let name = AttributeName::new(module, name);
                board.restore(name.clone(), kind);
                self.attributes.push((name, kind));
            }
            RecordedChange::Vanished(attribute) => {
                if let Some((name, _)) = self.attributes.get(*attribute as usize) {
                    board.forget(name);
                }
            }
            RecordedChange::Published { attribute, at, bits } => {
                if let Some((name, kind)) = self.attributes.get(*attribute as usize) {
                    board.restore_reading(name, Reading { value: Value::of_bits(*kind, *bits), at: *at });
                }
            }
            RecordedChange::Skipped => self.progress = PlanProgress::Skipped,
            RecordedChange::Late => self.progress = PlanProgress::Late,
            RecordedChange::Back => self.progress = PlanProgress::Back,
            RecordedChange::Peer { name, rounds, state } => self.peers.push((name.clone(), *rounds, *state)),
            RecordedChange::Files(_)
            | RecordedChange::Armed { .. }
            | RecordedChange::Cancelled
            | RecordedChange::RolledBack(_)
            | RecordedChange::Trial(_)
            | RecordedChange::Limit { .. }
            | RecordedChange::SafetyReset
            | RecordedChange::Path { .. } => {}
        }
    }

    /// Returns the links to the robots with these names, with their states as known in the recorded turn.
    pub(crate) fn links(&self, robots: impl Iterator<Item = &'static str>) -> Links {
        let mut links = Links::NONE;
        for name in robots {
            let known = self.peers.iter().find(|(known, ..)| known == name);
            if let Some((_, rounds, state)) = known.filter(|_| links.peer(name).is_none()) {
                links.add(Peer { name, rounds: *rounds, state: *state });
            }
        }
        links
    }

    /// Returns `true` if the plan has to make a turn in the current turn.
    pub(crate) fn makes_turn(&self) -> bool {
        matches!(self.progress, PlanProgress::Made | PlanProgress::Late)
    }

    /// Returns `true` if the result of the plan's turn is taken from the desk in the current turn.
    pub(crate) fn lands(&self) -> bool {
        !matches!(self.progress, PlanProgress::Late | PlanProgress::Away)
    }

    /// Ends the current turn.
    pub(crate) fn end_turn(&mut self) {
        self.peers.clear();
        self.progress = match self.progress {
            PlanProgress::Made | PlanProgress::Skipped | PlanProgress::Back => PlanProgress::Made,
            PlanProgress::Late | PlanProgress::Away => PlanProgress::Away,
        };
    }
}
