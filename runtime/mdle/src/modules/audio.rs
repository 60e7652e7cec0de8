//! Sound at two ears: from the robot's own microphones, a WAV file, or a recorder.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use hound::{SampleFormat, WavReader};
use mdle_host::Microphones;
use mdle_runtime::Nanos;
use mdle_sound::{RATE, WINDOW};

use crate::arguments::EarsOption;

/// Maximum length of a WAV file, in seconds.
const LONGEST: u32 = 1800;

/// Source of sound, which can be opened for several runs.
#[derive(Debug, Clone)]
pub(crate) enum AudioSource {
    Robot,
    Wav(Arc<[[f32; 2]]>),
    Raw(RawAudio),
}

/// Sound of a single run.
pub(super) enum Audio {
    Robot(Microphones),
    /// Samples of a file, and the number of samples that have been taken so far.
    Wav(Arc<[[f32; 2]]>, usize),
    Raw(RawAudio),
}

/// Samples that a recorder has written and that the module has not taken yet.
#[derive(Debug, Clone, Default)]
pub(crate) struct RawAudio(Arc<Mutex<RawSamples>>);

#[derive(Debug, Default)]
struct RawSamples {
    samples: Vec<[f32; 2]>,
    /// Reason why no more samples will arrive; `None` while the recorder runs.
    end: Option<String>,
}

impl AudioSource {
    /// Opens the source of sound that an option names.
    ///
    /// # Errors
    /// Fails with a message if the file cannot be used.
    pub(crate) fn open(option: &EarsOption) -> Result<Self, String> {
        match option {
            EarsOption::Robot => Ok(Self::Robot),
            EarsOption::Wav(path) => wav(path).map(|samples| Self::Wav(samples.into())),
            EarsOption::Raw(path) => RawAudio::open(path.as_deref()).map(Self::Raw),
        }
    }

    /// Returns the sound of a run whose robot has these microphones.
    pub(super) fn begin(&self, microphones: &Microphones) -> Audio {
        match self {
            Self::Robot => Audio::Robot(microphones.clone()),
            Self::Wav(samples) => Audio::Wav(Arc::clone(samples), 0),
            Self::Raw(recorder) => Audio::Raw(recorder.clone()),
        }
    }
}

impl Audio {
    /// Removes and returns the samples up to the time `until`.
    ///
    /// # Errors
    /// Fails with a message if the file or the recorder has ended.
    pub(super) fn take(&mut self, until: Nanos) -> Result<Vec<[f32; 2]>, String> {
        match self {
            Self::Robot(microphones) => Ok(microphones.take(until)),
            Self::Wav(samples, taken) if *taken == samples.len() => Err("the sound of the file has ended".to_owned()),
            Self::Wav(samples, taken) => {
                let end = u128::from(until.0) * u128::from(RATE) / 1_000_000_000;
                let end = usize::try_from(end).unwrap_or(usize::MAX).min(samples.len());
                let heard = samples.get(*taken..end).unwrap_or_default().to_vec();
                *taken = end.max(*taken);
                Ok(heard)
            }
            Self::Raw(recorder) => recorder.take(),
        }
    }
}

/// Reads a WAV file.
fn wav(path: &Path) -> Result<Vec<[f32; 2]>, String> {
    let shown = path.display();
    let refused = |error: hound::Error| format!("--ears {shown}: the file cannot be read: {error}");
    let reader = WavReader::open(path).map_err(refused)?;
    let spec = reader.spec();
    if spec.sample_rate != RATE {
        let rate = spec.sample_rate;
        let help = format!("help: `sox {shown} -r {RATE} out.wav` converts it");
        return Err(format!("--ears {shown}: {rate} samples a second; expected {RATE}\n{help}"));
    }
    if spec.channels != 2 {
        let channels =
            if spec.channels == 1 { "one channel".to_owned() } else { format!("{} channels", spec.channels) };
        let help = "help: a bearing is the delay between two ears, the left one first";
        return Err(format!("--ears {shown}: {channels}; expected two\n{help}"));
    }
    if reader.duration() > LONGEST * RATE {
        return Err(format!(
            "--ears {shown}: {} s are too long; expected at most {LONGEST} s",
            reader.duration() / RATE
        ));
    }
    let values: Result<Vec<f32>, _> = match spec.sample_format {
        SampleFormat::Float => reader.into_samples::<f32>().collect(),
        SampleFormat::Int => reader.into_samples::<i32>().map(|value| value.map(|value| value as f32)).collect(),
    };
    let samples = pairs(&values.map_err(refused)?);
    if samples.is_empty() {
        return Err(format!("--ears {shown}: the file has no samples"));
    }
    for (ear, name) in ["left", "right"].into_iter().enumerate() {
        let is_heard = |sample: &[f32; 2]| sample.get(ear).is_some_and(|value| *value != 0.0);
        if !samples.iter().any(is_heard) {
            return Err(format!("--ears {shown}: the {name} channel is silent: each of its samples is 0"));
        }
    }
    Ok(samples)
}

/// Converts the interleaved samples of two channels to pairs.
fn pairs(values: &[f32]) -> Vec<[f32; 2]> {
    values.as_chunks::<2>().0.to_vec()
}

impl RawAudio {
    /// Begins to read raw samples.
    fn open(path: Option<&Path>) -> Result<Self, String> {
        let recorder = Self::default();
        let (own, path) = (recorder.clone(), path.map(Path::to_owned));
        if let Some(path) = path.as_deref().filter(|path| !path.exists()) {
            let shown = path.display();
            let help =
                "help: give `robot`, a file that ends in .wav, the pipe of a recorder, or `-` for standard input";
            return Err(format!("--ears {shown}: there is no such file\n{help}"));
        }
        // Opening a pipe blocks until another process writes to it, and a read may block forever: neither may delay a
        // turn.
        let read = move || {
            own.ends(match path.map(File::open) {
                None => own.read(io::stdin()),
                Some(Ok(pipe)) => own.read(pipe),
                Some(Err(error)) => format!("the recorder cannot be read: {error}"),
            });
        };
        let thread = thread::Builder::new().name("recorder".to_owned()).spawn(read);
        thread.map(|_| recorder).map_err(|error| format!("--ears: the system gives no thread: {error}"))
    }

    /// Reads 16-bit samples of two ears, in the byte order of `arecord -f cd`, until the stream ends. Returns the
    /// reason for the end.
    fn read(&self, mut from: impl Read) -> String {
        let (mut buffer, mut filled) = ([0; 4096], 0);
        loop {
            let Some(free) = buffer.get_mut(filled..) else { return "its samples are out of step".to_owned() };
            match from.read(free) {
                Ok(0) => return "the recorder has ended".to_owned(),
                Ok(count) => filled += count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return format!("the recorder cannot be read: {error}"),
            }
            let whole = filled - filled % 4;
            let (frames, _) = buffer.get(..whole).unwrap_or_default().as_chunks::<4>();
            let sample =
                |[a, b, c, d]: &[u8; 4]| [[*a, *b], [*c, *d]].map(|bytes| f32::from(i16::from_le_bytes(bytes)));
            self.put(frames.iter().map(sample));
            buffer.copy_within(whole..filled, 0);
            filled -= whole;
        }
    }

    fn put(&self, samples: impl Iterator<Item = [f32; 2]>) {
        let mut recorded = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        recorded.samples.extend(samples);
        // Samples that the module has not taken for a second are dropped.
        let old = recorded.samples.len().saturating_sub(10 * WINDOW);
        recorded.samples.drain(..old);
    }

    fn ends(&self, reason: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).end = Some(reason);
    }

    fn take(&self) -> Result<Vec<[f32; 2]>, String> {
        let mut recorded = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match &recorded.end {
            Some(reason) if recorded.samples.is_empty() => Err(reason.clone()),
            Some(_) | None => Ok(std::mem::take(&mut recorded.samples)),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;
    use std::{env, fs, process};

    use hound::{WavSpec, WavWriter};

    use super::*;

    /// Writes a WAV file called `name`, and returns its path.
    fn written(name: &str, sample_rate: u32, channels: u16, values: &[i16]) -> PathBuf {
        let folder = env::temp_dir().join(format!("mdle_ears_{}", process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join(name);
        let spec = WavSpec { channels, sample_rate, bits_per_sample: 16, sample_format: SampleFormat::Int };
        let mut writer = WavWriter::create(&path, spec).unwrap();
        values.iter().for_each(|value| writer.write_sample(*value).unwrap());
        writer.finalize().unwrap();
        path
    }

    fn refusal(path: &Path) -> String {
        let message = wav(path).unwrap_err();
        message.replace(&path.parent().unwrap().display().to_string(), "FOLDER")
    }

    #[test]
    fn a_file_that_ears_cannot_use_is_refused() {
        let refusals = [
            written("slow.wav", 22_050, 2, &[1, 2]),
            written("one.wav", 44_100, 1, &[1, 2]),
            written("silent.wav", 44_100, 2, &[0; 8]),
            written("left.wav", 44_100, 2, &[7, 0, 7, 0]),
            written("empty.wav", 44_100, 2, &[]),
        ]
        .map(|path| refusal(&path));
        let expected = [
            "--ears FOLDER/slow.wav: 22050 samples a second; expected 44100\n\
             help: `sox FOLDER/slow.wav -r 44100 out.wav` converts it",
            "--ears FOLDER/one.wav: one channel; expected two\n\
             help: a bearing is the delay between two ears, the left one first",
            "--ears FOLDER/silent.wav: the left channel is silent: each of its samples is 0",
            "--ears FOLDER/left.wav: the right channel is silent: each of its samples is 0",
            "--ears FOLDER/empty.wav: the file has no samples",
        ];
        assert_eq!(refusals, expected);
        assert!(refusal(&env::temp_dir().join("no_such_file.wav")).contains("cannot be read"));
    }

    #[test]
    fn a_file_is_heard_as_time_passes_and_ends() {
        let samples: Vec<i16> = (1..=20).collect();
        let path = written("good.wav", 44_100, 2, &samples);
        let mut audio = AudioSource::open(&EarsOption::Wav(path)).unwrap().begin(&Microphones::default());
        assert_eq!(audio.take(Nanos(50_000)), Ok(vec![[1.0, 2.0], [3.0, 4.0]]));
        assert_eq!(audio.take(Nanos(1_000_000_000)).unwrap().len(), 8);
        assert_eq!(audio.take(Nanos(1_100_000_000)), Err("the sound of the file has ended".to_owned()));
    }

    #[test]
    fn a_recorder_is_read_across_pieces_until_it_ends() {
        let recorder = RawAudio::default();
        // One and a half frames, then the rest of the second frame.
        let pieces = [1_u8, 0, 255, 255, 2, 0].as_slice().chain([0, 1].as_slice());
        let end = recorder.read(pieces);
        recorder.ends(end);
        assert_eq!(recorder.take(), Ok(vec![[1.0, -1.0], [2.0, 256.0]]));
        assert_eq!(recorder.take(), Err("the recorder has ended".to_owned()));
    }
}
