//! Writes simulations as a dataset of [LeRobot](https://github.com/huggingface/lerobot), in the
//! format v3.0 that its package reads since 0.4: Parquet files for numbers, a video for the images
//! of each episode, and metadata.
//!
//! ```text
//! cargo run --release --manifest-path examples/lerobot/Cargo.toml -- squats 3
//! ```
//!
//! writes 3 episodes to the folder `squats`, which must not exist: an action has the target lengths
//! of the humanoid's actuators, at random near those of a squat. It needs the program `ffmpeg`. In
//! Python:
//!
//! ```python
//! from lerobot.datasets.lerobot_dataset import LeRobotDataset
//!
//! dataset = LeRobotDataset("local/squats", root="squats")
//! print(dataset[7]["action"], dataset[7]["observation.images.side"].shape)
//! ```
//!
//! `scripts/lerobot` runs both, and compares what the package reads with the simulation.

mod statistics;
mod table;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use mujoco_safe::record::{Recorder, RecorderOptions};
use mujoco_safe::render::{Renderer, RgbImage};
use mujoco_safe::{Controller, Data, PdController, RandomController, sample};
use serde_json::{Value, json};

use crate::statistics::Statistics;
use crate::table::{Column, write_table};

/// Images and rows of the table per second: each is eight steps of 5 ms.
const FRAMES_PER_SECOND: u32 = 25;
const STEPS: usize = 8;
const FRAMES: usize = 50;
const SIZE: [usize; 2] = [320, 240];

const TASK: &str = "Squat.";
const VIDEO: &str = "observation.images.side";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, episodes] = &arguments[..] else { return Err("usage: mujoco-safe-lerobot FOLDER EPISODES".into()) };
    let folder = PathBuf::from(folder);
    fs::create_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut dataset = Dataset::default();
    let mut data = Data::new(sample::humanoid())?;
    let mut renderer = Renderer::new(data.model(), SIZE[0], SIZE[1])?;
    for episode in 0..episodes.parse()? {
        dataset.simulate(&mut data, &folder, episode, &mut renderer)?;
    }
    dataset.write(&folder)
}

/// Rows of all episodes.
#[derive(Default)]
struct Dataset {
    states: Vec<f32>,
    actions: Vec<f32>,
    /// Number of rows of each episode.
    lengths: Vec<usize>,
    colours: Statistics,
}

impl Dataset {
    /// Simulates an episode, and writes its video. A proportional-derivative controller follows the
    /// actions.
    fn simulate(
        &mut self,
        data: &mut Data,
        folder: &Path,
        episode: u64,
        renderer: &mut Renderer,
    ) -> Result<(), Box<dyn Error>> {
        data.reset_to_key("squat")?;
        let mut controller = PdController::new(data.model(), 1.0, 0.1);
        controller.hold(data)?;
        let lengths = data.actuator_length().to_vec();
        let mut random = RandomController::new(episode);
        let video = folder.join(path("videos", VIDEO, episode, "mp4"));
        fs::create_dir_all(video.parent().ok_or("a video has a folder")?)?;
        let options = RecorderOptions::default().with_frames_per_second(f64::from(FRAMES_PER_SECOND));
        let mut recorder = Recorder::create(&video, options)?;
        let mut picture = RgbImage::default();
        for frame in 0..FRAMES {
            // A row has what a policy sees, and what it then does.
            data.forward()?;
            renderer.snapshot(data, "side")?.rgb_into(&mut picture)?;
            recorder.push(&picture, frame as f64 / f64::from(FRAMES_PER_SECOND))?;
            let colours = picture.as_bytes().as_chunks::<3>().0;
            self.colours.add(colours.iter().map(|colour| colour.map(|channel| f64::from(channel) / 255.0)));
            self.states.extend(data.qpos().iter().chain(data.qvel()).map(|&value| value as f32));
            random.control(data)?;
            for (actuator, (&length, &noise)) in data.model().actuators().zip(lengths.iter().zip(data.ctrl())) {
                let target = length + 0.1 * noise;
                controller.set_target(actuator.id(), target);
                self.actions.push(target as f32);
            }
            for _ in 0..STEPS {
                controller.control(data)?;
                data.step()?;
            }
        }
        recorder.finish()?;
        self.lengths.push(FRAMES);
        Ok(())
    }

    /// Writes the tables and the metadata.
    fn write(&self, folder: &Path) -> Result<(), Box<dyn Error>> {
        let frames: usize = self.lengths.iter().sum();
        let of_frames = |value: fn(usize, usize) -> usize| {
            let episodes = self.lengths.iter().enumerate();
            episodes.flat_map(move |(episode, &length)| (0..length).map(move |frame| value(episode, frame)))
        };
        let integers =
            |values: &mut dyn Iterator<Item = usize>| Column::Integers(values.map(|value| value as i64).collect());
        let times = of_frames(|_, frame| frame).map(|frame| frame as f32 / FRAMES_PER_SECOND as f32);
        let (state_width, action_width) = (self.states.len() / frames, self.actions.len() / frames);
        write_table(
            &folder.join(path("data", "", 0, "parquet")),
            &[
                ("observation.state", Column::Vectors(self.states.clone(), state_width)),
                ("action", Column::Vectors(self.actions.clone(), action_width)),
                ("timestamp", Column::Floats(times.collect())),
                ("frame_index", integers(&mut of_frames(|_, frame| frame))),
                ("episode_index", integers(&mut of_frames(|episode, _| episode))),
                ("index", integers(&mut (0..frames))),
                ("task_index", integers(&mut of_frames(|_, _| 0))),
            ],
            None,
        )?;

        let episodes = self.lengths.len();
        let ends: Vec<usize> = self
            .lengths
            .iter()
            .scan(0, |end, length| {
                *end += length;
                Some(*end)
            })
            .collect();
        let starts = ends.iter().zip(&self.lengths).map(|(end, length)| end - length);
        let zeros = || integers(&mut std::iter::repeat_n(0, episodes));
        let durations = self.lengths.iter().map(|&length| length as f64 / f64::from(FRAMES_PER_SECOND));
        let of_video = |name: &str| format!("videos/{VIDEO}/{name}");
        write_table(
            &folder.join(path("meta/episodes", "", 0, "parquet")),
            &[
                ("episode_index", integers(&mut (0..episodes))),
                ("tasks", Column::TextLists(vec![TASK.to_owned(); episodes])),
                ("length", integers(&mut self.lengths.iter().copied())),
                ("data/chunk_index", zeros()),
                ("data/file_index", zeros()),
                ("dataset_from_index", integers(&mut starts.clone())),
                ("dataset_to_index", integers(&mut ends.iter().copied())),
                (&of_video("chunk_index"), zeros()),
                (&of_video("file_index"), integers(&mut (0..episodes))),
                (&of_video("from_timestamp"), Column::Doubles(vec![0.0; episodes])),
                (&of_video("to_timestamp"), Column::Doubles(durations.collect())),
                ("meta/episodes/chunk_index", zeros()),
                ("meta/episodes/file_index", zeros()),
            ],
            None,
        )?;
        // The tasks are the index of a table of pandas.
        let pandas = json!({
            "index_columns": ["task"],
            "column_indexes": [],
            "columns": [
                {"name": "task_index", "field_name": "task_index", "pandas_type": "int64", "numpy_type": "int64", "metadata": null},
                {"name": "task", "field_name": "task", "pandas_type": "unicode", "numpy_type": "object", "metadata": null},
            ],
            "pandas_version": "2.0.0",
        });
        let tasks = [("task_index", integers(&mut (0..1))), ("task", Column::Texts(vec![TASK.to_owned()]))];
        write_table(&folder.join("meta/tasks.parquet"), &tasks, Some(("pandas", pandas.to_string())))?;
        write_json(&folder.join("meta/info.json"), &self.info())?;
        let vectors = |values: &[f32], width| {
            let mut statistics = Statistics::default();
            statistics
                .add(values.chunks(width).map(|row| row.iter().map(|&value| f64::from(value)).collect::<Vec<_>>()));
            statistics.to_json(frames, |value| json!(value))
        };
        write_json(
            &folder.join("meta/stats.json"),
            &json!({
                "observation.state": vectors(&self.states, state_width),
                "action": vectors(&self.actions, action_width),
                VIDEO: self.colours.to_json(frames, |channel| json!([[channel]])),
            }),
        )
    }

    /// Returns the description of the dataset.
    fn info(&self) -> Value {
        let model = sample::humanoid();
        let named = |kind: &str, count: usize| (0..count).map(|index| format!("{kind}_{index}")).collect::<Vec<_>>();
        let state: Vec<String> = [named("qpos", model.nq()), named("qvel", model.nv())].concat();
        let action: Vec<&str> = model.actuators().map(|actuator| actuator.name().unwrap_or_default()).collect();
        let vector = |kind: &str, names: Value| {
            let width = names.as_array().map_or(1, Vec::len);
            json!({"dtype": kind, "shape": [width], "names": names})
        };
        let video = json!({
            "dtype": "video",
            "shape": [SIZE[1], SIZE[0], 3],
            "names": ["height", "width", "channels"],
            "info": {
                "video.fps": FRAMES_PER_SECOND, "video.height": SIZE[1], "video.width": SIZE[0], "video.channels": 3,
                "video.codec": "h264", "video.pix_fmt": "yuv420p", "video.is_depth_map": false, "has_audio": false,
            },
        });
        json!({
            "codebase_version": "v3.0",
            "robot_type": "humanoid",
            "fps": FRAMES_PER_SECOND,
            "total_episodes": self.lengths.len(),
            "total_frames": self.lengths.iter().sum::<usize>(),
            "total_tasks": 1,
            "splits": {"train": format!("0:{}", self.lengths.len())},
            "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
            "video_path": "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4",
            "features": {
                "observation.state": vector("float32", json!(state)),
                "action": vector("float32", json!(action)),
                VIDEO: video,
                "timestamp": vector("float32", Value::Null),
                "frame_index": vector("int64", Value::Null),
                "episode_index": vector("int64", Value::Null),
                "index": vector("int64", Value::Null),
                "task_index": vector("int64", Value::Null),
            },
        })
    }
}

/// Returns the path of a file of the dataset, in the first chunk of files.
fn path(part: &str, key: &str, file: u64, extension: &str) -> PathBuf {
    Path::new(part).join(key).join(format!("chunk-000/file-{file:03}.{extension}"))
}

fn write_json(path: &Path, value: &Value) -> Result<(), Box<dyn Error>> {
    Ok(fs::write(path, serde_json::to_string_pretty(value)?)?)
}
