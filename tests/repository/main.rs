//! Tests of the repository: its files, its dependency rules, its book, and the table of what tests cover.

mod book;
mod circles;
mod codes;
mod coverage;
mod directions;
mod manifests;
mod packages;
mod readme;
mod tidy;
mod versions;
