//! Records in the form that commands read, and the parts of a turn in which a run differs from its record.

use std::io::{BufReader, Read};

use mdle_record::Records;

/// Text that is shown instead of a law at the end of a plan.
pub(crate) const OVER: &str = "plan over";

/// Source of the bytes of a record.
pub(crate) type RecordSource = BufReader<Box<dyn Read>>;
/// A record that is being read.
pub(crate) type Record = Records<RecordSource>;

/// A part of a turn in which the replay differs from the record.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct DifferingPart {
    /// Name of the part.
    pub(crate) name: String,
    /// The part as recorded.
    pub(crate) recorded: String,
    /// The part as replayed.
    pub(crate) replayed: String,
}

impl DifferingPart {
    /// Creates a part called `name`; an empty text is shown as `none`.
    pub(crate) fn new(name: &str, recorded: &str, replayed: &str) -> Self {
        let [recorded, replayed] = [recorded, replayed].map(|text| if text.is_empty() { "none" } else { text });
        Self { name: name.to_owned(), recorded: recorded.to_owned(), replayed: replayed.to_owned() }
    }
}
