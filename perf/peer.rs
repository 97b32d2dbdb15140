//! Process that runs a reference implementation on command.

use std::io::{BufRead, BufReader, Lines, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use crate::Outcome;

pub(crate) struct Peer {
    child: Child,
    commands: Option<ChildStdin>,
    answers: Lines<BufReader<ChildStdout>>,
}

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
        let mut child = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| format!("{}: {error}", program.display()))?;
        let answers = BufReader::new(child.stdout.take().ok_or("no output")?).lines();
        Ok(Self { commands: child.stdin.take(), child, answers })
    }

    /// Runs a command. Returns the elapsed seconds and a checksum of the result.
    pub(crate) fn run(&mut self, command: &str) -> Outcome<(f64, f64)> {
        writeln!(self.commands.as_mut().ok_or("the process has ended")?, "{command}")?;
        let answer = self.answers.next().ok_or_else(|| format!("no answer to: {command}"))??;
        let (seconds, checksum) = answer.split_once(' ').ok_or_else(|| format!("unexpected answer: {answer}"))?;
        Ok((seconds.parse()?, checksum.parse()?))
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // The process exits at the end of its input.
        drop(self.commands.take());
        let _ = self.child.wait();
    }
}
