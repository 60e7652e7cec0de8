//! Tests that cargo's configuration does not change an executable: neither a file above the cache or the target, nor a
//! profile in cargo's home. Uses the real binary and the real cargo.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Mutex, PoisonError};

use mdle_tests::executable::{command, folder, target};
use toml::Table;

/// Locked by a test while it builds, because all tests here share the cache and cargo's home.
static BUILDING: Mutex<()> = Mutex::new(());

/// Settings in cargo's home that would change executables, or move compiled files out of the cache.
const HOSTILE: &str = r#"
[build]
build-dir = "moved/build"
target-dir = "moved/target"
incremental = true
rustflags = ["--cfg", "configured"]

[term]
color = "always"

[profile.release]
panic = "abort"
overflow-checks = true
debug-assertions = true
opt-level = 1
strip = "none"

[profile.release.package."*"]
overflow-checks = true
debug-assertions = true
"#;

/// Returns a folder above the cache, in which other users could have put a configuration. The libraries compiled there
/// are kept between test runs.
fn above() -> PathBuf {
    let above = target().join("tmp/cargo_configuration");
    fs::create_dir_all(&above).unwrap();
    above.canonicalize().unwrap()
}

/// Writes a configuration in `folder` whose compiler wrapper creates the file `strange` there, and a toolchain file
/// with a toolchain that does not exist.
fn put_strangers(folder: &Path) {
    fs::create_dir_all(folder.join(".cargo")).unwrap();
    let wrapper = folder.join(".cargo/wrapper");
    let strange = folder.join("strange");
    let _ = fs::remove_file(&strange);
    fs::write(&wrapper, format!("#!/bin/sh\n: > '{}'\nexec \"$@\"\n", strange.display())).unwrap();
    fs::set_permissions(&wrapper, fs::Permissions::from_mode(0o755)).unwrap();
    let text = format!("[build]\nrustc-wrapper = '{}'\n", wrapper.display());
    fs::write(folder.join(".cargo/config.toml"), text).unwrap();
    fs::write(folder.join("rust-toolchain.toml"), "[toolchain]\nchannel = \"1.2.3-strange\"\n").unwrap();
}

/// Returns a home of cargo with the configuration of this machine, extended by [`HOSTILE`], and with the same
/// libraries.
fn cargo_home() -> PathBuf {
    let ours = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let ours = ours.unwrap_or_else(|| std::env::home_dir().unwrap().join(".cargo"));
    let home = above().join("home");
    fs::create_dir_all(&home).unwrap();
    let _ = fs::remove_dir_all(above().join("moved"));
    let _ = fs::remove_file(home.join("registry"));
    symlink(ours.join("registry"), home.join("registry")).unwrap();
    let mut text: Table = fs::read_to_string(ours.join("config.toml")).unwrap_or_default().parse().unwrap();
    text.extend(HOSTILE.parse::<Table>().unwrap());
    fs::write(home.join("config.toml"), text.to_string()).unwrap();
    home
}

/// Runs `mdlec` in `folder`, with foreign configurations above its cache and in `folder`.
fn mdlec_among_strangers(folder: &Path, arguments: &[&str]) -> Output {
    put_strangers(&above());
    put_strangers(folder);
    let mut command = command(folder, arguments);
    // The cargo that runs this test sets the toolchain in the environment, which would take precedence over the foreign
    // one.
    command.env("MDLEC_CACHE", above().join("cache")).env("CARGO_HOME", cargo_home()).env_remove("RUSTUP_TOOLCHAIN");
    command.output().unwrap()
}

fn assert_done(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Writes a robot in `rover`, whose driver executes `body` in each turn and creates the file `stopped` when it is
/// stopped.
fn with_rover(test: &str, body: &str) -> PathBuf {
    let folder = folder(test);
    assert_done(&command(&folder, &["new-target", "rover"]).output().unwrap());
    let hardware = folder.join("rover/src/hardware.rs");
    let text = fs::read_to_string(&hardware).unwrap();
    let put = |text: String, after: &str, line: &str| {
        assert!(text.contains(after), "{after}");
        text.replacen(after, &format!("{after}\n        {line}"), 1)
    };
    let text = put(text, "fn exchange(&mut self, input: &Input) -> Result<Output, Fault> {", body);
    let text = put(text, "fn stop(&mut self) -> Result<(), Fault> {", "let _ = std::fs::write(\"stopped\", \"\");");
    fs::write(&hardware, text).unwrap();
    fs::write(folder.join("plan.mdle"), "{ Drive (Atom (wait 1s) (go 20 0)) }\n").unwrap();
    folder
}

/// Code of the driver. It panics at once if overflow is checked or another hostile setting has an effect, and later in
/// any case.
const DRIVER: &str = "assert_eq!(std::hint::black_box(255_u8) + std::hint::black_box(1), 0);\n        \
                      assert!(!cfg!(configured) && !cfg!(debug_assertions), \"configured\");\n        \
                      if self.pose.x.0 > 0.05 { panic!(\"the driver of the test\") }";

#[test]
fn a_panic_stops_the_robot_whatever_the_profile() {
    let _alone = BUILDING.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = with_rover("profile", DRIVER);
    assert_done(&mdlec_among_strangers(&folder, &["plan.mdle", "--target", "rover"]));
    let run = Command::new(folder.join("plan")).args(["--speed", "max"]).current_dir(&folder).output().unwrap();
    let message = String::from_utf8(run.stderr).unwrap();
    assert!(message.contains("the driver of the test") && !message.contains("overflow"), "{message}");
    assert_eq!(run.status.code(), Some(3), "{message}");
    assert!(folder.join("stopped").exists(), "{message}");
    assert!(!above().join("moved").exists(), "what is compiled stays in the cache");
}

#[test]
fn configuration_above_the_cache_and_the_target_has_no_effect() {
    let _alone = BUILDING.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = with_rover("strangers", "");
    let build = || {
        let output = mdlec_among_strangers(&folder, &["plan.mdle", "--target", "rover"]);
        assert_done(&output);
        String::from_utf8(output.stderr).unwrap()
    };
    // The file is named only once, when it would first have had an effect.
    let note = format!(
        "{}/.cargo/config.toml has no effect: builds read the configuration in cargo's home only\n",
        folder.display()
    );
    assert_eq!([build(), build()].map(|errors| errors.matches(&note).count()), [1, 0]);
    for strange in [above().join("strange"), folder.join("strange")] {
        assert!(!strange.exists(), "{}", strange.display());
    }
    assert!(folder.join("plan").exists());
}
