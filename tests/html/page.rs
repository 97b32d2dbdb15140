//! An independent reader of the data of a page.

use std::io::Read;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::GzDecoder;
use mujoco_safe::html::{self, HtmlOptions};
use mujoco_safe::{Model, Trajectory};
use serde_json::Value;

/// A page that was read.
pub struct Page {
    pub text: String,
    pub description: Value,
    pub left_out: Vec<String>,
    binary: Vec<u8>,
}

/// A motion with values in units.
pub struct Track {
    pub times: Vec<f64>,
    /// For each frame the channels of its position and quaternion.
    pub poses: Vec<[Vec<f64>; 7]>,
}

/// Saves trajectories and reads the page.
pub fn saved(model: &Model, trajectories: &[(&str, &Trajectory)], options: &HtmlOptions) -> Page {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("page.html");
    let left_out = html::save(&path, model.clone(), trajectories.iter().copied(), options).unwrap();
    Page::read(&path, left_out)
}

impl Page {
    fn read(path: &Path, left_out: Vec<String>) -> Self {
        let text = std::fs::read_to_string(path).unwrap();
        let bytes = unpacked(&text, r#"<script id="data" type="text/plain">"#);
        let (length, rest) = bytes.split_first_chunk().unwrap();
        let (json, binary) = rest.split_at(u32::from_le_bytes(*length) as usize);
        Self { description: serde_json::from_slice(json).unwrap(), binary: binary.to_vec(), text, left_out }
    }

    /// Returns the part of the page without the data.
    pub fn around_data(&self) -> (&str, &str) {
        let (before, rest) = self.text.split_once(r#"<script id="data" type="text/plain">"#).unwrap();
        (before, rest.split_once('<').unwrap().1)
    }

    pub fn part(&self, part: &Value) -> &[u8] {
        let number = |index: usize| part[index].as_u64().unwrap() as usize;
        &self.binary[number(0)..][..number(1)]
    }

    /// Returns the channels of a stream. The prediction uses one or two earlier numbers.
    pub fn channels(&self, part: &Value, count: usize, uses: usize) -> Vec<Vec<i64>> {
        let (mut numbers, mut value, mut shift) = (Vec::new(), 0_u64, 0);
        for byte in self.part(part) {
            value |= u64::from(byte & 0x7f) << shift;
            shift += 7;
            if *byte < 0x80 {
                numbers.push((value >> 1) as i64 ^ -((value & 1) as i64));
                (value, shift) = (0, 0);
            }
        }
        let channel = |differences: &[i64]| {
            let mut values: Vec<i64> = Vec::new();
            for difference in differences {
                let predicted = match values[..] {
                    [.., before, last] if uses == 2 => 2 * last - before,
                    [.., last] => last,
                    [] => 0,
                };
                values.push(predicted + difference);
            }
            values
        };
        numbers.chunks(count).map(channel).collect()
    }

    pub fn track(&self, index: usize) -> Track {
        let (track, steps) = (&self.description["tracks"][index], &self.description["steps"]);
        let count = track["count"].as_u64().unwrap() as usize;
        let scaled = |channel: &[i64], name: &str| -> Vec<f64> {
            channel.iter().map(|&number| number as f64 * steps[name].as_f64().unwrap()).collect()
        };
        let poses = self.channels(&track["poses"], count, 2);
        let pose = |channels: &[Vec<i64>]| {
            std::array::from_fn(|part| scaled(&channels[part], if part < 3 { "position" } else { "rotation" }))
        };
        Track {
            times: scaled(&self.channels(&track["times"], count, 2)[0], "time"),
            poses: poses.chunks(7).map(pose).collect(),
        }
    }

    /// Returns the values of a curve of the first track.
    pub fn curve(&self, index: usize) -> (String, Vec<f64>) {
        let track = &self.description["tracks"][0];
        let curve = &track["curves"][index];
        let [low, step] = ["low", "step"].map(|name| curve["interval"][name].as_f64().unwrap());
        let numbers = &self.channels(&curve["values"], track["count"].as_u64().unwrap() as usize, 2)[0];
        let value = |&number: &i64| if number > 0 { low + step * (number - 1) as f64 } else { f64::NAN };
        (curve["name"].as_str().unwrap().to_owned(), numbers.iter().map(value).collect())
    }
}

/// Returns the bytes of an element of a page, unpacked.
pub fn unpacked(text: &str, start: &str) -> Vec<u8> {
    let encoded = text.split_once(start).unwrap().1.split_once('<').unwrap().0;
    let mut bytes = Vec::new();
    GzDecoder::new(&STANDARD.decode(encoded).unwrap()[..]).read_to_end(&mut bytes).unwrap();
    bytes
}
