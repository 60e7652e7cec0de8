//! Tests of whole runs on a toy robot in virtual time: the robot's inputs, the output, and the exit status, on every
//! way out.

mod ends;
mod limits;
mod order;
mod output;
mod plan;
mod several;
mod supervisor;
mod toy;
