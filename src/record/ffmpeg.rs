//! Video encoded by the program `ffmpeg`.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};

use super::RecorderOptions;
use super::encoder::Encoder;
use crate::error::{Error, Result};
use crate::file::Replacement;

/// Encoder that sends raw frames through a pipe to an `ffmpeg` process.
pub(super) struct Ffmpeg {
    file: Replacement,
    process: Process,
    /// Buffer for an image padded to even width and height.
    even: Vec<u8>,
    size: [usize; 2],
    path: PathBuf,
}

impl Ffmpeg {
    /// Checks that the program can be started, so that a missing program is reported before the
    /// simulation runs.
    pub(super) fn check(path: &Path, options: &RecorderOptions) -> Result<()> {
        let mut command = Command::new(&options.ffmpeg);
        command.arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        match command.status() {
            Ok(status) if status.success() => Ok(()),
            Ok(status) => Err(failed(path, &format!("{} -version: {status}", options.ffmpeg.display()))),
            Err(error) => Err(not_started(path, options, &error)),
        }
    }

    pub(super) fn new(path: &Path, file: Replacement, size: [u32; 2], options: &RecorderOptions) -> Result<Self> {
        let [width, height] = size.map(|length| length.next_multiple_of(2));
        let mut command = Command::new(&options.ffmpeg);
        command.args(["-hide_banner", "-nostdin", "-loglevel", "error", "-y"]);
        command.args(["-f", "rawvideo", "-pixel_format", "rgb24", "-video_size", &format!("{width}x{height}")]);
        command.args(["-framerate", &options.frames_per_second.to_string(), "-i", "pipe:0", "-an"]);
        // Without an explicit colour matrix and range, players decode large frames with the wrong
        // colours.
        command.args(["-vf", "scale=out_color_matrix=bt709:out_range=tv", "-pix_fmt", "yuv420p"]);
        command.args([
            "-colorspace",
            "bt709",
            "-color_primaries",
            "bt709",
            "-color_trc",
            "bt709",
            "-color_range",
            "tv",
        ]);
        command.args(&options.ffmpeg_arguments);
        // The temporary file has no extension, so the container is given explicitly. For MP4,
        // `faststart` places the index first, so that browsers can start before the download ends.
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        command.args(match &*extension {
            "mkv" => &["-f", "matroska"][..],
            "mov" => &["-f", "mov", "-movflags", "+faststart"],
            _ => &["-f", "mp4", "-movflags", "+faststart"],
        });
        // Without the prefix, ffmpeg could parse the name as an option or a protocol.
        let mut url = std::ffi::OsString::from("file:");
        url.push(file.temporary_path());
        command.arg(url);
        let process = Process::start(command).map_err(|error| not_started(path, options, &error))?;
        let size = size.map(|length| length as usize);
        Ok(Self { file, process, even: Vec::new(), size, path: path.to_owned() })
    }
}

impl Encoder for Ffmpeg {
    fn write(&mut self, rgb: &[u8], frames: u64) -> Result<()> {
        make_even(rgb, self.size, &mut self.even);
        for _ in 0..frames {
            if let Err(error) = self.process.write(&self.even) {
                // The process has ended. Its error output contains the reason.
                let reason = match self.process.end() {
                    Ok((_, message)) if !message.is_empty() => message,
                    _ => error.to_string(),
                };
                return Err(failed(&self.path, &reason));
            }
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        let (status, message) = self.process.end().map_err(|error| failed(&self.path, &error.to_string()))?;
        if !status.success() {
            return Err(failed(&self.path, &if message.is_empty() { status.to_string() } else { message }));
        }
        self.file.finish().map_err(Error::file(self.path))
    }
}

/// Child process. Dropping it kills a running process and waits for its exit.
struct Process {
    child: Child,
    input: Option<BufWriter<ChildStdin>>,
    /// Error output of the process. A file, because a pipe that is never read would block the
    /// process.
    messages: File,
}

impl Process {
    fn start(mut command: Command) -> io::Result<Self> {
        let messages = tempfile::tempfile()?;
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(messages.try_clone()?);
        // In a separate process group, the child does not receive Ctrl-C from the terminal. This
        // crate terminates it.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn()?;
        let input = child.stdin.take().map(BufWriter::new);
        Ok(Self { child, input, messages })
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.input.as_mut().map_or(Err(io::ErrorKind::BrokenPipe.into()), |input| input.write_all(bytes))
    }

    /// Closes the input of the process and waits for its exit.
    fn end(&mut self) -> io::Result<(ExitStatus, String)> {
        // Errors of the final flush are ignored: the exit status reports them.
        drop(self.input.take());
        let status = self.child.wait()?;
        let mut messages = Vec::new();
        self.messages.rewind()?;
        self.messages.read_to_end(&mut messages)?;
        Ok((status, String::from_utf8_lossy(&messages).trim().to_owned()))
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if self.input.is_some() {
            // The recording was abandoned, so its output is not needed.
            _ = self.child.kill();
            _ = self.end();
        }
    }
}

fn not_started(path: &Path, options: &RecorderOptions, error: &io::Error) -> Error {
    let program = options.ffmpeg.display();
    let reason = if error.kind() == io::ErrorKind::NotFound {
        format!(
            "the program {program} was not found; install it (on Debian: apt-get install ffmpeg), set RecorderOptions::ffmpeg, or \
             record a .gif or .png, which need no other program"
        )
    } else {
        format!("{program} cannot be started: {error}")
    };
    Error::Save { path: path.to_owned(), reason }
}

fn failed(path: &Path, message: &str) -> Error {
    let advice = if message.contains("Unknown encoder") {
        "; choose an available encoder in RecorderOptions::ffmpeg_arguments (`ffmpeg -encoders` lists them)"
    } else {
        ""
    };
    Error::Save { path: path.to_owned(), reason: format!("ffmpeg failed: {message}{advice}") }
}

/// Pads an image to even width and height by repeating its last column and row, as 4:2:0 chroma
/// subsampling requires.
fn make_even(rgb: &[u8], [width, height]: [usize; 2], even: &mut Vec<u8>) {
    even.clear();
    for row in (0..height).chain((height % 2 == 1).then(|| height - 1)) {
        let row = &rgb[3 * width * row..3 * width * (row + 1)];
        even.extend_from_slice(row);
        if width % 2 == 1 {
            even.extend_from_slice(&row[row.len() - 3..]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::make_even;

    #[test]
    fn the_last_row_or_column_of_an_odd_image_is_repeated() {
        let pixels = |indices: &[u8]| indices.iter().flat_map(|&index| [index, index + 1, 0]).collect::<Vec<u8>>();
        for (size, picture, expected) in [
            ([2, 2], &[10, 20, 30, 40][..], &[10, 20, 30, 40][..]),
            ([1, 2], &[10, 20], &[10, 10, 20, 20]),
            ([2, 1], &[10, 20], &[10, 20, 10, 20]),
            ([3, 1], &[10, 20, 30], &[10, 20, 30, 30, 10, 20, 30, 30]),
            ([1, 1], &[10], &[10, 10, 10, 10]),
        ] {
            let mut even = Vec::new();
            make_even(&pixels(picture), size, &mut even);
            assert_eq!(even, pixels(expected), "{size:?}");
        }
    }
}
