//! A program that runs with another engine than that of its build reports it, and does not crash.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use mujoco_safe::{Error, Model, built_against};

use super::child;

/// Versions that are tested in full. Each has functions that the others lack.
const VERSIONS: [&str; 4] = ["v2_2_2", "v3_5_0", "v3_17_0", "v4_0_1"];

/// Version that the substitute reports.
const OTHER: u32 = 999;

#[test]
fn an_engine_of_another_version_is_an_error() {
    if child::is_child() {
        let error = Model::from_xml_str("<mujoco/>").unwrap_err();
        assert!(matches!(error, Error::EngineVersion { .. }), "{error}");
        let text = error.to_string();
        assert!(text.contains(&built_against().to_string()) && text.contains("9.9.9"), "{text}");
        return;
    }
    let _lock = super::lock_process();
    let folder = tempfile::tempdir().unwrap();
    build_substitute(folder.path());
    let mut command = child::command("engine_version::an_engine_of_another_version_is_an_error");
    let output = command.env("LD_LIBRARY_PATH", folder.path()).output().unwrap();
    let [stdout, stderr] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    assert!(output.status.success() && stdout.contains("1 passed"), "{stdout}{stderr}");
}

/// Compiles a library with the name of the engine and only the functions and variables that all
/// versions have.
fn build_substitute(folder: &Path) {
    let exported = VERSIONS.map(exports).into_iter().reduce(|all, of_one| &all & &of_one).unwrap();
    assert!(exported.len() > 200, "{}", exported.len());
    let declaration = |(name, is_function): (String, bool)| match (&*name, is_function) {
        ("mj_version", _) => format!("int mj_version(void) {{ return {OTHER}; }}\n"),
        (_, true) => format!("void {name}(void) {{}}\n"),
        (_, false) => format!("char {name}[65536];\n"),
    };
    let source: String = exported.into_iter().map(declaration).collect();
    let (code, library) = (folder.join("engine.c"), engine());
    let name = library.file_name().unwrap().to_str().unwrap();
    fs::write(&code, source).unwrap();
    let compiler = env::var_os("CC").unwrap_or_else(|| "cc".into());
    let mut command = Command::new(compiler);
    command.args(["-w", "-shared", "-fPIC", "-o"]).arg(folder.join(name)).arg(&code);
    assert!(command.arg(format!("-Wl,-soname,{name}")).status().unwrap().success());
}

/// Returns the names of the functions and variables in the bindings of a version, and `true` for
/// functions.
fn exports(version: &str) -> BTreeSet<(String, bool)> {
    let bindings = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("mujoco-sys/src/bindings/{version}.rs"));
    let text = fs::read_to_string(bindings).unwrap();
    let name =
        |rest: &str| rest.split(|symbol: char| !symbol.is_alphanumeric() && symbol != '_').next().map(str::to_owned);
    text.lines()
        .filter_map(|line| {
            let line = line.trim_start();
            let function = line.strip_prefix("pub fn ").map(|rest| (rest, true));
            let (rest, is_function) =
                function.or_else(|| Some((line.strip_prefix("pub static ")?.trim_start_matches("mut "), false)))?;
            Some((name(rest)?, is_function))
        })
        .filter(|(name, _)| name.starts_with("mj"))
        .collect()
}

/// Returns the file of the engine that this process has loaded.
fn engine() -> PathBuf {
    let maps = fs::read_to_string("/proc/self/maps").unwrap();
    let mut files = maps.lines().filter_map(|line| line.split_whitespace().nth(5)).map(PathBuf::from);
    let is_engine =
        |file: &PathBuf| file.file_name().is_some_and(|name| name.to_string_lossy().starts_with("libmujoco.so"));
    files.find(is_engine).expect("an engine that is linked dynamically")
}
