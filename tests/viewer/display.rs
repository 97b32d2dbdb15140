//! Virtual X server, and the pixels of its screen.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use tempfile::TempDir;

/// Virtual X server.
pub struct Display {
    server: Child,
    name: String,
    folder: TempDir,
}

impl Display {
    /// Starts a server on the first free display number. Keys do not repeat, because on a loaded
    /// machine a key can be released late. The screen has no cursor, which would be part of
    /// pictures.
    pub fn start() -> Self {
        let folder = tempfile::tempdir().expect("the temporary folder is writable");
        let mut server = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-screen",
                "0",
                "1920x1200x24",
                "-nolisten",
                "tcp",
                "-noreset",
                "-nocursor",
                "-r",
                "-fbdir",
            ])
            .arg(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap_or_else(|error| {
                panic!("Xvfb did not start: {error}. `scripts/setup --tests` installs the programs for these tests")
            });
        let mut number = String::new();
        BufReader::new(server.stdout.take().expect("the output is piped"))
            .read_line(&mut number)
            .expect("Xvfb prints its number");
        Self { server, name: format!(":{}", number.trim()), folder }
    }

    /// Returns the value of `DISPLAY`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the number of the server's process.
    pub fn process(&self) -> u32 {
        self.server.id()
    }

    /// Returns the path of the framebuffer.
    pub fn framebuffer(&self) -> PathBuf {
        self.folder.path().join("Xvfb_screen0")
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Pixels of the screen, as an X window dump.
pub struct Screen {
    dump: Vec<u8>,
    start: usize,
    bytes_per_line: usize,
}

impl Screen {
    /// Reads the framebuffer. The header of the dump consists of big-endian 32-bit integers.
    pub fn read(framebuffer: &Path) -> Self {
        let dump = std::fs::read(framebuffer).expect("the framebuffer is readable");
        let number = |index: usize| {
            let at = 4 * index;
            u32::from_be_bytes(dump[at..at + 4].try_into().expect("four bytes")) as usize
        };
        let (header, bytes_per_line, colours) = (number(0), number(12), number(19));
        Self { start: header + 12 * colours, bytes_per_line, dump }
    }

    pub fn pixel(&self, [x, y]: [usize; 2]) -> [u8; 3] {
        let at = self.start + y * self.bytes_per_line + 4 * x;
        [self.dump[at + 2], self.dump[at + 1], self.dump[at]]
    }

    /// Saves the upper left part as a PNG file with a palette of 256 colours.
    pub fn save(&self, path: &Path, [width, height]: [u32; 2]) {
        let pixels = (0..height as usize).flat_map(|y| (0..width as usize).map(move |x| [x, y]));
        let part: Vec<u8> = pixels.flat_map(|at| self.pixel(at)).collect();
        // Speed 1 gives the best palette.
        let image = gif::Frame::from_rgb_speed(width as u16, height as u16, &part, 1);
        let file = std::io::BufWriter::new(std::fs::File::create(path).expect("the file is writable"));
        let mut encoder = png::Encoder::new(file, width, height);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_palette(image.palette.expect("a palette"));
        encoder.set_compression(png::Compression::High);
        let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&image.buffer));
        written.expect("the image is written");
    }
}
