//! The child process: runs cases one after another, and reports the result of each.

use std::io::{Read as _, Write as _};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::fuzz::{Target, Verdict};

/// Bytes that a child writes to its standard output after a case.
pub const WORKED: u8 = 1;
pub const REJECTED: u8 = 2;
pub const PANICKED: u8 = 3;

/// Name of a target that misbehaves in every way, to test the detection.
pub const MISBEHAVE: &str = "misbehave";
/// Number of cases of that target.
pub const MISDEEDS: u64 = 8;

pub fn work(target: Target, seeds: Range<u64>) {
    run(seeds, |seed| target.run(&target.bytes(seed), &mut |_| ()));
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
    let verdict = target.run(&target.bytes(seed), &mut |what| println!("{what}"));
    println!("{verdict:?}");
}
