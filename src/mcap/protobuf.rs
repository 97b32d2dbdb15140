//! Encoding and decoding of protobuf messages.
//!
//! Most messages of a log have a constant layout: the names in them, and the numbers of values, do
//! not change. [`Message`] encodes such a message once and remembers the places of the numbers and
//! timestamps, so that a step only overwrites them.

use std::ops::Range;

/// Wire types of the format.
const VARINT: u64 = 0;
const FIXED64: u64 = 1;
const BYTES: u64 = 2;
const FIXED32: u64 = 5;

/// Bytes of each of the two numbers of a timestamp. A varint may have more bytes than it needs, so
/// a timestamp can be overwritten by any other.
const STAMP: usize = 5;

/// Encoded message, and the places in it that change.
#[derive(Default)]
pub(crate) struct Message {
    bytes: Vec<u8>,
    /// Places of numbers: a number, or the values of a packed array.
    slots: Vec<Range<usize>>,
    /// Places of timestamps.
    stamps: Vec<usize>,
}

impl Message {
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Removes all fields, and keeps the memory.
    pub(super) fn clear(&mut self) {
        self.bytes.clear();
        self.slots.clear();
        self.stamps.clear();
    }

    fn put_varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.bytes.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.bytes.push(value as u8);
    }

    fn put_key(&mut self, field: u32, wire: u64) {
        self.put_varint(u64::from(field) << 3 | wire);
    }

    pub(crate) fn put_number(&mut self, field: u32, value: u64) {
        self.put_key(field, VARINT);
        self.put_varint(value);
    }

    pub(crate) fn put_bytes(&mut self, field: u32, bytes: &[u8]) {
        self.put_key(field, BYTES);
        self.put_varint(bytes.len() as u64);
        self.bytes.extend_from_slice(bytes);
    }

    pub(crate) fn put_text(&mut self, field: u32, text: &str) {
        self.put_bytes(field, text.as_bytes());
    }

    /// Appends a number of 32 bits.
    #[cfg(feature = "renderer")]
    pub(crate) fn put_u32(&mut self, field: u32, value: u32) {
        self.put_key(field, FIXED32);
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    /// Appends an array.
    #[cfg(feature = "renderer")]
    pub(crate) fn put_array(&mut self, field: u32, values: &[f64]) {
        self.put_doubles(field, values.len());
        self.set(self.slots.len() - 1, values);
    }

    /// Appends a message as a field.
    pub(crate) fn put_message(&mut self, field: u32, write: impl FnOnce(&mut Self)) {
        self.put_key(field, BYTES);
        let (start, slot, stamp) = (self.bytes.len(), self.slots.len(), self.stamps.len());
        write(self);
        let end = self.bytes.len();
        self.put_varint((end - start) as u64);
        let shift = self.bytes.len() - end;
        self.bytes[start..].rotate_right(shift);
        self.slots[slot..].iter_mut().for_each(|slot| *slot = slot.start + shift..slot.end + shift);
        self.stamps[stamp..].iter_mut().for_each(|stamp| *stamp += shift);
    }

    /// Appends a message of numbers in the fields 1, 2, …: a vector, a quaternion or a colour.
    pub(crate) fn put_tuple(&mut self, field: u32, values: &[f64]) {
        self.put_key(field, BYTES);
        self.put_varint(9 * values.len() as u64);
        for (number, &value) in (1..).zip(values) {
            self.put_double(number, value);
        }
    }

    pub(super) fn put_double(&mut self, field: u32, value: f64) {
        self.put_key(field, FIXED64);
        self.put_slot(1);
        self.set(self.slots.len() - 1, &[value]);
    }

    /// Appends an array of zeros.
    pub(super) fn put_doubles(&mut self, field: u32, count: usize) {
        self.put_key(field, BYTES);
        self.put_varint(8 * count as u64);
        self.put_slot(count);
    }

    fn put_slot(&mut self, count: usize) {
        let start = self.bytes.len();
        self.bytes.resize(start + 8 * count, 0);
        self.slots.push(start..self.bytes.len());
    }

    /// Appends an array of numbers of 32 bits.
    pub(super) fn put_fixed32(&mut self, field: u32, values: impl Iterator<Item = u32>) {
        let bytes: Vec<u8> = values.flat_map(u32::to_le_bytes).collect();
        self.put_bytes(field, &bytes);
    }

    /// Appends a timestamp of zero.
    pub(crate) fn put_stamp(&mut self, field: u32) {
        self.put_key(field, BYTES);
        self.put_varint(2 * (1 + STAMP) as u64);
        self.stamps.push(self.bytes.len());
        for number in [1, 2] {
            self.put_key(number, VARINT);
            self.bytes.extend(padded(0));
        }
    }

    /// Overwrites all timestamps, ns.
    pub(super) fn set_stamps(&mut self, time: u64) {
        let (seconds, nanos) = (padded(time / 1_000_000_000), padded(time % 1_000_000_000));
        for &stamp in &self.stamps {
            self.bytes[stamp + 1..][..STAMP].copy_from_slice(&seconds);
            self.bytes[stamp + 2 + STAMP..][..STAMP].copy_from_slice(&nanos);
        }
    }

    /// Overwrites the numbers of a slot.
    #[inline]
    fn set(&mut self, slot: usize, values: &[f64]) {
        let (places, rest) = self.bytes[self.slots[slot].clone()].as_chunks_mut();
        debug_assert!(rest.is_empty() && places.len() == values.len());
        for (place, value) in places.iter_mut().zip(values) {
            *place = value.to_le_bytes();
        }
    }

    /// Overwrites the numbers of all slots, in their order.
    #[inline]
    pub(super) fn fill<'v>(&mut self, parts: impl IntoIterator<Item = &'v [f64]>) {
        let mut number = 0;
        for (slot, values) in parts.into_iter().enumerate() {
            self.set(slot, values);
            number = slot + 1;
        }
        debug_assert_eq!(number, self.slots.len());
    }
}

/// Returns a number of up to 35 bits as a varint of constant length.
fn padded(value: u64) -> [u8; STAMP] {
    let last = STAMP - 1;
    std::array::from_fn(|index| {
        let bits = (value >> (7 * index)) as u8 & 0x7f;
        if index < last { bits | 0x80 } else { bits }
    })
}

/// Returns the next field of a message of unknown origin: its number, and the bytes of a text, a
/// message, an array or a number of 64 bits, or `None` for another number. Returns `None` if the
/// message is damaged.
pub(super) fn take_field<'b>(message: &mut &'b [u8]) -> Option<(u64, Option<&'b [u8]>)> {
    let key = take_varint(message)?;
    let mut bytes = None;
    match key & 7 {
        VARINT => _ = take_varint(message)?,
        FIXED32 => _ = message.split_off(..4)?,
        FIXED64 => bytes = Some(message.split_off(..8)?),
        BYTES => {
            let length = usize::try_from(take_varint(message)?).ok()?;
            bytes = Some(message.split_off(..length)?);
        }
        _ => return None,
    }
    Some((key >> 3, bytes))
}

fn take_varint(bytes: &mut &[u8]) -> Option<u64> {
    let mut value = 0;
    for shift in (0..64).step_by(7) {
        let byte = *bytes.split_off_first()?;
        value |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Some(value);
        }
    }
    None
}
