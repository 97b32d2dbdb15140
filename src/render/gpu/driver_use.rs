//! Uses of the graphics driver, for which the end of the process waits.
//!
//! A graphics driver frees its static data in exit handlers. A thread that still runs code of the
//! driver would then read freed memory. The end of the process therefore waits until no other
//! thread uses the driver. From then on, no other thread begins to use it.

use std::cell::Cell;
use std::marker::PhantomData;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use crate::ffi::at_exit;

/// Longest time for which the end of the process waits: several frames of a slow driver.
const EXIT_TIMEOUT: Duration = Duration::from_secs(10);

struct Uses {
    /// Number of uses in progress.
    active: usize,
    /// Number of uses that have ended.
    ended: u64,
    /// Value of `ended` at which the exit handler is registered again.
    next_registration: u64,
    /// The process ends.
    exiting: bool,
    /// Asks the owners of long uses to end them.
    request_end: Option<fn()>,
}

static USES: Mutex<Uses> =
    Mutex::new(Uses { active: 0, ended: 0, next_registration: 1, exiting: false, request_end: None });
/// Notified when a use ends.
static ENDED: Condvar = Condvar::new();

thread_local! {
    /// Number of uses in progress by this thread.
    static OWN: Cell<usize> = const { Cell::new(0) };
}

fn uses() -> MutexGuard<'static, Uses> {
    USES.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Uses {
    fn begin(&mut self) {
        self.active += 1;
        OWN.set(OWN.get() + 1);
    }

    fn end(&mut self) {
        self.active -= 1;
        OWN.set(OWN.get() - 1);
        self.ended += 1;
        // Exit handlers run in reverse order, so this one is registered after the driver's. The
        // driver's shader compiler registers further ones when it first needs them, so the
        // registration is repeated, at intervals that grow.
        if self.ended >= self.next_registration {
            self.next_registration = self.ended + self.ended / 8 + 1;
            at_exit(wait_at_exit);
        }
        ENDED.notify_all();
    }
}

/// Exit handler that waits until no other thread uses the driver.
extern "C" fn wait_at_exit() {
    let mut uses = self::uses();
    uses.exiting = true;
    // This use never ends: exit handlers that this thread runs later may use the driver.
    uses.begin();
    if let Some(request_end) = uses.request_end {
        drop(uses);
        request_end();
        uses = self::uses();
    }
    let own = OWN.get();
    let _ = ENDED.wait_timeout_while(uses, EXIT_TIMEOUT, |uses| uses.active > own);
}

/// A use of the graphics driver by the current thread, which lasts until the drop. A thread can
/// have several at a time.
pub(crate) struct DriverUse {
    /// The uses of each thread are counted, so this type is neither `Send` nor `Sync`.
    thread: PhantomData<*const ()>,
}

impl DriverUse {
    /// Begins a use. While the process ends, this function does not return, except in a thread that
    /// has a use already and in the thread that ends the process.
    pub(crate) fn begin() -> Self {
        let mut uses = uses();
        if uses.exiting && OWN.get() == 0 {
            drop(uses);
            loop {
                thread::park();
            }
        }
        uses.begin();
        Self { thread: PhantomData }
    }

    /// Begins a long use, such as an open window. At the end of the process, `request_end` is
    /// called, which asks the owners of all long uses to end them. Returns `None` if the process is
    /// ending.
    #[cfg(feature = "viewer")]
    pub(crate) fn begin_long(request_end: fn()) -> Option<Self> {
        let driver_use = Self::begin();
        let mut uses = uses();
        uses.request_end = Some(request_end);
        let is_allowed = !uses.exiting;
        drop(uses);
        is_allowed.then_some(driver_use)
    }
}

impl Drop for DriverUse {
    fn drop(&mut self) {
        uses().end();
    }
}

/// Use of the driver by the destructor of a value: its last field, which is dropped after all
/// others. The destructor calls [`begin`](Self::begin).
#[derive(Default)]
pub(crate) struct DropUse {
    has_begun: bool,
}

impl DropUse {
    pub(crate) fn begin(&mut self) {
        std::mem::forget(DriverUse::begin());
        self.has_begun = true;
    }
}

impl Drop for DropUse {
    fn drop(&mut self) {
        if self.has_begun {
            uses().end();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::{self, Write};
    use std::process::Command;
    use std::sync::mpsc;
    use std::thread;
    use std::time::Duration;

    use super::{DriverUse, DropUse, uses};

    const TEST: &str = "render::gpu::driver_use::tests::the_end_of_the_process_waits_for_uses";
    const IS_CHILD: &str = "MUJOCO_SAFE_TEST_CHILD";

    /// Says when it is dropped.
    struct Resource;

    impl Drop for Resource {
        fn drop(&mut self) {
            say("a use begins too late");
        }
    }

    struct Owner {
        _resource: Resource,
        drop_use: DropUse,
    }

    impl Drop for Owner {
        fn drop(&mut self) {
            self.drop_use.begin();
        }
    }

    #[test]
    fn the_end_of_the_process_waits_for_uses() {
        if std::env::var_os(IS_CHILD).is_some() {
            exit_during_a_use();
        }
        let mut command = Command::new(std::env::current_exe().unwrap());
        let output = command.args([TEST, "--exact", "--nocapture"]).env(IS_CHILD, "1").output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{text}");
        assert!(text.contains("the use ends"), "{text}");
        assert!(!text.contains("too late"), "{text}");
    }

    fn exit_during_a_use() -> ! {
        // The end of a use registers the exit handler.
        drop(DriverUse::begin());
        let (started, wait) = mpsc::channel();
        thread::spawn(move || {
            let _driver_use = DriverUse::begin();
            started.send(()).unwrap();
            wait_until_exiting();
            // The other thread tries to destroy its resource.
            thread::sleep(Duration::from_millis(100));
            say("the use ends");
        });
        wait.recv().unwrap();
        thread::spawn(|| {
            let owner = Owner { _resource: Resource, drop_use: DropUse::default() };
            wait_until_exiting();
            drop(owner);
        });
        std::process::exit(0)
    }

    fn wait_until_exiting() {
        while !uses().exiting {
            thread::sleep(Duration::from_millis(1));
        }
    }

    fn say(text: &str) {
        println!("{text}");
        io::stdout().flush().unwrap();
    }
}
