//! Hash tables of names, one for each kind of element, and the paths of files.

use std::ffi::c_char;

use super::super::invalid::Invalid;
use super::super::layout::{Field, field, size};
use super::super::rule::{is, size_is};
use super::super::view::View;

/// Number of slots for each element.
const SLOTS: usize = 2;

/// Checks the hash tables and paths, after the names. The kinds are in the order of the addresses
/// of names.
pub(in super::super) fn check(view: &View<'_>, addresses: &[Field<i32>]) -> Result<(), Invalid> {
    let names = view.slice(field::names);
    let elements: usize = addresses.iter().map(|&address| view.len(address)).sum();
    size_is(view, size::nnames_map, (SLOTS * elements) as u64, "two for each element with a name")?;
    let mut start = 0;
    for &address in addresses {
        let count = SLOTS * view.len(address);
        let table = table(view.values(address).map(|at| name(names, at as usize)), count);
        for (at, element) in table.into_iter().enumerate() {
            is(view, field::names_map, start + at, element, "the element whose name has this place in the hash table")?;
        }
        start += count;
    }
    paths(view)
}

/// Returns the hash table of a list of names, with -1 in empty slots. A name takes the first empty
/// slot from its hash on.
pub(super) fn table<'a>(names: impl Iterator<Item = &'a [u8]>, slots: usize) -> Vec<i64> {
    let mut table = vec![-1; slots];
    // A slot that is empty or leads to an empty one. Without these links, many names of one hash
    // would take quadratic time.
    let mut next: Vec<usize> = (0..slots).collect();
    for (id, name) in names.enumerate() {
        if name.is_empty() {
            continue;
        }
        let mut path = Vec::new();
        let mut slot = (hash(name) % slots as u64) as usize;
        while table[slot] != -1 {
            path.push(slot);
            slot = if next[slot] == slot { (slot + 1) % slots } else { next[slot] };
        }
        table[slot] = id as i64;
        for passed in path {
            next[passed] = (slot + 1) % slots;
        }
    }
    table
}

/// Returns the bytes of a name without the final NUL.
fn name(names: &[u8], start: usize) -> &[u8] {
    let name = &names[start..];
    &name[..name.iter().position(|&byte| byte == 0).unwrap_or(name.len())]
}

/// Computes the hash by Bernstein, as the engine does with the characters of C.
fn hash(name: &[u8]) -> u64 {
    name.iter().fold(5381, |hash: u64, &byte| hash.wrapping_mul(33) ^ i64::from(byte as c_char) as u64)
}

/// Checks the paths of files, each NUL-terminated. An element without a file has the address -1.
fn paths(view: &View<'_>) -> Result<(), Invalid> {
    let paths = view.slice(field::paths);
    let mut next = 0;
    for address in [field::hfield_pathadr, field::mesh_pathadr, field::skin_pathadr, field::tex_pathadr] {
        for i in 0..view.len(address) {
            if view.get(address, i) == -1 {
                continue;
            }
            is(view, address, i, next as i64, "the end of the previous path, or -1 for none")?;
            let Some(length) = paths[next..].iter().position(|&byte| byte == 0) else {
                return Err(Invalid::scalar("npaths", paths.len(), "the paths do not end with a NUL"));
            };
            next += length + 1;
        }
    }
    // Without any path there is one byte.
    let unused = next == 0 && paths == [0];
    if next == paths.len() || unused {
        Ok(())
    } else {
        size_is(view, size::npaths, next as u64, "the sum of the paths")
    }
}
