//! The picture of `--plot`: the floor, the way driven, and where each atom began.

mod drawing;
mod labels;
mod layout;

pub(crate) use drawing::svg;
