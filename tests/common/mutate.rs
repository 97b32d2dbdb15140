//! Damaged binary models, reproducible from a valid file, a kind of damage and a seed.
//!
//! The layout of the file is derived from the table of fields in `mujoco-sys` and not from the
//! crate's reader, so that an error in the reader is detected.

#![allow(unreachable_pub, dead_code, reason = "included by several tests, each of which uses some of it")]

/// A kind of damage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damage {
    /// Changes one to four bits or bytes anywhere.
    Anywhere,
    /// Changes one to four bits or bytes outside of the textures, which take most of a typical
    /// file.
    OutsideTextures,
    /// Changes one to three integers of the header and the model's sizes.
    Sizes,
    /// Changes one to four bits or integers of the options, the visual settings and the statistics.
    Options,
    /// Changes one to four elements of integer arrays.
    Integers,
    /// Changes one to four elements of byte arrays other than textures: flags, names, texts.
    Bytes,
    /// Replaces one to four real numbers by special values.
    Reals,
    /// Truncates the file.
    Truncation,
    /// Appends or inserts bytes.
    Extension,
}

pub const DAMAGES: [Damage; 9] = [
    Damage::Anywhere,
    Damage::OutsideTextures,
    Damage::Sizes,
    Damage::Options,
    Damage::Integers,
    Damage::Bytes,
    Damage::Reals,
    Damage::Truncation,
    Damage::Extension,
];

/// The layout of a file.
pub struct Map {
    integers: Vec<(usize, usize)>,
    bytes: Vec<(usize, usize)>,
    reals: Vec<(usize, usize, usize)>,
    textures: (usize, usize),
}

#[cfg(not(engine_since = "3.5.0"))]
mod layout {
    pub const FIELDS: &str = include_str!("../../mujoco-sys/fields/v2_2_2.tsv");
    /// Number of integers before the sizes, number of sizes and bytes of a size.
    pub const HEADER: (usize, usize, usize) = (4, 58, 4);
    /// `mjOption`, `mjVisual`, `mjStatistic`.
    pub const STRUCTS: usize = 240 + 560 + 56;
}

#[cfg(engine_since = "3.5.0")]
mod layout {
    pub const FIELDS: &str = include_str!("../../mujoco-sys/fields/v3_5_0.tsv");
    /// Number of integers before the sizes, number of sizes and bytes of a size.
    pub const HEADER: (usize, usize, usize) = (5, 89, 8);
    /// `mjOption`, `mjVisual`, `mjStatistic`.
    pub const STRUCTS: usize = 992;
}

use layout::{FIELDS, STRUCTS};
/// End of the sizes.
const HEADER: usize = 4 * layout::HEADER.0 + layout::HEADER.1 * layout::HEADER.2;

impl Map {
    /// Returns the layout of a valid file.
    pub fn new(file: &[u8]) -> Self {
        let rows: Vec<Vec<&str>> = FIELDS.lines().skip(1).map(|line| line.split('\t').collect()).collect();
        let names: Vec<&str> = rows.iter().filter(|row| row[..2] == ["Model", "size"]).map(|row| row[3]).collect();
        let (integers, count, width) = layout::HEADER;
        assert_eq!(names.len(), count);
        // The lower half of a wide size, because both are little-endian.
        let size = |name: &str| {
            let index = names.iter().position(|&known| known == name);
            index.map_or_else(
                || if name == "mjNTEXROLE" { 10 } else { name.parse().unwrap() },
                |i| integer(file, 4 * integers + width * i),
            )
        };
        let extent = |text: &str| text.split('*').map(size).product::<usize>();
        let mut map = Self { integers: vec![], bytes: vec![], reals: vec![], textures: (0, 0) };
        let mut at = HEADER + STRUCTS;
        for row in rows.iter().filter(|row| row[..2] == ["Model", "array"]) {
            let count = extent(row[4]) * extent(row[5]);
            let width = match row[2] {
                "mjtNum" | "mjtSize" => 8,
                "mjtByte" | "char" => 1,
                _ => 4,
            };
            if ["tex_rgb", "tex_data"].contains(&row[3]) {
                map.textures = (at, count);
            } else if count > 0 {
                match row[2] {
                    "int" => map.integers.push((at, count)),
                    // The halves of the integers.
                    "mjtSize" => map.integers.push((at, 2 * count)),
                    "mjtByte" | "char" => map.bytes.push((at, count)),
                    _ => map.reals.push((at, count, width)),
                }
            }
            at += count * width;
        }
        assert_eq!(at, file.len(), "the table of fields does not describe the file");
        map
    }

    /// Returns a damaged copy of a file.
    pub fn mutant(&self, file: &[u8], damage: Damage, seed: u64) -> Vec<u8> {
        let mut random =
            Random(seed.wrapping_mul(2).wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ damage as u64);
        let mut file = file.to_vec();
        let times = 1 + random.below(4);
        match damage {
            Damage::Anywhere => (0..times).for_each(|_| flip(&mut file, 0, usize::MAX, &mut random)),
            Damage::OutsideTextures => {
                for _ in 0..times {
                    let (start, length) = self.textures;
                    let at = random.below(file.len() - length);
                    let at = if at < start { at } else { at + length };
                    flip(&mut file, at, 1, &mut random);
                }
            }
            Damage::Sizes => (0..times.min(3)).for_each(|_| {
                let at = 4 * random.below(HEADER / 4);
                disturb(&mut file, at, &mut random);
            }),
            Damage::Options => (0..times).for_each(|_| {
                if random.below(2) == 0 {
                    flip(&mut file, HEADER, STRUCTS, &mut random);
                } else {
                    let at = HEADER + 4 * random.below(STRUCTS / 4);
                    disturb(&mut file, at, &mut random);
                }
            }),
            Damage::Integers => (0..times).for_each(|_| {
                let (start, count) = self.integers[random.below(self.integers.len())];
                let at = start + 4 * random.below(count);
                disturb(&mut file, at, &mut random);
            }),
            Damage::Bytes => (0..times).for_each(|_| {
                let (start, count) = self.bytes[random.below(self.bytes.len())];
                let values = [0, 1, 2, 3, 255, random.below(256) as u8];
                file[start + random.below(count)] = values[random.below(values.len())];
            }),
            Damage::Reals => (0..times).for_each(|_| {
                let (start, count, width) = self.reals[random.below(self.reals.len())];
                let at = start + width * random.below(count);
                let values = [
                    f64::NAN,
                    f64::INFINITY,
                    f64::NEG_INFINITY,
                    0.0,
                    -1.0,
                    1e300,
                    -1e30,
                    1e-300,
                    1e6,
                    0.5,
                    2_147_483_648.0,
                ];
                let value = values[random.below(values.len())];
                if width == 8 {
                    file[at..at + 8].copy_from_slice(&value.to_ne_bytes());
                } else {
                    file[at..at + 4].copy_from_slice(&(value as f32).to_ne_bytes());
                }
            }),
            Damage::Truncation => {
                let removed = if random.below(2) == 0 { 1 + random.below(16) } else { 1 + random.below(file.len()) };
                file.truncate(file.len() - removed.min(file.len()));
            }
            Damage::Extension => {
                let added = vec![random.below(256) as u8; 1 + random.below(64)];
                let at = if random.below(2) == 0 { file.len() } else { random.below(file.len()) };
                file.splice(at..at, added);
            }
        }
        file
    }
}

/// Flips a bit or replaces a byte in the given range.
fn flip(file: &mut [u8], start: usize, length: usize, random: &mut Random) {
    let at = start + random.below(length.min(file.len() - start));
    if random.below(2) == 0 {
        file[at] ^= 1 << random.below(8);
    } else {
        file[at] = random.below(256) as u8;
    }
}

/// Changes an integer by a small or large amount.
fn disturb(file: &mut [u8], at: usize, random: &mut Random) {
    let old = i32::from_ne_bytes(file[at..at + 4].try_into().unwrap());
    let value = match random.below(10) {
        0 => -1,
        1 => 0,
        2 => old.wrapping_add(1),
        3 => old.wrapping_sub(1),
        4 => old.wrapping_mul(2),
        5 => random.below(16) as i32,
        6 => old ^ (1 << random.below(31)),
        7 => [i32::MAX, i32::MIN, 1 << 30, 1 << 16, 1 << 24, -2][random.below(6)],
        8 => random.below(1000) as i32,
        _ => random.next() as i32,
    };
    file[at..at + 4].copy_from_slice(&value.to_ne_bytes());
}

fn integer(file: &[u8], at: usize) -> usize {
    i32::from_ne_bytes(file[at..at + 4].try_into().unwrap()) as usize
}

/// SplitMix64 by Sebastiano Vigna, which gives the same numbers on every platform.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }
}
