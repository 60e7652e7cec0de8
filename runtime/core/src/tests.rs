//! Tests the machine with handwritten tables: the order of atoms, the restarts of brackets, and the result of a turn.

mod cursor;
mod machine;
