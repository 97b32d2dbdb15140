//! Process that runs a reference implementation on command.

use std::path::Path;
use std::process::Command;

use crate::Outcome;
use crate::process::Process;

pub(crate) struct Peer(Process);

impl Peer {
    /// Starts a program, or a script with an interpreter, for a model.
    pub(crate) fn start(program: &Path, model: &Path, key: Option<&str>, script: Option<&str>) -> Outcome<Self> {
        let mut command = Command::new(program);
        match script {
            Some(script) => {
                command.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join(script)).arg(model).arg(key.unwrap_or("-"));
            }
            None => {
                command.arg(model).args(key);
            }
        }
        // `scripts/compare` sets this variable, so that all references use the same engine.
        if let (Some(library), true) = (std::env::var_os("COMPARE_PRELOAD"), script.is_some()) {
            command.env("LD_PRELOAD", library);
        }
        let process = Process::spawn(&mut command).map_err(|error| format!("{}: {error}", program.display()))?;
        Ok(Self(process))
    }

    /// Runs a command. Returns the elapsed seconds and a checksum of the result.
    pub(crate) fn run(&mut self, command: &str) -> Outcome<(f64, f64)> {
        self.0.send(command)?;
        let answer = self.0.line().map_err(|error| format!("no answer to {command}: {error}"))?;
        let (seconds, checksum) = answer.split_once(' ').ok_or_else(|| format!("unexpected answer: {answer}"))?;
        Ok((seconds.parse()?, checksum.parse()?))
    }
}
