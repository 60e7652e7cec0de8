//! Reads the output of cargo while it builds, line by line.

use std::io::{self, BufRead, BufReader, Read};
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, ExitStatus};
use std::sync::mpsc;
use std::thread;

use serde::Deserialize;
use signal_hook::consts::SIGXFSZ;

use super::BuildStep;
use super::seal::Seal;

/// Messages of the system, reported by rustc or the linker, when a disk is full or a file is too large.
const FULL: [&str; 5] =
    ["No space left on device", "Disk quota exceeded", "File too large", "(signal: 25", "File size limit exceeded"];

/// Beginning of rustc's message when there is no linker.
pub(super) const NO_LINKER: &str = "error: linker `";

/// Beginning of cargo's line about a lock that another cargo holds.
const BLOCKED: &[u8] = b"Blocking waiting for file lock";

/// Result of a run of cargo.
#[derive(Debug)]
pub(super) struct CargoResult {
    /// Exit status of cargo.
    pub(super) status: ExitStatus,
    /// `true` if cargo was allowed to use the network.
    pub(super) online: bool,
    /// `true` if cargo has compiled a package or found one already compiled, or if rustc has reported a message.
    pub(super) began: bool,
    /// `true` if cargo used at least one crate that an earlier run had compiled.
    pub(super) reused: bool,
    /// Executable of the plan; `None` if cargo reported none.
    pub(super) executable: Option<CachedExecutable>,
    /// Messages of rustc, including warnings, in order.
    pub(super) complaints: Vec<Complaint>,
    /// Standard error of cargo.
    pub(super) stderr: String,
}

/// An executable in the cache.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct CachedExecutable {
    pub(super) path: PathBuf,
    /// `true` if the executable existed before the run.
    pub(super) fresh: bool,
}

/// A message of rustc about a package.
#[derive(Debug)]
pub(super) struct Complaint {
    /// Path of the package's manifest.
    pub(super) manifest: PathBuf,
    /// `true` if the message stops the build.
    pub(super) is_error: bool,
    /// Text of the message, as on a terminal without colours.
    pub(super) text: String,
}

impl CargoResult {
    /// Returns `true` if the run ended because cargo was not allowed to fetch something. In this case cargo's message
    /// names the option `--offline`.
    pub(super) fn lacks_libraries(&self) -> bool {
        !self.status.success() && !self.began && self.stderr.contains("--offline")
    }

    /// Returns `true` if the run ended because the disk was full or a file was too large.
    pub(super) fn lacks_room(&self) -> bool {
        let text = self.text();
        self.status.signal() == Some(SIGXFSZ) || FULL.iter().any(|sign| text.contains(sign))
    }

    /// Returns `true` if cargo itself panicked. Panics of rustc are ignored. Panics in build scripts are ignored as
    /// well: they do not begin a line, because cargo indents the output of build scripts.
    pub(super) fn is_cargo_broken(&self) -> bool {
        let is_panic = |line: &str| line.starts_with("thread '") && line.contains("panicked at");
        !self.status.success() && self.stderr.lines().any(|line| is_panic(line) && !line.starts_with("thread 'rustc'"))
    }

    /// Returns the complete output of cargo and rustc.
    pub(super) fn text(&self) -> String {
        let mut text: String = self.complaints.iter().map(|complaint| complaint.text.as_str()).collect();
        text.push_str(&self.stderr);
        text
    }
}

/// A line from cargo.
enum CargoLine {
    /// Message of cargo on standard output.
    Message(Vec<u8>),
    /// Note on standard error that another cargo holds a lock.
    Blocked,
}

/// Follows a run of cargo to its end. `online` is `true` if cargo may use the network, and `plan` is the plan's
/// manifest. Each compiled file is recorded in `seal` immediately, so that it can be used again even if the build is
/// stopped.
pub(super) fn follow(
    mut child: Child,
    online: bool,
    plan: &Path,
    seal: &mut Seal,
    progress: &mut dyn FnMut(BuildStep),
) -> io::Result<CargoResult> {
    let (stdout, stderr) = (child.stdout.take(), child.stderr.take());
    let (sender, heard) = mpsc::channel();
    // Both pipes must be read at the same time, because cargo blocks while a pipe is full.
    let stderr = {
        let sender = sender.clone();
        thread::spawn(move || {
            let mut text = Vec::new();
            each_line(stderr, |line| {
                text.extend_from_slice(line);
                text.push(b'\n');
                !line.trim_ascii_start().starts_with(BLOCKED) || sender.send(CargoLine::Blocked).is_ok()
            });
            String::from_utf8_lossy(&text).into_owned()
        })
    };
    thread::spawn(move || each_line(stdout, |line| sender.send(CargoLine::Message(line.to_owned())).is_ok()));
    let mut log =
        CargoOutput { plan, seal, executable: None, complaints: Vec::new(), artifacts: 0, reused: false, compiled: 0 };
    for heard in heard {
        match heard {
            CargoLine::Blocked => progress(BuildStep::Blocked),
            // Lines that are not messages, such as those of a compiler wrapper, are ignored.
            CargoLine::Message(line) => {
                if let Ok(line) = serde_json::from_slice(&line) {
                    log.take(line, progress);
                }
            }
        }
    }
    let status = child.wait()?;
    let stderr = stderr.join().unwrap_or_default();
    let began = log.artifacts > 0 || !log.complaints.is_empty();
    let CargoOutput { reused, executable, complaints, .. } = log;
    Ok(CargoResult { status, online, began, reused, executable, complaints, stderr })
}

/// Passes each line to `take`, until there are no more lines, until reading fails, or until `take` returns `false`.
fn each_line(lines: Option<impl Read>, mut take: impl FnMut(&[u8]) -> bool) {
    for line in lines.map(BufReader::new).into_iter().flat_map(|lines| lines.split(b'\n')) {
        // After a read error, the lines read so far are sufficient for an error message.
        let Ok(line) = line else { break };
        if !take(&line) {
            break;
        }
    }
}

/// The output of cargo that has been read so far.
struct CargoOutput<'a> {
    plan: &'a Path,
    seal: &'a mut Seal,
    executable: Option<CachedExecutable>,
    complaints: Vec<Complaint>,
    artifacts: usize,
    reused: bool,
    compiled: usize,
}

impl CargoOutput<'_> {
    fn take(&mut self, line: CargoMessage, progress: &mut dyn FnMut(BuildStep)) {
        match line {
            CargoMessage::Artifact { manifest_path, target, filenames, executable, fresh } => {
                self.artifacts += 1;
                self.reused |= fresh;
                if manifest_path == self.plan {
                    self.executable = executable.map(|path| CachedExecutable { path, fresh });
                    return;
                }
                let is_script = target.kind.iter().any(|kind| kind == "custom-build");
                match filenames.first() {
                    Some(script) if is_script => self.seal.add_script(script, fresh),
                    Some(_) | None => self.seal.add(&filenames, fresh),
                }
                if !fresh && !is_script {
                    self.compiled += 1;
                    progress(BuildStep::Compiling(self.compiled));
                }
            }
            CargoMessage::Message { manifest_path, message } => self.complaints.push(Complaint {
                manifest: manifest_path,
                is_error: message.level.starts_with("error"),
                text: message.rendered.unwrap_or_default(),
            }),
            CargoMessage::Script { out_dir } => self.seal.add_script(&out_dir, false),
            CargoMessage::Other => {}
        }
    }
}

/// A JSON message of cargo.
#[derive(Debug, Deserialize)]
#[serde(tag = "reason")]
enum CargoMessage {
    #[serde(rename = "compiler-artifact")]
    Artifact {
        manifest_path: PathBuf,
        target: CompiledCrate,
        filenames: Vec<PathBuf>,
        executable: Option<PathBuf>,
        fresh: bool,
    },
    #[serde(rename = "build-script-executed")]
    Script { out_dir: PathBuf },
    #[serde(rename = "compiler-message")]
    Message { manifest_path: PathBuf, message: RustcMessage },
    #[serde(other)]
    Other,
}

/// A compiled crate.
#[derive(Debug, Deserialize)]
struct CompiledCrate {
    kind: Vec<String>,
}

/// A message of rustc.
#[derive(Debug, Deserialize)]
struct RustcMessage {
    level: String,
    rendered: Option<String>,
}
