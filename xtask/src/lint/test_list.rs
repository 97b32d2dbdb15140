//! The tests of the integration tests' programs, as the programs list them.

use std::path::Path;
use std::process::{Command, Stdio};

/// Returns the path of each test, with the name of its program: `data::boundary::a_test`.
pub fn all(root: &Path) -> Result<Vec<String>, String> {
    // The build of `scripts/test`. Cargo prints a JSON object per line for each program, and errors
    // of the compiler to standard error.
    let arguments = [
        "test",
        "--features",
        "viewer,mjz,npz,mcap,live,gltf,serde",
        "--tests",
        "--no-run",
        "--message-format=json-render-diagnostics",
    ];
    let output = output(Command::new(env!("CARGO")).args(arguments).current_dir(root))?;
    let programs = output.lines().filter(|line| line.contains(r#""kind":["test"]"#));
    let mut tests = Vec::new();
    for line in programs {
        let field = |name: &str| line.split(name).nth(1).and_then(|rest| rest.split('"').next());
        let Some(program) = field(r#""executable":""#) else { continue };
        let name = field(r#""src_path":""#).and_then(|path| Path::new(path).parent()?.file_name()?.to_str());
        let name = name.ok_or_else(|| format!("the test program {program} has no folder"))?;
        let list = self::output(Command::new(program).args(["--list", "--format", "terse"]).current_dir(root))?;
        let names = list.lines().filter_map(|line| line.strip_suffix(": test"));
        tests.extend(names.map(|test| format!("{name}::{test}")));
    }
    Ok(tests)
}

fn output(command: &mut Command) -> Result<String, String> {
    let output = command.stderr(Stdio::inherit()).output().map_err(|error| format!("{command:?}: {error}"))?;
    if !output.status.success() {
        return Err(format!("{command:?}: {}", output.status));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}
