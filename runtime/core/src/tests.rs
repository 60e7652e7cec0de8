//! The machine on tables by hand: where a plan goes, what starts afresh, and what a turn comes to.

mod cursor;
mod machine;
