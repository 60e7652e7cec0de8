//! `mdle log cut`: writes the first part of a record as a separate record.

use std::io::{self, BufWriter, Write as _};
use std::path::Path;
use std::process::ExitCode;

use mdle_record::frames::Frames;
use mdle_record::{Begin, Message, MessageKind, RecordFile, RecordedTurn, TurnMade};
use mdle_runtime::Nanos;

use super::{created, damaged, unwritten};
use crate::failure::{self, Failure};
use crate::messages::counted;
use crate::replay;

/// Writes the turns of a record up to the time `until` as a separate record.
///
/// # Errors
/// Fails if the record cannot be read, or if the new record cannot be written.
pub(super) fn cut(log: &Path, until: Nanos, file: &Path) -> Result<ExitCode, Failure> {
    let (begin, records) = replay::record(log)?;
    let mut part =
        CutRecord { frames: Frames::default(), to: RecordFile::new(BufWriter::new(created(file)?)), turns: 0 };
    for turn in records.with_messages() {
        let (turn, messages) = match turn {
            Ok(turn) => turn,
            Err(error) => {
                // The part written so far would look like a complete record.
                let _ = std::fs::remove_file(file);
                return damaged(log, &error);
            }
        };
        if turn.t > until {
            break;
        }
        part.turn(&begin, turn, messages).map_err(|error| unwritten(&file.display(), &error))?;
    }
    let turns = part.end().map_err(|error| unwritten(&file.display(), &error))?;
    writeln!(io::stdout().lock(), "{}: {}", file.display(), counted(turns, "turn"))
        .map_err(|error| failure::unprinted(&error))?;
    Ok(ExitCode::SUCCESS)
}

/// A record that is being written.
struct CutRecord<W: io::Write> {
    frames: Frames,
    to: RecordFile<W>,
    turns: u64,
}

impl<W: io::Write> CutRecord<W> {
    fn turn(&mut self, begin: &Begin, turn: RecordedTurn, messages: Vec<Message>) -> io::Result<()> {
        let mut bytes = Vec::new();
        let RecordedTurn { number, t, y, sent, applied, plan, state, steps, changes, overruled } = turn;
        if self.turns == 0 {
            self.frames.begin(begin, &y, &mut bytes);
        }
        let (changes, overruled) = (changes.as_slice(), overruled.as_ref());
        let made = TurnMade { number, t, sent, applied, plan, state, changes, overruled };
        self.frames.turn(made, &y, steps.into_iter(), &mut bytes);
        for Message { kind, json } in messages {
            match kind {
                MessageKind::Transition => self.frames.transition(t, &json, &mut bytes),
                MessageKind::Event => self.frames.event(t, &json, &mut bytes),
            }
        }
        self.turns += 1;
        self.to.write_all(&bytes)
    }

    /// Completes the record; returns the number of its turns.
    fn end(mut self) -> io::Result<u64> {
        let mut bytes = Vec::new();
        self.frames.end(&mut bytes);
        self.to.write_all(&bytes)?;
        self.to.flush()?;
        Ok(self.turns)
    }
}
