//! Text of a page: a fixed document with two elements in base64, the program and the data.

use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde::Serialize;

/// Document with places for the program and the data. `html/build.mjs` generates it, with the
/// digests of the scripts in its content security policy.
const DOCUMENT: &str = include_str!("page.html");

/// Program of the page, compressed. `html/build.mjs` generates it.
const PROGRAM: &[u8] = include_bytes!("program.js.gz");

/// Returns the text of a page. The data are the length of the description, four bytes little
/// endian, the description as JSON, and the binary data, compressed.
pub(super) fn text(description: &impl Serialize, binary: &[u8]) -> io::Result<String> {
    let json = serde_json::to_vec(description)?;
    let length = u32::try_from(json.len()).map_err(io::Error::other)?;
    let mut data = GzEncoder::new(Vec::new(), Compression::best());
    for part in [&length.to_le_bytes(), &json[..], binary] {
        data.write_all(part)?;
    }
    let data = data.finish()?;
    let mut page = DOCUMENT.replacen("PROGRAM_IN_BASE64", &STANDARD.encode(PROGRAM), 1);
    let place = page.rfind("DATA_IN_BASE64").expect("Bug: page.html has a place for the data");
    page.replace_range(place..place + "DATA_IN_BASE64".len(), &STANDARD.encode(data));
    Ok(page)
}
