//! A program that waits for its turn.

use std::io::{BufRead, BufReader, Lines, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use crate::Outcome;

pub(crate) struct Peer {
    child: Child,
    orders: Option<ChildStdin>,
    answers: Lines<BufReader<ChildStdout>>,
}

impl Peer {
    /// Starts a program, or a script with the program, for a model.
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
        // `scripts/compare` names the engine that all are to use.
        if let (Some(library), true) = (std::env::var_os("COMPARE_PRELOAD"), script.is_some()) {
            command.env("LD_PRELOAD", library);
        }
        let mut child = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| format!("{}: {error}", program.display()))?;
        let answers = BufReader::new(child.stdout.take().ok_or("no output")?).lines();
        Ok(Self { orders: child.stdin.take(), child, answers })
    }

    /// The seconds that it took, and the number made of the result.
    pub(crate) fn ask(&mut self, order: &str) -> Outcome<(f64, f64)> {
        writeln!(self.orders.as_mut().ok_or("it has ended")?, "{order}")?;
        let answer = self.answers.next().ok_or_else(|| format!("no answer to: {order}"))??;
        let (seconds, made) = answer.split_once(' ').ok_or_else(|| format!("not understood: {answer}"))?;
        Ok((seconds.parse()?, made.parse()?))
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // The end of its input is the end of the program.
        drop(self.orders.take());
        let _ = self.child.wait();
    }
}
