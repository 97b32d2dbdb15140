//! The parent process: passes seeds to child processes and classifies their ends.

use std::io::{self, Read as _, Write as _};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, ExitStatus, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::cases::cases;
use crate::fuzz::Target;
use crate::report::{Counts, Finding, Report};
use crate::worker::{self, MISBEHAVE, PANICKED, REJECTED, WORKED};

/// Cases per child. Each child has to load its models.
const LARGEST_BATCH: u64 = 200_000;
/// Time after which a case is considered to hang.
const LONGEST_CASE: Duration = Duration::from_secs(60);
/// Address space of a child, KiB.
const MEMORY: u64 = 4 << 20;
/// Largest number of findings, because a child that always crashes would never finish.
const MOST_FINDINGS: usize = 1000;

const USAGE: &str = "usage: campaign [--sequences N] [--binaries N] [--texts N] [--mjcf N] [--schema N] [--urdf N] [--archives N] [--plain N] [--recordings N] [--logs N] \
                     [--first SEED] [--jobs N] [--progress]";

/// A campaign: the number of cases per target, and its options.
pub struct Campaign {
    cases: Vec<(Target, u64)>,
    first: u64,
    jobs: usize,
    progress: bool,
}

impl Campaign {
    /// Returns the cases of `cargo test`.
    pub fn bounded() -> Self {
        let all = [
            (Target::Sequences, 3000),
            (Target::Binaries, 400),
            (Target::Texts, 250),
            (Target::Urdf, 600),
            (Target::Archives, 500),
            (Target::Plain, 500),
            (Target::Mjcf, 600),
            (Target::Schema, 400),
            (Target::Recordings, 600),
            (Target::Logs, 600),
        ];
        let selected = all.map(|(target, number)| (target, cases(number / 6, number)));
        Self { cases: selected.into(), first: 0, jobs: 2, progress: false }
    }

    pub fn from_options(options: &[&str]) -> Result<Self, String> {
        let mut campaign = Self { cases: vec![], first: 0, jobs: 2, progress: false };
        let mut options = options.iter();
        while let Some(option) = options.next() {
            if *option == "--progress" {
                campaign.progress = true;
                continue;
            }
            let value = options.next().and_then(|value| value.replace('_', "").parse::<u64>().ok()).ok_or(USAGE)?;
            match *option {
                "--first" => campaign.first = value,
                "--jobs" => campaign.jobs = usize::try_from(value).unwrap_or(1).clamp(1, 64),
                _ => {
                    let target =
                        Target::ALL.into_iter().find(|target| option.strip_prefix("--") == Some(target.name()));
                    campaign.cases.push((target.ok_or(USAGE)?, value));
                }
            }
        }
        Ok(campaign)
    }

    /// Returns whether every kind of misbehaviour of a child is detected.
    pub fn detects_misbehaviour() -> bool {
        let folder = Folder::new(MISBEHAVE);
        let (counts, mut findings) = run_batch(MISBEHAVE, 0..worker::MISDEEDS, &folder.0, Duration::from_secs(3));
        findings.sort_by_key(|(seed, _)| *seed);
        let expected = [
            (1, Finding::Crash { signal: 6 }),
            (2, Finding::Exit { code: 3 }),
            (3, Finding::Panic),
            (4, Finding::Print),
            (5, Finding::StandardInput),
            (5, Finding::Exit { code: 1 }),
            (6, Finding::Hang),
        ];
        let found =
            findings == expected && counts.cases == worker::MISDEEDS && folder.unexpected() == ["MUJOCO_LOG.TXT"];
        if !found {
            println!("the harness found {findings:?} in {} cases, and files {:?}", counts.cases, folder.unexpected());
        }
        found
    }

    pub fn run(self) -> ExitCode {
        let mut failed = false;
        println!("{}", Report::HEADING);
        for &(target, cases) in &self.cases {
            let report = self.run_target(target, cases);
            println!("{report}");
            failed |= report.is_bad();
        }
        if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
    }

    fn run_target(&self, target: Target, cases: u64) -> Report {
        let start = Instant::now();
        let seeds = self.first..self.first.saturating_add(cases);
        let next = Mutex::new(seeds.start);
        let batch_size = (cases / (4 * self.jobs as u64)).clamp(1, LARGEST_BATCH);
        let report = Mutex::new(Report::new(target));
        let folder = Folder::new(target.name());
        let bar = if self.progress { indicatif::ProgressBar::new(cases) } else { indicatif::ProgressBar::hidden() };
        let style = indicatif::ProgressStyle::with_template("{prefix:10} {bar:30} {pos}/{len} {eta} {msg}");
        bar.set_style(style.expect("the template is valid"));
        bar.set_prefix(target.name());
        std::thread::scope(|scope| {
            for _ in 0..self.jobs {
                scope.spawn(|| {
                    loop {
                        let batch = {
                            let mut next = next.lock().unwrap_or_else(PoisonError::into_inner);
                            let first = *next;
                            *next = seeds.end.min(first.saturating_add(batch_size));
                            first..*next
                        };
                        if batch.is_empty() {
                            break;
                        }
                        let (counts, findings) = run_batch(target.name(), batch.clone(), &folder.0, LONGEST_CASE);
                        let mut report = report.lock().unwrap_or_else(PoisonError::into_inner);
                        report.add(&counts, findings);
                        bar.inc(batch.end - batch.start);
                        bar.set_message(format!("{} findings", report.findings().len()));
                        if report.findings().len() > MOST_FINDINGS {
                            break;
                        }
                    }
                });
            }
        });
        bar.finish_and_clear();
        let mut report = report.into_inner().unwrap_or_else(PoisonError::into_inner);
        report.unexpected_files(folder.unexpected());
        report.seconds = start.elapsed().as_secs_f64();
        report
    }
}

/// An empty folder in which the children run, and in which only expected files may appear.
struct Folder(PathBuf);

impl Folder {
    fn new(target: &str) -> Self {
        let path = std::env::temp_dir().join(format!("mujoco_safe_fuzz_{target}_{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("no temporary folder");
        Self(path)
    }

    fn unexpected(&self) -> Vec<String> {
        let entries = self.0.read_dir().into_iter().flatten().flatten();
        entries.map(|entry| entry.file_name().display().to_string()).collect()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Runs the cases in as many children as necessary.
fn run_batch(target: &str, mut seeds: Range<u64>, folder: &Path, longest: Duration) -> (Counts, Vec<(u64, Finding)>) {
    let (mut counts, mut findings) = (Counts::default(), Vec::new());
    while !seeds.is_empty() && findings.len() < MOST_FINDINGS {
        let end =
            run_child(target, seeds.clone(), folder, longest, &mut counts, &mut findings).expect("no child process");
        seeds.start = end;
    }
    (counts, findings)
}

/// Runs cases in a child, and returns the first case that has not been run.
fn run_child(
    target: &str,
    seeds: Range<u64>,
    folder: &Path,
    longest: Duration,
    counts: &mut Counts,
    findings: &mut Vec<(u64, Finding)>,
) -> io::Result<u64> {
    // A byte that no case may read.
    let (stdin, mut writer) = io::pipe()?;
    writer.write_all(b"?")?;
    drop(writer);
    let mut unread = stdin.try_clone()?;

    let mut child = Command::new("sh")
        .args(["-c", &format!("ulimit -c 0; ulimit -v {MEMORY}; exec \"$0\" \"$@\" 2>&1")])
        .arg(std::env::current_exe()?)
        .args(["worker", target, &seeds.start.to_string(), &seeds.end.to_string()])
        .current_dir(folder)
        // A child that crashes leaves its temporary files.
        .env("TMPDIR", folder)
        // Simulations are created and freed all the time: their memory is not returned to the
        // system in between.
        .envs([("MALLOC_TRIM_THRESHOLD_", "268435456"), ("MALLOC_MMAP_THRESHOLD_", "33554432")])
        .stdin(stdin)
        .stdout(Stdio::piped())
        .spawn()?;
    let marks = marks(&mut child);
    let mut seed = seeds.start;
    let mut hangs = false;
    let mut slowest = Instant::now();
    while seed < seeds.end {
        match marks.recv_timeout(longest) {
            Ok(mark) => {
                match mark {
                    WORKED => counts.worked += 1,
                    REJECTED => counts.rejected += 1,
                    PANICKED => findings.push((seed, Finding::Panic)),
                    // The case printed to standard output or standard error.
                    _ => {
                        if findings.last() != Some(&(seed, Finding::Print)) {
                            findings.push((seed, Finding::Print));
                        }
                        continue;
                    }
                }
                counts.cases += 1;
                counts.slowest = counts.slowest.max((slowest.elapsed(), seed));
                slowest = Instant::now();
                seed += 1;
            }
            Err(RecvTimeoutError::Timeout) => {
                hangs = true;
                child.kill()?;
                break;
            }
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    let status = child.wait()?;
    let mut rest = Vec::new();
    unread.read_to_end(&mut rest)?;
    if rest != b"?" {
        findings.push((seed.min(seeds.end - 1), Finding::StandardInput));
    }
    if seed < seeds.end {
        counts.cases += 1;
        findings.push((seed, if hangs { Finding::Hang } else { end(status) }));
        seed += 1;
    } else if !status.success() {
        findings.push((seeds.end - 1, end(status)));
    }
    Ok(seed)
}

fn end(status: ExitStatus) -> Finding {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return Finding::Crash { signal };
    }
    Finding::Exit { code: status.code().unwrap_or(-1) }
}

/// Returns a channel of the bytes that the child writes.
fn marks(child: &mut Child) -> mpsc::Receiver<u8> {
    let mut output = child.stdout.take().expect("the child's output is a pipe");
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        let mut buffer = [0; 4096];
        while let Ok(length @ 1..) = output.read(&mut buffer) {
            if buffer[..length].iter().any(|&mark| sender.send(mark).is_err()) {
                break;
            }
        }
    });
    receiver
}
