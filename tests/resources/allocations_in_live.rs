//! The ticks of a live page do not allocate.
#![forbid(unsafe_code)]
#![cfg(all(target_os = "linux", target_env = "gnu"))]

use std::net::TcpStream;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use mujoco_safe::live::{LiveOptions, LivePage};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Error, Message};

use crate::allocations::squatting;
use crate::allocator::allocations;
use crate::lock_process;

#[test]
fn a_tick_of_a_live_page_does_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    let mut page = LivePage::bind(data.model(), &LiveOptions::default()).unwrap();
    let mut request = format!("{}/live", page.url().replacen("http", "ws", 1)).into_client_request().unwrap();
    request.headers_mut().insert("origin", format!("http://{}", page.address()).parse().unwrap());
    let stream = TcpStream::connect(page.address()).unwrap();
    let (mut browser, _) = tungstenite::client(request, stream).unwrap();
    // Every request is carried out: a hold, a pull whose target moves, and a reset now and then.
    let received = AtomicUsize::new(0);
    thread::scope(|scope| {
        let received = &received;
        scope.spawn(move || -> Result<(), Error> {
            for number in 0.. {
                let x = f64::from(number % 10) / 10.0;
                browser.send(Message::text(format!(r#"{{"hold":[1,{x}]}}"#)))?;
                let pull = format!(r#"{{"pull":{{"body":2,"point":[0,0,0],"target":[{x},0,1]}}}}"#);
                browser.send(Message::text(pull))?;
                if number % 5 == 4 {
                    browser.send(Message::text("\"reset\""))?;
                }
                browser.send(Message::text("\"next\""))?;
                browser.read()?;
                received.store(number as usize + 1, Ordering::Release);
            }
            Ok(())
        });
        let mut run = |until: usize| {
            while received.load(Ordering::Acquire) < until {
                if page.exchange(&mut data).unwrap().advance {
                    data.step().unwrap();
                }
            }
        };
        run(20);
        let (number, ()) = allocations(|| run(60));
        drop(page);
        assert_eq!(number, 0, "allocations while a browser receives 40 states");
    });
}
