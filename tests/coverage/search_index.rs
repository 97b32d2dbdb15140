//! Reader of the search index that rustdoc writes (checked with 1.95).
//!
//! The file `root.js` describes the index as columns of strings; the hashes in its field `H` are
//! the names of the column's files. The column `name` has an entry for each item, and one for each
//! alias.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Returns the names that the search finds, each with the number of items that it finds.
pub fn names(documentation: &Path) -> BTreeMap<String, usize> {
    let index = documentation.join("search.index");
    let read = |name: &str| {
        let path = index.join(name);
        fs::read_to_string(&path).unwrap_or_else(|error| {
            panic!("{}: {error}; run cargo doc first, or adapt this file to rustdoc's new format", path.display())
        })
    };
    let root = read("root.js");
    let between = |start: &str, text: &str| {
        text.split_once(start).and_then(|(_, rest)| rest.split_once('"')).map(|(value, _)| value.to_owned())
    };
    let column = root.split_once("\"name\":{").expect("the index has a column of names").1;
    let hashes = between("\"H\":\"", column).expect("the column has hashes");
    let mut names = BTreeMap::new();
    for hash in base64(&hashes).chunks(6) {
        let hash = hash.iter().fold(0_u64, |hash, &byte| hash << 8 | u64::from(byte));
        let text = read(&format!("name/{hash:012x}.js"));
        let literal = text.split_once("(\"").and_then(|(_, rest)| rest.rsplit_once("\")")).expect("a string literal").0;
        for name in entries(&unescaped(literal)) {
            *names.entry(String::from_utf8_lossy(&name).into_owned()).or_insert(0) += 1;
        }
    }
    assert!(names.len() > 1000, "only {} names: rustdoc's format has changed", names.len());
    names
}

/// Returns the entries of a column. A digit or one of `:;<=>?` repeats one of the last 16 different
/// entries. Other entries begin with their length in hexadecimal: the low four bits of each byte,
/// of which only the last is a lower-case letter or above.
fn entries(mut column: &[u8]) -> Vec<Vec<u8>> {
    let mut entries: Vec<Vec<u8>> = Vec::new();
    let mut recent: Vec<Vec<u8>> = Vec::new();
    while let [first, rest @ ..] = column {
        if (b'0'..=b'?').contains(first) {
            entries.push(recent[usize::from(first - b'0')].clone());
            column = rest;
            continue;
        }
        let digits = 1 + column.iter().position(|&byte| byte >= b'`').expect("the length ends");
        let length = column[..digits].iter().fold(0, |length, byte| length << 4 | usize::from(byte & 15));
        let (entry, rest) = column[digits..].split_at(length);
        entries.push(entry.to_vec());
        recent.insert(0, entry.to_vec());
        recent.truncate(16);
        column = rest;
    }
    entries
}

/// Returns the bytes of a JavaScript string literal.
fn unescaped(literal: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut letters = literal.chars();
    while let Some(letter) = letters.next() {
        let letter = match letter {
            '\\' => match letters.next().expect("an escape has a letter") {
                'x' => {
                    let code: String = letters.by_ref().take(2).collect();
                    char::from(u8::from_str_radix(&code, 16).expect("a hexadecimal escape"))
                }
                'n' => '\n',
                'r' => '\r',
                't' => '\t',
                '0' => '\0',
                other => other,
            },
            other => other,
        };
        bytes.push(u8::try_from(u32::from(letter)).expect("the literal has one character per byte"));
    }
    bytes
}

fn base64(text: &str) -> Vec<u8> {
    let digit = |letter: u8| match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        other => panic!("not base64: {other}"),
    };
    let digits: Vec<u32> = text.trim_end_matches('=').bytes().map(|letter| u32::from(digit(letter))).collect();
    let groups = digits.chunks(4).flat_map(|group| {
        let bits = group.iter().fold(0, |bits, digit| bits << 6 | digit) << (6 * (4 - group.len()));
        bits.to_be_bytes()[1..group.len()].to_vec()
    });
    groups.collect()
}
