//! Rejects, at compile time, a setting with which a panic would end the program before the robot is stopped.

#[cfg(panic = "abort")]
compile_error!(
    "a plan's executable must unwind: with `panic = \"abort\"` a panic would end it before the robot was stopped; set \
     `panic = \"unwind\"` in the profile, in Cargo.toml or in cargo's configuration (config.toml)"
);
