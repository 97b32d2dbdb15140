//! The child: runs cases one after the other, and tells after each how it went.

use std::io::Write as _;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::fuzz::{Target, Verdict};

/// What a child writes to its standard output after a case.
pub const WORKED: u8 = 1;
pub const REFUSED: u8 = 2;
pub const PANICKED: u8 = 3;

pub fn work(target: Target, seeds: Range<u64>) {
    // Panics that are expected would fill the terminal.
    std::panic::set_hook(Box::new(|_| ()));
    let mut output = std::io::stdout().lock();
    for seed in seeds {
        let bytes = target.bytes(seed);
        let mark = match catch_unwind(AssertUnwindSafe(|| target.run(&bytes, &mut |_| ()))) {
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
