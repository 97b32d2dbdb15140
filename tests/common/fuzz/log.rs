//! Damaged logs and ROS 2 bags.

use super::{Bytes, Verdict};

#[cfg(not(feature = "mcap"))]
pub(super) fn mutated_log(_bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
    log("built without the feature mcap");
    Verdict::Rejected
}

#[cfg(feature = "mcap")]
pub(super) use damaged::mutated_log;

#[cfg(feature = "mcap")]
mod damaged {
    use mujoco_safe::mcap::read_joint_states;
    use mujoco_safe::{Data, Trajectory};

    use super::super::chunk_crc::clear_chunk_crc;
    use super::super::{archive, models};
    use super::{Bytes, Verdict};

    const BAG: &[u8] = include_bytes!("../../trajectory/mcap/joint_states.mcap");

    pub(crate) fn mutated_log(bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
        let folder = tempfile::tempdir().expect("no temporary folder");
        let path = folder.path().join("file.mcap");
        if bytes.once_in(3) {
            let mut file = BAG.to_vec();
            damage(&mut file, bytes, log);
            std::fs::write(&path, file).expect("a file is written");
            log("read_joint_states");
            let Ok(joints) = read_joint_states(&path, "/joint_states") else { return Verdict::Rejected };
            for series in joints.values() {
                let lengths = [&series.position, &series.velocity, &series.effort].map(Vec::len);
                assert_eq!(lengths, [series.times.len(); 3]);
            }
            return Verdict::Worked;
        }
        let model = models::model(models::choose(bytes));
        let Ok(mut data) = Data::new(model.clone()) else { return Verdict::Rejected };
        archive::trajectory(&mut data, bytes).save_mcap(model, &path).expect("a file is written");
        let mut file = std::fs::read(&path).expect("a written file");
        damage(&mut file, bytes, log);
        std::fs::write(&path, file).expect("a file is written");
        log("load_mcap");
        let Ok(loaded) = Trajectory::load_mcap(model, &path) else { return Verdict::Rejected };
        let _ = data.reset();
        archive::use_trajectory(&loaded, &mut data, log);
        Verdict::Worked
    }

    /// Changes some bytes, and mostly removes the checksum, which would reject the file otherwise.
    fn damage(file: &mut Vec<u8>, bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) {
        for _ in 0..=bytes.below(3) {
            let place = bytes.below(file.len());
            let kind = bytes.below(7);
            log(&format!("damage {kind} of byte {place}"));
            match kind {
                0 => file[place] = bytes.word() as u8,
                1 => file[place] ^= 1 << bytes.below(8),
                2 => file[place] = u8::MAX,
                3 => file[place..].iter_mut().take(8).for_each(|byte| *byte = u8::MAX),
                4 => file[place..].iter_mut().take(8).for_each(|byte| *byte = 0),
                5 => drop(file.drain(place..(place + 1 + bytes.below(40)).min(file.len()))),
                _ => file.insert(place, bytes.word() as u8),
            }
            if file.is_empty() {
                return;
            }
        }
        if !bytes.once_in(8) {
            clear_chunk_crc(file);
        }
    }
}
