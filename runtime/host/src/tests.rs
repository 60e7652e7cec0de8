//! Tests whole runs on a toy robot in virtual time, for every kind of end: the robot's inputs, the output, and the exit
//! status.

mod ends;
mod limits;
mod order;
mod output;
mod plan;
mod several;
mod supervisor;
mod toy;
