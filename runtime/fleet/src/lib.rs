//! The state link over a Zenoh router, for fleets that outgrow a machine: each robot has one connection to the router
//! instead of one to every other robot.
//!
//! The frames are those of the link over TCP, and the endpoint of the engine checks them: what a router passes on is
//! trusted as little as what a socket brings.
#![forbid(unsafe_code)]

mod carrier;
mod router_link;
mod subscriptions;
mod topics;

pub use router_link::open;
