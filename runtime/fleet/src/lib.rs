//! The state link over a Zenoh router, for fleets that are too large for one machine: each robot has one connection to
//! the router instead of a connection to every other robot.
//!
//! The frames have the format of the link over TCP. The engine's endpoint checks them, because data from a router
//! cannot be trusted any more than data from a socket.
#![forbid(unsafe_code)]

mod carrier;
mod router_link;
mod subscriptions;
mod topics;

pub use router_link::open;
