//! Cost of a live page: a step after an exchange against [`Data::step`], from the same state under
//! the same random controls, for the standing humanoid. Without a browser, with one that requests
//! states as fast as it may (125 per second), and with one that never reads.
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
use mujoco_safe::{Data, Result, sample};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

const STEPS: u32 = 100;

fn main() -> Result<()> {
    let bind = |data: &Data| LivePage::bind(data.model(), &LiveOptions::default());
    let mut episode = Episode::new(Data::new(sample::humanoid())?, STEPS, bind)?;
    let compare = |browser: &str, episode: &mut Episode<LivePage>| {
        let live = |episode: &mut Episode<LivePage>| {
            episode.run(|page, data| {
                black_box(page.exchange(data)?);
                data.step()
            });
        };
        let plain = |episode: &mut Episode<LivePage>| episode.run(|_, data| data.step());
        common::compare(&format!("live/{browser}"), episode, STEPS, &[("shown", &live), ("Data::step", &plain)]);
    };
    compare("no browser", &mut episode);
    let mut reading = open(episode.observer());
    let is_ended = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            while !is_ended.load(Ordering::Relaxed) && reading.send(Message::text("\"next\"")).is_ok() {
                let _ = reading.read();
            }
        });
        compare("one browser", &mut episode);
        let mut dead = open(episode.observer());
        while dead.send(Message::text("\"next\"")).is_ok() {}
        compare("and one that never reads", &mut episode);
        is_ended.store(true, Ordering::Relaxed);
    });
    Ok(())
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
