//! Moving pictures: numbered PNG files, animated PNG and GIF, and MP4 through `ffmpeg`.

#![forbid(unsafe_code)]
