//! Trajectories as NumPy archives (`.npz`): the arrays `time`, `qpos`, `qvel`, `act`, `ctrl` and,
//! if recorded, `sensordata`.

use std::io;
use std::path::Path;

use super::{Sizes, Trajectory};
use crate::error::{Error, Result};
use crate::model::Model;
use crate::npz::read::Archive;
use crate::npz::{self, Array};

impl Trajectory {
    /// Writes the records as a NumPy archive (`.npz`), which Python reads with `numpy.load`. It
    /// contains the arrays `time` of shape `(n)`, s, `qpos` `(n, nq)`, `qvel` `(n, nv)`, `act`
    /// `(n, na)`, `ctrl` `(n, nu)` and, if recorded, `sensordata` `(n, nsensordata)` for `n`
    /// records. Reading the file restores every value bit for bit.
    ///
    /// Requires the feature `npz`.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written; an existing file is then unchanged.
    ///
    /// ```
    /// use mujoco_safe::{Data, RandomController, Trajectory, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// let mut trajectory = Trajectory::new(data.model());
    /// trajectory.record(&mut data, &mut RandomController::new(1), 100)?;
    ///
    /// let path = std::env::temp_dir().join("mujoco_safe_cartpole.npz");
    /// trajectory.save_npz(&path)?;
    /// assert_eq!(Trajectory::load_npz(data.model(), &path)?, trajectory);
    /// # std::fs::remove_file(path).ok();
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "savez")]
    pub fn save_npz(&self, path: impl AsRef<Path>) -> Result<()> {
        let Sizes { nq, nv, na, nu } = self.sizes;
        let columns = |start: usize, width: usize| -> Vec<f64> {
            (0..self.len()).flat_map(|record| &self.state(record)[start..start + width]).copied().collect()
        };
        let (qpos, qvel, act) = (columns(0, nq), columns(nq, nv), columns(nq + nv, na));
        let records = self.len();
        let arrays = [
            Array::new("time", &[records], &self.times),
            Array::new("qpos", &[records, nq], &qpos),
            Array::new("qvel", &[records, nv], &qvel),
            Array::new("act", &[records, na], &act),
            Array::new("ctrl", &[records, nu], &self.controls),
            Array::new("sensordata", &[records, self.nsensordata], &self.sensordata),
        ];
        let recorded = if self.nsensordata > 0 { &arrays[..] } else { &arrays[..5] };
        npz::save(path, recorded)
    }

    /// Reads a file written by [`save_npz`](Self::save_npz), or by `numpy.savez` or
    /// `numpy.savez_compressed` with these arrays, for simulations of this model. `sensordata` and
    /// arrays that have no columns, such as `act` of a model without activations, may be missing.
    /// Other arrays in the file are ignored. The arrays may unpack to 64
    /// MiB, or to a hundred times the size of the file if that is more, so that a small file cannot
    /// exhaust the memory.
    ///
    /// Requires the feature `npz`.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be read, is a pipe or a device, lacks an array, contains
    /// an array whose shape does not match this model or whose type is not double precision,
    /// contains two arrays of the same name, or unpacks to more than the limit. The message names
    /// the array.
    pub fn load_npz(model: &Model, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::read_npz(model, path).map_err(Error::file(path))
    }

    fn read_npz(model: &Model, path: &Path) -> io::Result<Self> {
        let mut archive = Archive::open(path)?;
        let sizes = Sizes::of(model);
        let nsensordata = if archive.has("sensordata") { model.nsensordata() } else { 0 };
        let times = archive.array("time", |shape| match shape {
            &[records] => Ok(records),
            _ => Err("(n)".to_owned()),
        })?;
        let records = times.len();
        let mut matrix = |name: &str, width: usize| {
            if width == 0 && !archive.has(name) {
                return Ok(Vec::new());
            }
            archive.array(name, |shape| match shape {
                &[rows, columns] if (rows, columns) == (records, width) => {
                    rows.checked_mul(columns).ok_or_else(|| "fewer values".to_owned())
                }
                _ => Err(format!("({records}, {width}) to match 'time' and this model")),
            })
        };
        let qpos = matrix("qpos", sizes.nq)?;
        let qvel = matrix("qvel", sizes.nv)?;
        let act = matrix("act", sizes.na)?;
        let controls = matrix("ctrl", sizes.nu)?;
        let sensordata = if nsensordata > 0 { matrix("sensordata", nsensordata)? } else { Vec::new() };
        let mut states = Vec::with_capacity(qpos.len() + qvel.len() + act.len());
        for record in 0..records {
            for (values, width) in [(&qpos, sizes.nq), (&qvel, sizes.nv), (&act, sizes.na)] {
                states.extend_from_slice(&values[record * width..][..width]);
            }
        }
        Ok(Self { sizes, times, states, controls, nsensordata, sensordata })
    }
}
