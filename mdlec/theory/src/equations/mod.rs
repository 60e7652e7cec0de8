//! The sum of a plan's transition matrices (paper, Eqs. 2 and 3): computes its terms, and prints them in the paper's
//! notation or as MatrixMarket files.

mod equation;
mod matrix_market;
mod terms;

pub use equation::{equation, most_states};
pub use matrix_market::{MatrixFiles, matrix_files};
pub use terms::{Extent, Term, Terms, terms};
