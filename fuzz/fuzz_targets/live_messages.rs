//! Messages to a live page, a line each, and steps of its simulation.

#![no_main]

use std::cell::RefCell;
use std::net::TcpStream;
use std::thread;
use std::time::Duration;

use mujoco_safe::live::{LiveOptions, LivePage};
use mujoco_safe::{Data, sample};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

thread_local! {
    static SIMULATION: RefCell<(Data, LivePage)> = RefCell::new({
        let data = Data::new(sample::humanoid()).unwrap();
        let page = LivePage::bind(data.model(), &LiveOptions::default()).unwrap();
        (data, page)
    });
}

fn connect(page: &LivePage) -> WebSocket<TcpStream> {
    let mut request = format!("{}/live", page.url().replacen("http", "ws", 1)).into_client_request().unwrap();
    request.headers_mut().insert("origin", format!("http://{}", page.address()).parse().unwrap());
    let stream = TcpStream::connect(page.address()).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
    tungstenite::client(request, stream).unwrap().0
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    SIMULATION.with_borrow_mut(|(data, page)| {
        let mut browser = connect(page);
        for line in bytes.split(|&byte| byte == b'\n').take(20) {
            let sent = match std::str::from_utf8(line) {
                Ok(text) => browser.send(Message::text(text)),
                Err(_) => browser.send(Message::binary(line.to_vec())),
            };
            if sent.is_err() {
                break;
            }
        }
        // The server reads the messages in their order, unless one of them is wrong.
        let _ = browser.send(Message::text("\"next\""));
        let is_answered = thread::scope(|scope| {
            let answer = scope.spawn(|| browser.read().is_ok_and(|message| message.is_binary()));
            while !answer.is_finished() {
                if page.exchange(data).unwrap().advance {
                    // A pull may be so strong that the simulation fails.
                    let _ = data.step();
                }
                thread::sleep(Duration::from_micros(200));
            }
            answer.join().unwrap()
        });
        assert!(data.ctrl().iter().all(|ctrl| (-1.0..=1.0).contains(ctrl)), "a control is out of its range");
        let _ = browser.close(None);
        // A new simulation after a failure.
        if !is_answered || data.qpos().iter().any(|position| !position.is_finite()) {
            let _ = data.reset();
        }
    });
});
