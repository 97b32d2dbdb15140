//! Cost of a live page: a step after an exchange against [`Data::step`], from the same state under
//! the same random controls, for the standing humanoid; and a step of a batch of humanoids against
//! [`Batch::step`]. Without a browser, with one that requests states as fast as it may (125 per
//! second), and with another one that never reads.
//!
//! With browsers, the calling thread computes the poses of at most 125 states per second, for all
//! browsers together: 0.4 ms each for the batch. A browser that does not read adds none. The
//! threads of the server and of the browser here, which share the processors with the batch, need
//! about a third of that time.
//!
//! ```text
//! cargo bench --features live --bench live
//! ```

mod common;

use std::hint::black_box;
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use common::episode::Episode;
use mujoco_safe::live::{LiveOptions, LivePage};
use mujoco_safe::{Batch, Data, Result, sample};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

const STEPS: u32 = 100;

/// Number of simulations of the batch, all of which the page shows.
const COUNT: usize = 64;

/// Steps of the batch.
const BATCH_STEPS: u32 = 10;

fn main() -> Result<()> {
    let bind = |data: &Data| LivePage::bind(data.model(), &LiveOptions::default());
    let mut episode = Episode::new(Data::new(sample::humanoid())?, STEPS, bind)?;
    with_browsers(&mut episode, Episode::observer, |browser, episode| {
        let live = |episode: &mut Episode<LivePage>| {
            episode.run(|page, data| {
                black_box(page.exchange(data)?);
                data.step()
            });
        };
        let plain = |episode: &mut Episode<LivePage>| episode.run(|_, data| data.step());
        common::compare(&format!("live/{browser}"), episode, STEPS, &[("shown", &live), ("Data::step", &plain)]);
    });

    let batch = Batch::new(sample::humanoid(), COUNT)?;
    let page = LivePage::bind(batch.model(), &LiveOptions::default())?;
    with_browsers(
        &mut (batch, page),
        |(_, page)| page,
        |browser, subject| {
            let live = |(batch, page): &mut (Batch<'_>, LivePage)| {
                run(batch, |batch| {
                    black_box(page.exchange_batch(batch)?);
                    batch.step(|_, _| ())
                });
            };
            let plain = |(batch, _): &mut (Batch<'_>, LivePage)| run(batch, |batch| batch.step(|_, _| ()));
            let name = format!("live/batch, {browser}");
            common::compare(&name, subject, BATCH_STEPS, &[("shown", &live), ("Batch::step", &plain)]);
        },
    );
    Ok(())
}

/// Runs the steps of a batch from the standing humanoid.
fn run<'m>(batch: &mut Batch<'m>, mut step: impl FnMut(&mut Batch<'m>) -> Result<()>) {
    batch.reset_where(|_| true, |_, _, data| data.reset_to_key("stand")).expect("a known key");
    for _ in 0..BATCH_STEPS {
        step(batch).expect("the simulations are stable");
    }
}

/// Compares without a browser, with one, and with another one that never reads.
fn with_browsers<S>(subject: &mut S, page: impl Fn(&S) -> &LivePage, compare: impl Fn(&str, &mut S)) {
    compare("no browser", subject);
    let mut reading = open(page(subject));
    let is_ended = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            while !is_ended.load(Ordering::Relaxed) && reading.send(Message::text("\"next\"")).is_ok() {
                let _ = reading.read();
            }
        });
        compare("one browser", subject);
        let mut dead = open(page(subject));
        while dead.send(Message::text("\"next\"")).is_ok() {}
        compare("and one that never reads", subject);
        is_ended.store(true, Ordering::Relaxed);
    });
}

fn open(page: &LivePage) -> WebSocket<TcpStream> {
    let url = format!("{}/live", page.url().replacen("http", "ws", 1));
    let mut request = url.into_client_request().expect("a valid address");
    let origin = format!("http://{}", page.address()).parse().expect("a valid origin");
    request.headers_mut().insert("origin", origin);
    let stream = TcpStream::connect(page.address()).expect("a running server");
    stream.set_write_timeout(Some(std::time::Duration::from_millis(100))).expect("a valid time");
    tungstenite::client(request, stream).expect("an accepted handshake").0
}
