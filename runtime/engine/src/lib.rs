//! The Modular Engine (section III of the paper): modules and plans that make a robot's turns together.
#![forbid(unsafe_code)]
