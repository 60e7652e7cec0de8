//! Tests of the machine on tables by hand: the order of atoms, the restarts of brackets, and the result of a turn.

mod cursor;
mod machine;
