//! A robot that speaks ROS 2: its messages, as bytes and as values.
#![forbid(unsafe_code)]

pub mod cdr;
pub mod messages;
pub mod names;
