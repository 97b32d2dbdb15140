//! File formats of recordings, and file names of numbered sequences.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// File format of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Numbered PNG files.
    Sequence,
    /// Animated PNG: one lossless file that browsers play. Other programs show its first image.
    AnimatedPng,
    /// Animated GIF: 256 colours, supported everywhere.
    Gif,
    /// H.264 video in MP4, QuickTime or Matroska, encoded by the program `ffmpeg`.
    Video,
}

impl Format {
    /// Returns the format for a path, by the table in
    /// [`Recorder::create`](super::Recorder::create).
    ///
    /// # Errors
    ///
    /// [`Error::Save`] for an unknown extension.
    ///
    /// ```
    /// use mujoco_safe::record::Format;
    ///
    /// assert_eq!(Format::of("walk.gif")?, Format::Gif);
    /// assert_eq!(Format::of("pictures/walk_%04d.png")?, Format::Sequence);
    /// assert!(Format::of("walk.bmp").unwrap_err().to_string().contains(".mp4"));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn of(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        if is_folder(path) {
            return Ok(Self::Sequence);
        }
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match &*extension {
            "png" if NumberedName::of(path).is_some() => Ok(Self::Sequence),
            "png" | "apng" => Ok(Self::AnimatedPng),
            "gif" => Ok(Self::Gif),
            "mp4" | "mov" | "mkv" => Ok(Self::Video),
            _ => Err(Error::Save {
                path: path.to_owned(),
                reason: format!(
                    "the extension .{extension} is not supported; use .gif, .png, .apng, .mp4, .mov, .mkv, a numbered name such as \
                     frame_%05d.png, or a folder"
                ),
            }),
        }
    }
}

/// Returns `true` if the path denotes a folder for a sequence. The folder need not exist.
pub(super) fn is_folder(path: &Path) -> bool {
    path.is_dir() || path.extension().is_none()
}

/// Path whose file name contains a placeholder for a number, such as `frame_%05d.png`.
#[derive(Debug)]
pub(super) struct NumberedName {
    folder: PathBuf,
    before: String,
    digits: usize,
    after: String,
}

impl NumberedName {
    const MAX_DIGITS: usize = 20;

    /// Parses a path; `None` if its file name has no placeholder.
    pub(super) fn of(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?;
        let (start, digits, end) = name.match_indices('%').find_map(|(start, _)| {
            let rest = &name[start + 1..];
            let length = rest.find('d')?;
            let digits = match &rest[..length] {
                "" => 1,
                zero_padded => {
                    zero_padded.strip_prefix('0')?.parse().ok().filter(|&digits| digits <= Self::MAX_DIGITS)?
                }
            };
            Some((start, digits, start + 1 + length + 1))
        })?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Some(Self { folder, before: name[..start].to_owned(), digits, after: name[end..].to_owned() })
    }

    /// Returns the default name `frame_%05d.png` in a folder.
    pub(super) fn in_folder(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), before: "frame_".to_owned(), digits: 5, after: ".png".to_owned() }
    }

    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    pub(super) fn path(&self, number: u64) -> PathBuf {
        self.folder.join(format!("{}{number:0digits$}{}", self.before, self.after, digits = self.digits))
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{Format, NumberedName};

    #[test]
    fn a_number_is_padded_to_the_given_digits() {
        let path = |pattern: &str, number| NumberedName::of(Path::new(pattern)).map(|name| name.path(number));
        assert_eq!(path("out/frame_%05d.png", 12).unwrap(), Path::new("out/frame_00012.png"));
        assert_eq!(path("%d.png", 0).unwrap(), Path::new("0.png"));
        assert_eq!(path("a%02d.png", 123).unwrap(), Path::new("a123.png"));
        assert_eq!(path("50%_%03d.png", 7).unwrap(), Path::new("50%_007.png"));
        for none in ["frame.png", "50%.png", "%5d.png", "%x.png", "%099d.png", "%02d/frame.png"] {
            assert!(path(none, 0).is_none(), "{none}");
        }
    }

    #[test]
    fn the_extension_selects_the_format_in_any_case() {
        for (path, format) in [
            ("a.GIF", Format::Gif),
            ("a.png", Format::AnimatedPng),
            ("a.apng", Format::AnimatedPng),
            ("50%.png", Format::AnimatedPng),
            ("a.MP4", Format::Video),
            ("a.mov", Format::Video),
            ("a.mkv", Format::Video),
            ("a_%d.png", Format::Sequence),
            ("frames", Format::Sequence),
            ("frames/", Format::Sequence),
            ("/", Format::Sequence),
        ] {
            assert_eq!(Format::of(path).unwrap(), format, "{path}");
        }
        for path in ["a.jpeg", "a_%d.jpeg", "a.webm"] {
            Format::of(path).unwrap_err();
        }
    }
}
