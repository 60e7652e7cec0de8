//! Module attributes that a plan reads: their values in a turn, and the wait for missing ones before the plan can begin
//! (docs/src/reference/semantics.md, 2.5).

use std::collections::BTreeSet;

use mdle_compiler::alphabet::did_you_mean;
use mdle_runtime::{ModuleRead, Nanos, PUBLISHED, Published, PublishedNumber};

use crate::attribute::{AGE, AttributeName, Reading};
use crate::board::{Board, Post};
use crate::tree::listed;

/// Time for which a plan waits for the attributes that it reads, in addition to the latency of their module.
const PATIENCE: Nanos = Nanos(2_000_000_000);

/// Reason why a plan cannot begin in this turn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Unready {
    /// These attributes have not been published yet.
    Missing(Vec<&'static ModuleRead>),
    /// An attribute has another kind than the plan expects; contains a sentence about it.
    OtherKind(String),
}

/// Returns the values that a plan reads from modules at time `now`.
///
/// # Errors
/// Fails if some attributes have not been published, or if an attribute has another kind.
pub(super) fn published(reads: &'static [ModuleRead], board: &Board, now: Nanos) -> Result<Published, Unready> {
    let mut numbers = Published::new(reads);
    let mut missing = Vec::new();
    for (place, read) in reads.iter().enumerate().take(PUBLISHED) {
        if let Some(post) = board.post(read.module, read.attribute) {
            check_kind(read, post).map_err(|sentence| Unready::OtherKind(format!("the plan {sentence}")))?;
        }
        match number(read, reads, board, now) {
            Some(number) => numbers.set(place, Some(number)),
            None => missing.push(read),
        }
    }
    if missing.is_empty() { Ok(numbers) } else { Err(Unready::Missing(missing)) }
}

/// Returns the time for which a plan waits for the attributes `missing`, which have not been published yet.
pub(super) fn patience(missing: &[&ModuleRead], board: &Board) -> Nanos {
    let latency = |read: &&ModuleRead| Some(board.posts().get(board.place_of(read)?)?.latency);
    let longest = missing.iter().filter_map(latency).max().unwrap_or(Nanos::ZERO);
    Nanos(PATIENCE.0.saturating_add(longest.0))
}

/// Returns the error message about attributes that a plan reads and that were not published in time.
pub(super) fn in_vain(missing: &[&ModuleRead], board: &Board) -> String {
    let seconds = patience(missing, board).seconds();
    let paths = paths(missing);
    if missing.iter().all(|read| board.place_of(read).is_some()) {
        return format!(
            "the plan reads {paths}, which no module has published within {seconds} s\nhelp: a module in the \
             background that needs longer declares its `latency`, and the plan waits 2 s longer than that; if the \
             module publishes only while the robot moves, or only what it hears or sees, begin with another plan and \
             `swap` this one in"
        );
    }
    let absent = missing.iter().find(|read| board.place_of(read).is_none());
    let there_are = absent.map_or_else(String::new, |read| publishers(read, board));
    format!("the plan reads {paths}, which no module has published within {seconds} s{there_are}")
}

/// Returns the paths of the attributes `missing` as a list for a sentence. The age of a module is left out if another
/// attribute of the module is listed.
fn paths(missing: &[&ModuleRead]) -> String {
    let is_other = |read: &&&ModuleRead| read.attribute != AGE || others(read.module, missing).next().is_none();
    let missing = missing.iter().filter(is_other);
    let paths: Vec<_> = missing.map(|read| AttributeName::new(read.module, read.attribute).to_string()).collect();
    paths.join(" and ")
}

/// Returns the end of a sentence about a plan that is about to take over: the attributes for which the plan waits, and
/// the modules of these attributes that are not loaded. Empty if all attributes in `reads` have been published.
pub(super) fn awaited(reads: &'static [ModuleRead], board: &Board, now: Nanos) -> String {
    let Err(Unready::Missing(missing)) = published(reads, board, now) else { return String::new() };
    let absent = missing.iter().map(|read| read.module).filter(|module| board.of(module).next().is_none());
    let absent: BTreeSet<_> = absent.collect();
    let absent: String = absent.iter().map(|module| format!("; no module `{module}` is loaded")).collect();
    let paths = paths(&missing);
    let verb = if paths.contains(" and ") { "are" } else { "is" };
    format!(", once {paths} {verb} published{absent}")
}

/// Returns the end of a sentence about an attribute that does not exist. It lists the attributes of the module. If the
/// module is not loaded, it proposes a similar name and explains how to load a module.
fn publishers(read: &ModuleRead, board: &Board) -> String {
    let ModuleRead { module, attribute, .. } = read;
    let own: Vec<_> = board.of(module).map(|post| &*post.name.attribute).collect();
    if !own.is_empty() {
        return format!("{}\nhelp: `{module}` publishes {}", did_you_mean(attribute, &own), listed(&own));
    }
    let mut modules: Vec<&str> = board.posts().iter().map(|post| &*post.name.module).collect();
    modules.dedup();
    let others = modules.iter().filter(|name| board.post(name, attribute).is_some());
    let others: Vec<_> = others.map(|name| format!("`{name}`")).collect();
    let others =
        if others.is_empty() { String::new() } else { format!("; `{attribute}` is published by {}", listed(&others)) };
    let near = did_you_mean(module, &modules);
    format!("{near}\nhelp: no module `{module}` is loaded: `--module {module}=COMMAND` loads one{others}")
}

/// Returns the values that a running plan reads from modules at time `now`; attributes of unloaded modules have no
/// value.
pub(crate) fn current(reads: &'static [ModuleRead], board: &Board, now: Nanos) -> Published {
    let mut numbers = Published::new(reads);
    for (place, read) in reads.iter().enumerate().take(PUBLISHED) {
        let post = board.post(read.module, read.attribute);
        let is_fit = post.is_none_or(|post| check_kind(read, post).is_ok());
        numbers.set(place, number(read, reads, board, now).filter(|_| is_fit));
    }
    numbers
}

/// Checks that each attribute that a plan reads has the kind that the plan expects. Attributes that no module publishes
/// are ignored.
///
/// # Errors
/// Fails with a sentence if an attribute has another kind.
pub(crate) fn check_kinds<'r>(reads: impl IntoIterator<Item = &'r ModuleRead>, board: &Board) -> Result<(), String> {
    reads.into_iter().try_for_each(|read| match board.post(read.module, read.attribute) {
        Some(post) => check_kind(read, post).map_err(|sentence| format!("the plan {sentence}")),
        None => Ok(()),
    })
}

/// Checks that modules publish the attributes that safety rules or their plans read, with the kinds that these expect.
/// `reader` is the subject of the error message, such as `a safety rule`.
///
/// # Errors
/// Fails with a sentence if an attribute is not published, or has another kind.
pub(crate) fn check(reader: &str, reads: &[ModuleRead], board: &Board) -> Result<(), String> {
    let check = |read: &ModuleRead| match board.post(read.module, read.attribute) {
        Some(post) => check_kind(read, post).map_err(|sentence| format!("{reader} {sentence}")),
        None if board.place_of(read).is_some() => Ok(()),
        None => {
            let name = AttributeName::new(read.module, read.attribute);
            let there_are = publishers(read, board);
            Err(format!("{reader} reads {name}, which no module publishes{there_are}"))
        }
    };
    reads.iter().try_for_each(check)
}

/// Returns the age, at time `now`, of the oldest value of these attributes. An attribute that was never published is as
/// old as the run.
pub(crate) fn oldest<'r>(reads: impl Iterator<Item = &'r ModuleRead>, board: &Board, now: Nanos) -> Nanos {
    let age = |read: &ModuleRead| {
        let at = match read.attribute {
            AGE => newest_of(read.module, board),
            attribute => published_at(read.module, attribute, board),
        };
        now.since(at.unwrap_or(Nanos::ZERO))
    };
    reads.map(age).max().unwrap_or(Nanos::ZERO)
}

/// Checks that the kind of an attribute matches the unit in which a plan reads it.
///
/// # Errors
/// Fails with a sentence without its subject if kind and unit do not match.
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

/// Returns the value of the attribute `read` at time `now`; `None` if it was not published. `reads` contains all reads
/// of the plan, including `read`.
fn number(read: &ModuleRead, reads: &[ModuleRead], board: &Board, now: Nanos) -> Option<PublishedNumber> {
    if read.attribute == AGE {
        let at = oldest_of(read.module, reads, board)?;
        return Some(PublishedNumber { value: now.since(at).seconds(), at, age: now.since(at) });
    }
    let Reading { value, at } = board.post(read.module, read.attribute)?.reading.as_ref()?;
    value.number().map(|value| PublishedNumber { value, at: *at, age: now.since(*at) })
}

/// Returns the publication time of the oldest value that is read from this module. If only the age of the module is
/// read, returns the publication time of the module's newest value. Returns `None` if one of the values was not
/// published.
fn oldest_of(module: &str, reads: &[ModuleRead], board: &Board) -> Option<Nanos> {
    let mut attributes = others(module, reads).peekable();
    if attributes.peek().is_none() {
        return newest_of(module, board);
    }
    // If one of the attributes was not published, the age is undefined.
    attributes.try_fold(Nanos(u64::MAX), |oldest, attribute| Some(oldest.min(published_at(module, attribute, board)?)))
}

/// Returns the names of this module's attributes in `reads`, except its age.
fn others<'r, R: std::borrow::Borrow<ModuleRead>>(
    module: &'r str,
    reads: &'r [R],
) -> impl Iterator<Item = &'static str> {
    let reads = reads.iter().map(std::borrow::Borrow::borrow);
    reads.filter(move |read| read.module == module && read.attribute != AGE).map(|read| read.attribute)
}

fn newest_of(module: &str, board: &Board) -> Option<Nanos> {
    board.of(module).filter_map(|post| post.reading.as_ref()).map(|reading| reading.at).max()
}

fn published_at(module: &str, attribute: &str, board: &Board) -> Option<Nanos> {
    board.post(module, attribute)?.reading.as_ref().map(|reading| reading.at)
}
