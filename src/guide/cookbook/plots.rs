//! Plots of a simulation.
//!
#![doc = include_str!("plots.html")]
//!
//! The crate `plotters` draws charts as SVG: `cargo add plotters --no-default-features --features
//! svg_backend,line_series`.
//!
//! ```
//! use mujoco_safe::{Data, Lqr, LqrWeights, Trajectory, sample};
//! use plotters::prelude::*;
//!
//! let mut data = Data::new(sample::cartpole())?;
//! let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
//! let mut lqr = Lqr::at_present_state(&mut data, &weights)?;
//! data.joint_mut("hinge")?.qpos_mut()[0] = 0.1;
//! let mut trajectory = Trajectory::new(data.model());
//! trajectory.record(&mut data, &mut lqr, 300)?;
//!
//! let path = std::env::temp_dir().join("mujoco_safe_pole.svg");
//! let canvas = SVGBackend::new(&path, (640, 400)).into_drawing_area();
//! canvas.fill(&WHITE)?;
//! let mut chart = ChartBuilder::on(&canvas)
//!     .margin(10)
//!     .caption("The pole of a cart-pole under LQR", ("sans-serif", 18))
//!     .set_label_area_size(LabelAreaPosition::Left, 50)
//!     .set_label_area_size(LabelAreaPosition::Bottom, 40)
//!     .build_cartesian_2d(0.0..data.time(), -0.1..0.1)?;
//! let mut mesh = chart.configure_mesh();
//! mesh.max_light_lines(1).x_desc("time (s)").y_desc("angle (rad)").draw()?;
//! let angles = (0..trajectory.len()).map(|k| trajectory.qpos(k)[1]);
//! let points = trajectory.times().iter().copied().zip(angles);
//! chart.draw_series(LineSeries::new(points, &BLUE))?;
//! canvas.present()?;
//! # drop(chart);
//! # drop(canvas);
//! # assert!(std::fs::read_to_string(&path)?.contains("polyline"));
//! # if std::env::var_os("MUJOCO_SAFE_PICTURES").is_none() {
//! #     std::fs::remove_file(path).ok(); // otherwise scripts/pictures reads it
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Without a crate: the [viewer](crate::guide::pictures#the-viewer) plots while the simulation runs
//! (F3, F4), and every spreadsheet and `pandas.read_csv` read the table that
//! [`save_csv`](crate::Trajectory::save_csv) writes.
