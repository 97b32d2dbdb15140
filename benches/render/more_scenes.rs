//! Scenes of the comparison of pictures that the tests do not have.

use std::fs;
use std::path::{Path, PathBuf};

use mujoco_safe::sample;
use mujoco_safe::scene::RenderFlags;
use serde_json::Value;

use crate::Result;
use crate::arm::Arm;
use crate::scenes::{self, Setting};

/// Returns the scene of this name: the name of a model, and a camera or the number of a view.
pub fn named(arm: &Arm, name: &str) -> Result<Setting> {
    all(arm)?.into_iter().find(|setting| setting.name == name).ok_or_else(|| format!("no scene is named {name}").into())
}

/// Returns all scenes of `scenes.json`. Each row has a model, and names of its cameras or views
/// with a free camera: azimuth and elevation in degrees, and the distance relative to the initial
/// distance of the free camera.
pub fn all(arm: &Arm) -> Result<Vec<Setting>> {
    let folder = scenes::root().join("benches/render");
    let rows: Value = serde_json::from_str(&fs::read_to_string(folder.join("scenes.json"))?)?;
    let folders = [
        folder.join("models"),
        arm.folder().to_owned(),
        scenes::folder().join("models"),
        PathBuf::from(sample::SYSTEM_MODELS),
    ];
    let mut settings = Vec::new();
    for row in list(&rows) {
        let model = row["model"].as_str().ok_or("a row has no model")?;
        let path = folders.iter().map(|folder| folder.join(model)).find(|path| path.exists());
        add(row, &path.ok_or_else(|| format!("no model {model}"))?, &mut settings)?;
    }
    Ok(settings)
}

fn add(row: &Value, path: &Path, settings: &mut Vec<Setting>) -> Result<()> {
    let mut render = RenderFlags::empty();
    for name in list(&row["render"]) {
        render |= name.as_str().and_then(RenderFlags::from_name).ok_or("unknown render flag")?;
    }
    let suffix = if render.is_empty() { String::new() } else { format!("_{render:?}").replace(['(', ')'], "_") };
    let rest = Setting::of_model(path)?;
    let setting = |name: String| Setting {
        name: format!("{}_{name}{suffix}", rest.name),
        steps: row["steps"].as_u64().unwrap_or(0) as usize,
        render,
        ..rest.clone()
    };
    for camera in list(&row["cameras"]).iter().filter_map(Value::as_str) {
        settings.push(Setting { fixed: Some(camera.to_owned()), ..setting(camera.to_owned()) });
    }
    for (view, number) in list(&row["views"]).iter().zip(1..) {
        let [azimuth, elevation, distance] = [0, 1, 2].map(|place| view[place].as_f64().unwrap_or(0.0));
        settings.push(Setting {
            azimuth,
            elevation,
            distance: distance * rest.distance,
            ..setting(number.to_string())
        });
    }
    Ok(())
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}
