//! The checksum of the chunk of an MCAP file.

#![allow(unreachable_pub, reason = "included by several tests")]

/// Sets the checksum of the first chunk to zero, which means that there is none, so that damage
/// reaches the parts inside.
pub fn clear_chunk_crc(bytes: &mut [u8]) {
    if let Some(crc) = chunk_crc(bytes) {
        bytes[crc..crc + 4].fill(0);
    }
}

/// Returns the place of the checksum of the first chunk.
pub fn chunk_crc(bytes: &[u8]) -> Option<usize> {
    let mut place = 8;
    loop {
        let opcode = *bytes.get(place)?;
        let length = bytes.get(place + 1..place + 9)?.try_into().ok()?;
        if opcode == 6 {
            let crc = place + 9 + 24;
            return (crc + 4 <= bytes.len()).then_some(crc);
        }
        place = place.checked_add(9)?.checked_add(usize::try_from(u64::from_le_bytes(length)).ok()?)?;
    }
}
