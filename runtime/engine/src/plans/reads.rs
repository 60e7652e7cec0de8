//! Attributes of modules that a plan reads: their numbers for a turn, and what is missing before the plan can begin
//! (docs/src/reference/semantics.md, 2.5).

use mdle_runtime::{ModuleRead, Nanos, PUBLISHED, Published, PublishedNumber};

use crate::attribute::{AttributeName, Reading};
use crate::board::{Board, Post};

/// Time for which a plan waits for what it reads.
pub(super) const PATIENCE: Nanos = Nanos(2_000_000_000);

/// Reason why a plan cannot begin in this turn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Unready {
    /// These attributes have not been published yet: their paths.
    Missing(String),
    /// An attribute has another kind than the plan reads: a sentence.
    OtherKind(String),
}

/// Returns the numbers that a plan reads at time `now`.
///
/// # Errors
/// Not all of them have been published, or one is of another kind.
pub(super) fn published(reads: &'static [ModuleRead], board: &Board, now: Nanos) -> Result<Published, Unready> {
    let mut numbers = Published::new(reads);
    let mut missing = Vec::new();
    for (place, read) in reads.iter().enumerate().take(PUBLISHED) {
        let post = board.post(read.module, read.attribute);
        if let Some(post) = post {
            check_kind(read, post).map_err(|sentence| Unready::OtherKind(format!("the plan {sentence}")))?;
        }
        match post.and_then(|post| number(post.reading.as_ref()?, now)) {
            Some(number) => numbers.set(place, Some(number)),
            None => missing.push(AttributeName::new(read.module, read.attribute).to_string()),
        }
    }
    if missing.is_empty() { Ok(numbers) } else { Err(Unready::Missing(missing.join(" and "))) }
}

/// Returns the numbers that a plan which runs reads at time `now`. A module may have vanished meanwhile.
pub(crate) fn current(reads: &'static [ModuleRead], board: &Board, now: Nanos) -> Published {
    let mut numbers = Published::new(reads);
    for (place, read) in reads.iter().enumerate().take(PUBLISHED) {
        let post = board.post(read.module, read.attribute);
        let post = post.filter(|post| check_kind(read, post).is_ok());
        numbers.set(place, post.and_then(|post| number(post.reading.as_ref()?, now)));
    }
    numbers
}

/// Compares the kinds of attributes with the units in which safety rules read them.
///
/// # Errors
/// They differ: a sentence.
pub(crate) fn check(reads: &[ModuleRead], board: &Board) -> Result<(), String> {
    let posts = reads.iter().filter_map(|read| Some((read, board.post(read.module, read.attribute)?)));
    let mut checked = posts.map(|(read, post)| check_kind(read, post));
    checked.try_for_each(|checked| checked.map_err(|sentence| format!("a safety rule {sentence}")))
}

/// Returns the age at time `now` of the oldest of these attributes; one that no module has published is as old as the
/// run.
pub(crate) fn oldest<'r>(reads: impl Iterator<Item = &'r ModuleRead>, board: &Board, now: Nanos) -> Nanos {
    let age = |read: &ModuleRead| {
        let reading = board.post(read.module, read.attribute).and_then(|post| post.reading.as_ref());
        now.since(reading.map_or(Nanos::ZERO, |reading| reading.at))
    };
    reads.map(age).max().unwrap_or(Nanos::ZERO)
}

/// Compares the kind of an attribute with the unit in which a plan reads it.
///
/// # Errors
/// They differ: a sentence without a subject.
fn check_kind(read: &ModuleRead, post: &Post) -> Result<(), String> {
    let Post { name, about, .. } = post;
    let quantity = about.kind.quantity();
    let unit = quantity.and_then(|kind| kind.base_unit()).map(|unit| unit.name);
    if quantity.is_none() || read.unit.is_some() && read.unit != unit {
        let expected = read.unit.unwrap_or("a number");
        return Err(format!("reads {name} in {expected}, and it is {}", about.kind.words()));
    }
    Ok(())
}

fn number(Reading { value, at }: &Reading, now: Nanos) -> Option<PublishedNumber> {
    value.number().map(|value| PublishedNumber { value, at: *at, age: now.since(*at) })
}
