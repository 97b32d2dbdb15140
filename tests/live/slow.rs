//! Browsers that are slow or do not read.

use std::time::{Duration, Instant};

use tungstenite::Message;

use crate::browser::{Browser, ask};
use crate::requests::humanoid;

/// The slots are tested with held locks in `src/live/slots.rs`.
#[test]
fn the_simulation_goes_on_while_browsers_do_not_read() {
    let (mut data, mut page) = humanoid();
    let mut dead: Vec<Browser> = (0..4).map(|_| Browser::open(&page, &data)).collect();
    // More requests than the buffers of a connection have place for their answers. The server
    // reads no more when it cannot write.
    for browser in &mut dead {
        browser.socket.get_mut().set_write_timeout(Some(Duration::from_millis(50))).unwrap();
        while browser.socket.send(Message::text("\"next\"")).is_ok() {
            if data.time() > 0.5 {
                break;
            }
            page.exchange(&mut data).unwrap();
            data.step().unwrap();
        }
    }
    let mut longest = Duration::ZERO;
    for _ in 0..2000 {
        let start = Instant::now();
        page.exchange(&mut data).unwrap();
        longest = longest.max(start.elapsed());
        data.step().unwrap();
    }
    println!("longest exchange of 2000 with four browsers that do not read: {longest:?}");
    // Another browser receives the present state, not one from a queue.
    let mut browser = Browser::open(&page, &data);
    let (state, _) = ask(&mut page, &mut data, &mut browser, &[]);
    assert_eq!(state.time, data.time());
}

#[test]
fn a_slow_browser_receives_the_latest_state_only() {
    let (mut data, mut page) = humanoid();
    let mut browser = Browser::open(&page, &data);
    ask(&mut page, &mut data, &mut browser, &[]);
    for _ in 0..500 {
        page.exchange(&mut data).unwrap();
        data.step().unwrap();
    }
    let (state, _) = ask(&mut page, &mut data, &mut browser, &[]);
    assert_eq!(state.time, data.time());
}

#[test]
fn a_browser_without_a_simulation_receives_the_latest_state_again() {
    let (mut data, mut page) = humanoid();
    page.exchange(&mut data).unwrap();
    let mut browser = Browser::open(&page, &data);
    let first = browser.state();
    assert_eq!(browser.state(), first);
}
