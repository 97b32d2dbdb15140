//! The engine's renderer in a Python process.

use std::env;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use mujoco_safe::Data;
use mujoco_safe::render::RendererOptions;
use serde_json::{Value, json};

use crate::Result;
use crate::scenes::{self, Setting};

/// Process that runs the engine's renderer.
pub struct Engine {
    process: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Engine {
    pub fn start() -> Result<Option<Self>> {
        let Some(python) = env::var_os("MUJOCO_PYTHON") else {
            println!("the engine's renderer is omitted: MUJOCO_PYTHON is not set");
            return Ok(None);
        };
        let mut command = Command::new(python);
        command.arg(scenes::root().join("benches/render.py")).stdin(Stdio::piped()).stdout(Stdio::piped());
        if env::var_os("MUJOCO_GL").is_none() {
            command.env("MUJOCO_GL", "osmesa");
        }
        if let Some(library) = engine_library()? {
            command.env("LD_PRELOAD", library);
        }
        let mut process = command.spawn()?;
        let (input, output) =
            (process.stdin.take().ok_or("stdin is not piped")?, process.stdout.take().ok_or("stdout is not piped")?);
        Ok(Some(Self { process, input, output: BufReader::new(output) }))
    }

    fn request(&mut self, request: &Value) -> Result<Value> {
        writeln!(self.input, "{request}")?;
        let mut answer = String::new();
        self.output.read_line(&mut answer)?;
        if answer.is_empty() {
            return Err("the engine's process has ended".into());
        }
        Ok(serde_json::from_str(&answer)?)
    }

    /// Opens a scene in the state of a simulation.
    pub fn open(&mut self, setting: &Setting, data: &Data, size: [usize; 2], options: &RendererOptions) -> Result<()> {
        let visual: Vec<&str> = setting.visual.iter_names().map(|(name, _)| name).collect();
        let render: Vec<&str> = setting.render.iter_names().map(|(name, _)| name).collect();
        self.request(&json!({
            "open": setting.model, "width": size[0], "height": size[1],
            "samples": options.samples, "shadow_size": options.shadow_size,
            "state": { "qpos": data.qpos(), "qvel": data.qvel(), "act": data.act() },
            "elevations": data.model().hfield_data(),
            "fixed": setting.fixed, "lookat": setting.lookat, "distance": setting.distance,
            "azimuth": setting.azimuth, "elevation": setting.elevation,
            "visual": visual, "render": render,
        }))
        .map(drop)
    }

    /// Writes an image to a file: red, green and blue of each pixel, row-major from the upper left.
    pub fn picture(&mut self, file: &Path) -> Result<()> {
        self.request(&json!({ "picture": file })).map(drop)
    }

    /// Renders several images and returns the processor time, s.
    pub fn turn(&mut self, pictures: usize) -> Result<f64> {
        self.draw("rgb", pictures, "cpu")
    }

    /// Renders several images of this kind (`rgb`, `depth` or `ids`) and returns the time, s.
    pub fn wall_time(&mut self, kind: &str, pictures: usize) -> Result<f64> {
        self.draw(kind, pictures, "wall")
    }

    fn draw(&mut self, kind: &str, pictures: usize, time: &str) -> Result<f64> {
        let answer = self.request(&json!({"draw": pictures, "kind": kind}))?;
        answer[time].as_f64().ok_or_else(|| "the answer contains no time".into())
    }
}

/// Returns the path of the shared library of the engine in this process, for use in the other
/// process: builds of the same version differ in speed.
fn engine_library() -> Result<Option<String>> {
    let maps = fs::read_to_string("/proc/self/maps")?;
    let mut paths = maps.lines().filter_map(|line| Some(&line[line.find('/')?..]));
    Ok(paths.find(|path| path.contains("/libmujoco.so")).map(str::to_owned))
}

impl Drop for Engine {
    fn drop(&mut self) {
        _ = self.process.kill();
        _ = self.process.wait();
    }
}
