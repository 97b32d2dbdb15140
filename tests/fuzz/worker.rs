//! The child: runs cases one after the other, and tells after each how it went.

use std::io::{Read as _, Write as _};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::fuzz::{Target, Verdict};

/// What a child writes to its standard output after a case.
pub const WORKED: u8 = 1;
pub const REFUSED: u8 = 2;
pub const PANICKED: u8 = 3;

/// The name of a target that does all that a child must not do, to see that it is found.
pub const MISBEHAVE: &str = "misbehave";
/// How many cases it has.
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
            // What the engine does with an error that no one handles.
            5 => {
                std::fs::write("MUJOCO_LOG.TXT", "ERROR").expect("the folder is there");
                std::io::stdin().read_exact(&mut [0]).expect("there is a byte");
                std::process::exit(1);
            }
            6 => std::thread::sleep(std::time::Duration::from_secs(600)),
            _ => {}
        }
        Verdict::Worked
    });
}

fn run(seeds: Range<u64>, case: impl Fn(u64) -> Verdict) {
    // Panics that are expected would fill the terminal.
    std::panic::set_hook(Box::new(|_| ()));
    let mut output = std::io::stdout();
    for seed in seeds {
        let mark = match catch_unwind(AssertUnwindSafe(|| case(seed))) {
            Ok(Verdict::Worked) => WORKED,
            Ok(Verdict::Refused) => REFUSED,
            Err(_) => PANICKED,
        };
        // The parent has gone.
        if output.write_all(&[mark]).and_then(|()| output.flush()).is_err() {
            return;
        }
    }
}

/// Repeats one case in this process, and says what it does.
pub fn show(target: Target, seed: u64) {
    let verdict = target.run(&target.bytes(seed), &mut |what| println!("{what}"));
    println!("{verdict:?}");
}
