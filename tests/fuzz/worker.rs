//! The child process: runs cases one after another, and reports the result of each.

use std::collections::BTreeMap;
use std::io::{Read as _, Write as _};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use mujoco_safe::rayon::{ThreadPool, ThreadPoolBuilder};

use crate::fuzz::{self, Target, Verdict};

/// Bytes that a child writes to its standard output after a case.
pub const WORKED: u8 = 1;
pub const REJECTED: u8 = 2;
pub const PANICKED: u8 = 3;

/// Name of a target that misbehaves in every way, to test the detection.
pub const MISBEHAVE: &str = "misbehave";
/// Number of cases of that target.
pub const MISDEEDS: u64 = 8;

pub fn work(target: Target, seeds: Range<u64>) {
    let pools = Pools::new();
    pools.one.install(|| run(seeds, |seed| pools.run(target, seed, &mut |_| ())));
}

/// Pools for the calls that use all threads of the present pool.
struct Pools {
    one: ThreadPool,
    several: ThreadPool,
}

impl Pools {
    fn new() -> Self {
        let pool = |threads: usize| {
            let builder = ThreadPoolBuilder::new().num_threads(threads).stack_size(8 << 20);
            builder.build().expect("no threads")
        };
        Self { one: pool(1), several: pool(2) }
    }

    /// Runs a case in the present pool of one thread. Every 32nd case has several threads, which
    /// spend most of the time waiting for each other if other programs use the processors.
    fn run(&self, target: Target, seed: u64, log: &mut (dyn FnMut(&str) + Send)) -> Verdict {
        if seed.is_multiple_of(32) {
            self.several.install(|| target.run(&target.bytes(seed), log))
        } else {
            target.run(&target.bytes(seed), log)
        }
    }
}

pub fn misbehave(seeds: Range<u64>) {
    run(seeds, |seed| {
        match seed {
            1 => std::process::abort(),
            2 => std::process::exit(3),
            3 => panic!("on purpose"),
            4 => {
                print!("a");
                eprint!("b");
            }
            // The engine's reaction to an unhandled error.
            5 => {
                std::fs::write("MUJOCO_LOG.TXT", "ERROR").expect("a writable folder");
                std::io::stdin().read_exact(&mut [0]).expect("a byte");
                std::process::exit(1);
            }
            6 => std::thread::sleep(std::time::Duration::from_secs(600)),
            _ => {}
        }
        Verdict::Worked
    });
}

fn run(seeds: Range<u64>, case: impl Fn(u64) -> Verdict) {
    // Messages of expected panics would fill the terminal.
    std::panic::set_hook(Box::new(|_| ()));
    let mut output = std::io::stdout();
    for seed in seeds {
        let mark = match catch_unwind(AssertUnwindSafe(|| case(seed))) {
            Ok(Verdict::Worked) => WORKED,
            Ok(Verdict::Rejected) => REJECTED,
            Err(_) => PANICKED,
        };
        // The parent has ended.
        if output.write_all(&[mark]).and_then(|()| output.flush()).is_err() {
            return;
        }
    }
}

/// Repeats one case in this process, and prints its calls.
pub fn show(target: Target, seed: u64) {
    let pools = Pools::new();
    let verdict = pools.one.install(|| pools.run(target, seed, &mut |what| println!("{what}")));
    println!("{verdict:?}");
}

/// Makes the calls of seeds with the models of files, in this process. Prints each file, whether it
/// is a model, and the seeds that panic.
pub fn use_files(paths: &[&str], seeds: Range<u64>) {
    std::panic::set_hook(Box::new(|_| ()));
    let pools = Pools::new();
    for path in paths {
        let text = std::fs::read_to_string(path).expect("a text");
        print!("{path}:");
        let _ = std::io::stdout().flush();
        for seed in seeds.clone() {
            let case = || pools.one.install(|| fuzz::use_text(&text, seed, &mut |_| ()));
            match catch_unwind(AssertUnwindSafe(case)) {
                Ok(Verdict::Worked) => {}
                Ok(Verdict::Rejected) => {
                    print!(" rejected");
                    break;
                }
                Err(_) => print!(" panic with {seed}"),
            }
        }
        println!();
    }
}

/// Prints the time per model and per action, longest first. Runs in this process.
pub fn profile(target: Target, seeds: Range<u64>) {
    let pools = Pools::new();
    pools.one.install(|| measure(&pools, target, seeds));
}

fn measure(pools: &Pools, target: Target, seeds: Range<u64>) {
    let mut actions: BTreeMap<String, (Duration, u64)> = BTreeMap::new();
    let mut models: BTreeMap<String, (Duration, u64)> = BTreeMap::new();
    std::panic::set_hook(Box::new(|_| ()));
    for seed in seeds {
        let (first, mut last) = (Instant::now(), (String::from("start"), Instant::now()));
        let mut model = None;
        let _ = catch_unwind(AssertUnwindSafe(|| {
            pools.run(target, seed, &mut |what| {
                if what.starts_with(' ') {
                    return;
                }
                model.get_or_insert_with(|| what.to_owned());
                add(&mut actions, &last.0, last.1);
                last = (what.to_owned(), Instant::now());
            })
        }));
        add(&mut actions, &last.0, last.1);
        add(&mut models, model.as_deref().unwrap_or_default(), first);
    }
    for times in [models, actions] {
        let mut times: Vec<_> = times.into_iter().collect();
        times.sort_by_key(|(_, (duration, _))| std::cmp::Reverse(*duration));
        let total: Duration = times.iter().map(|(_, (duration, _))| *duration).sum();
        println!("{total:?}");
        for (name, (duration, count)) in times.iter().take(40) {
            println!(
                "{:6.2} % {count:8} × {:10.1?}  {name}",
                100.0 * duration.as_secs_f64() / total.as_secs_f64(),
                *duration / *count as u32
            );
        }
    }
}

fn add(times: &mut BTreeMap<String, (Duration, u64)>, name: &str, start: Instant) {
    let entry = times.entry(name.lines().next().unwrap_or_default().to_owned()).or_default();
    *entry = (entry.0 + start.elapsed(), entry.1 + 1);
}
