//! A child process that answers lines of its input by lines of its output.

use std::io::{BufRead, BufReader, Error, ErrorKind, Lines, Result, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

pub(crate) struct Process {
    child: Child,
    input: Option<ChildStdin>,
    output: Lines<BufReader<ChildStdout>>,
}

impl Process {
    pub(crate) fn spawn(command: &mut Command) -> Result<Self> {
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let (input, output) = (child.stdin.take(), child.stdout.take().expect("the stream is piped"));
        Ok(Self { child, input, output: BufReader::new(output).lines() })
    }

    pub(crate) fn send(&mut self, line: &str) -> Result<()> {
        writeln!(self.input.as_mut().expect("the stream is open"), "{line}")
    }

    /// Returns the next line of the output.
    pub(crate) fn line(&mut self) -> Result<String> {
        self.output.next().unwrap_or_else(|| Err(Error::new(ErrorKind::UnexpectedEof, "the program ended")))
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // The program ends with its input.
        self.input = None;
        let _ = self.child.wait();
    }
}
