//! Tests all writers of a run, with readers that are blocked or closed and files that are full or limited: the robot
//! drives on or stops, and waits for no reader.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use rustix::fs::{CWD, FileType, Mode, OFlags, fcntl_getfl, fcntl_setfl, mknodat};

use crate::cart::{cart, is_no_timing, lines, send, start};

/// Output of the cart that a test obstructs.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Writer {
    Out,
    Err,
    Log,
    Path,
}

const WRITERS: [Writer; 4] = [Writer::Out, Writer::Err, Writer::Log, Writer::Path];

/// A cart that reports its commands through a pipe of its own.
struct Cart {
    folder: PathBuf,
    command: Command,
    journal: File,
    /// Commands that the cart has received so far.
    text: String,
    /// Pipes that are never read.
    full: Vec<File>,
}

/// Creates a named pipe.
fn fifo(path: &Path) {
    mknodat(CWD, path, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0).unwrap();
}

impl Cart {
    /// Returns a cart with these options on a long track.
    fn new(test: &str, options: &[&str]) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        let journal = folder.join("journal");
        fifo(&journal);
        let mut command = cart(&["--period", "0.01", "--track", "1000", "--journal"]);
        command.arg(&journal).args(options).stdout(Stdio::null()).stderr(Stdio::null());
        let flags = OFlags::NONBLOCK.bits() as i32;
        let journal = File::options().read(true).custom_flags(flags).open(&journal).unwrap();
        Self { folder, command, journal, text: String::new(), full: Vec::new() }
    }

    /// Makes a writer of the cart write to this file.
    fn to(&mut self, writer: Writer, file: &Path) {
        let open = || fs::OpenOptions::new().write(true).create(true).truncate(false).open(file).unwrap();
        match writer {
            Writer::Out => self.command.stdout(open()),
            Writer::Err => self.command.stderr(open()),
            Writer::Log => self.command.arg("--log").arg(file),
            Writer::Path => self.command.arg("--record-path").arg(file),
        };
    }

    /// Makes a writer of the cart write to a full pipe that is never read.
    fn blocked(&mut self, writer: Writer) {
        let fifo = self.folder.join(format!("{writer:?}"));
        self::fifo(&fifo);
        // A pipe that is opened for reading and writing does not wait for another end.
        let mut end = File::options().read(true).write(true).open(&fifo).unwrap();
        let flags = fcntl_getfl(&end).unwrap();
        fcntl_setfl(&end, flags | OFlags::NONBLOCK).unwrap();
        while end.write(&[b'.'; 1]).is_ok() {}
        self.full.push(end);
        self.to(writer, &fifo);
    }

    /// Makes a writer of the cart write to a pipe whose reader is closed.
    fn closed(&mut self, writer: Writer) {
        let (reader, end) = io::pipe().unwrap();
        match writer {
            Writer::Out => drop(self.command.stdout(end)),
            Writer::Err => drop(self.command.stderr(end)),
            Writer::Log | Writer::Path => panic!("a file that nobody can read has no name"),
        }
        drop(reader);
    }

    /// Makes a writer of the cart write to a file whose size is limited to zero bytes.
    fn limited(&mut self, writer: Writer) {
        let file = self.folder.join(format!("{writer:?}"));
        self.to(writer, &file);
        let mut shell = Command::new("sh");
        shell
            .args(["-c", "ulimit -f 0; exec \"$@\"", "sh"])
            .arg(self.command.get_program())
            .args(self.command.get_args());
        let open =
            |is_it| if is_it { Stdio::from(File::options().write(true).open(&file).unwrap()) } else { Stdio::null() };
        shell.stdout(open(writer == Writer::Out)).stderr(open(writer == Writer::Err)).stdin(Stdio::null());
        self.command = shell;
    }

    /// Reads the commands that the cart has newly reported, and returns all commands so far.
    fn hear(&mut self) -> &str {
        // Errors are ignored: there are no new data, the cart has not opened the pipe yet, or it has ended.
        let _ = self.journal.read_to_string(&mut self.text);
        &self.text
    }

    /// Starts the cart and waits until it was commanded to move `times` times.
    fn moves(&mut self, times: usize) -> Child {
        let child = self.command.spawn().unwrap();
        self.moves_on(times);
        child
    }

    fn moves_on(&mut self, times: usize) {
        let begun = Instant::now();
        while self.hear().matches("0.5 m/s").count() < times {
            assert!(begun.elapsed() < Duration::from_secs(60), "it does not move: {}", self.text);
            thread::sleep(Duration::from_millis(5));
        }
    }

    /// Waits until the cart ends; returns the exit status, and `true` if the cart was stopped.
    fn end(&mut self, child: &mut Child) -> (Option<i32>, bool) {
        let status = child.wait().unwrap().code();
        (status, self.hear().ends_with("stop\n"))
    }
}

/// Requests the timing of a driving cart, and then stops the cart by a signal; returns the exit status, and `true` if
/// the cart was stopped.
fn stopped(mut cart: Cart) -> (Option<i32>, bool) {
    let mut child = cart.moves(10);
    send(&child, "USR1");
    cart.moves_on(20);
    send(&child, "TERM");
    cart.end(&mut child)
}

/// Each of these tests takes seconds, so they run in parallel.
#[test]
fn readers_that_do_not_read_hold_up_no_robot() {
    thread::scope(|scope| {
        scope.spawn(blocked_writers_hold_up_no_robot);
        scope.spawn(a_log_that_nobody_reads_stops_the_robot);
        scope.spawn(a_panic_needs_no_reader);
    });
}

fn blocked_writers_hold_up_no_robot() {
    let writers = WRITERS.map(|writer| vec![writer]).into_iter().chain([WRITERS.to_vec()]);
    thread::scope(|scope| {
        // An incomplete log or path is a fault.
        for (writers, status) in writers.zip([143, 143, 3, 143, 3]) {
            scope.spawn(move || {
                let mut cart = Cart::new(&format!("blocked_{}", writers.len() * 10 + writers[0] as usize), &[]);
                writers.iter().for_each(|writer| cart.blocked(*writer));
                assert_eq!(stopped(cart), (Some(status), true), "{writers:?}");
            });
        }
    });
}

#[test]
fn a_writer_that_is_closed_full_or_limited_is_no_reason_to_drive_on() {
    thread::scope(|scope| {
        for (writer, status) in WRITERS.into_iter().zip([143, 143, 3, 143]) {
            scope.spawn(move || assert_stops_when_full(writer, status));
            scope.spawn(move || assert_stops_when_limited(writer, status));
        }
        for writer in [Writer::Out, Writer::Err] {
            scope.spawn(move || {
                let mut cart = Cart::new(&format!("closed_{writer:?}"), &[]);
                cart.closed(writer);
                assert_eq!(stopped(cart), (Some(143), true), "closed {writer:?}");
            });
        }
    });
}

fn assert_stops_when_full(writer: Writer, status: i32) {
    let mut cart = Cart::new(&format!("full_{writer:?}"), &[]);
    cart.to(writer, Path::new("/dev/full"));
    // A log that cannot be written stops the cart before the signal does.
    if writer == Writer::Log {
        let mut child = cart.command.spawn().unwrap();
        assert_eq!(cart.end(&mut child), (Some(3), true));
    } else {
        assert_eq!(stopped(cart), (Some(status), true), "full {writer:?}");
    }
}

fn assert_stops_when_limited(writer: Writer, status: i32) {
    let mut cart = Cart::new(&format!("limited_{writer:?}"), &[]);
    cart.limited(writer);
    let mut child = cart.command.spawn().unwrap();
    if writer != Writer::Log {
        cart.moves_on(20);
        send(&child, "TERM");
    }
    assert_eq!(cart.end(&mut child), (Some(status), true), "limited {writer:?}");
}

fn a_log_that_nobody_reads_stops_the_robot() {
    let mut cart = Cart::new("unread_log", &[]);
    cart.blocked(Writer::Log);
    let mut child = cart.command.stderr(Stdio::piped()).spawn().unwrap();
    let lines: Vec<_> = lines(child.stderr.take().unwrap()).collect();
    assert_eq!(lines[0], "error: the run log cannot be written, so the robot was stopped: it was not read for 5 s");
    assert_eq!(cart.end(&mut child), (Some(3), true));
}

/// Returns the lines on standard error and the end of a cart whose log or path loses its reader after some turns. A
/// signal ends the cart, unless `ends_the_run` is `true`, because the lost reader then ends it.
fn deserted(writer: Writer, ends_the_run: bool) -> (String, (Option<i32>, bool)) {
    let mut cart = Cart::new(&format!("deserted_{writer:?}"), &[]);
    let pipe = cart.folder.join(format!("{writer:?}"));
    fifo(&pipe);
    // Opened without waiting for the writer; the writer can open the pipe only if it has a reader.
    let flags = OFlags::NONBLOCK.bits() as i32;
    let reader = File::options().read(true).custom_flags(flags).open(&pipe).unwrap();
    match writer {
        Writer::Log => cart.command.arg("--log").arg(&pipe),
        Writer::Path => cart.command.arg("--record-path").arg(&pipe),
        Writer::Out | Writer::Err => panic!("these are pipes of their own"),
    };
    let mut child = cart.command.stderr(Stdio::piped()).spawn().unwrap();
    let errors = child.stderr.take().unwrap();
    cart.moves_on(10);
    drop(reader);
    if !ends_the_run {
        cart.moves_on(30);
        send(&child, "TERM");
    }
    let end = cart.end(&mut child);
    (lines(errors).take_while(|line| is_no_timing(line)).collect::<Vec<_>>().join("\n"), end)
}

#[test]
fn a_log_whose_reader_goes_away_stops_the_robot() {
    let (errors, end) = deserted(Writer::Log, true);
    assert_eq!(end, (Some(3), true), "{errors}");
    assert_eq!(errors, "error: the run log cannot be written, so the robot was stopped: Broken pipe (os error 32)");
}

#[test]
fn a_path_whose_reader_goes_away_is_reported() {
    let (errors, end) = deserted(Writer::Path, false);
    assert_eq!(end, (Some(143), true), "{errors}");
    assert_eq!(
        errors,
        "stopped by SIGTERM\nerror: the path that was driven cannot be written: Broken pipe (os error 32)"
    );
}

fn a_panic_needs_no_reader() {
    let mut cart = Cart::new("panic", &["--panic-at", "5"]);
    cart.blocked(Writer::Err);
    let mut child = cart.command.spawn().unwrap();
    assert_eq!(cart.end(&mut child), (Some(3), true));
}

#[test]
fn a_reader_that_does_not_read_holds_up_no_robot() {
    // On a track of length zero, each turn makes the maximum number of transitions, whose report is far larger than a
    // pipe's buffer.
    let mut child = start(&["--tell", "--period", "0.1", "--track", "0"]);
    let mut lines = lines(child.stderr.take().unwrap());
    assert_eq!(lines.by_ref().take(10).filter(|line| line == "cart: 0 m/s").count(), 10);
    send(&child, "TERM");
    assert!(lines.by_ref().any(|line| line == "cart: stop"));
    let mut report = String::new();
    child.stdout.take().unwrap().read_to_string(&mut report).unwrap();
    assert!(report.starts_with("0.0 s  go -0.5 (pass 1)  <- far\n"));
    assert_eq!(child.wait().unwrap().code(), Some(143));
}
