//! Compiles the plan to Rust.

fn main() -> Result<(), mdle_embed::EmbedError> {
    mdle_embed::plan("plans/round.mdle").target("sim").write()
}
