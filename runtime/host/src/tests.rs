//! Whole runs on a toy robot in virtual time: what the robot is sent, what is said, and the exit status, on every way out.

mod ends;
mod limits;
mod order;
mod output;
mod plan;
mod several;
mod toy;
