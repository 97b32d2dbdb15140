//! A client as a browser is one, with an independent reader of states.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::thread;
use std::time::Duration;

use mujoco_safe::Data;
use mujoco_safe::live::{LivePage, Tick};
use tungstenite::client::IntoClientRequest;
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::{Error, Message, WebSocket};

/// So that a failure does not block the tests.
const TIMEOUT: Duration = Duration::from_secs(60);

pub struct Browser {
    pub socket: WebSocket<TcpStream>,
    frames: usize,
    controls: usize,
    /// Number of deformable shapes.
    deformables: usize,
}

/// A state that a browser received.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    pub time: f64,
    pub is_paused: bool,
    pub is_batch: bool,
    /// Positions and quaternions of the frames.
    pub poses: Vec<[f32; 7]>,
    /// Times and poses of further simulations.
    pub ghosts: Vec<(f64, Vec<[f32; 7]>)>,
    pub vertices: Vec<Vec<[f32; 3]>>,
    pub ctrl: Vec<f32>,
    pub held: Vec<u8>,
    pub problem: String,
}

impl Browser {
    /// Connects as the page does.
    pub fn open(page: &LivePage, data: &Data) -> Self {
        let request = format!("{}/live", page.url().replacen("http", "ws", 1));
        let mut request = request.into_client_request().unwrap();
        let origin = format!("http://{}", page.address());
        request.headers_mut().insert("origin", origin.parse().unwrap());
        let (socket, _) = tungstenite::client(request, connection(page)).unwrap();
        // Cameras and lights that track a body have frames of their own.
        let model = data.model();
        let moving = model.cam_mode().iter().chain(model.light_mode()).filter(|&&mode| mode != 0).count();
        let deformables = model.ntendon() + model.nskin();
        Self { socket, frames: model.nbody() + moving, controls: model.nu(), deformables }
    }

    pub fn send(&mut self, text: &str) {
        self.socket.send(Message::text(text)).unwrap();
    }

    /// Requests a state and waits for it, while another thread exchanges.
    pub fn state(&mut self) -> State {
        self.send("\"next\"");
        let bytes = self.socket.read().unwrap().into_data();
        let mut bytes = &bytes[..];
        let flags = u32::from_le_bytes(take(&mut bytes));
        assert!(flags < 4, "{flags}");
        let count = u32::from_le_bytes(take(&mut bytes));
        let times: Vec<f64> = (0..count).map(|_| f64::from_le_bytes(take(&mut bytes))).collect();
        let mut number = || f32::from_le_bytes(take(&mut bytes));
        let mut simulations = times.into_iter().map(|time| {
            let poses: Vec<[f32; 7]> = (0..self.frames).map(|_| std::array::from_fn(|_| number())).collect();
            (time, poses)
        });
        let (time, poses) = simulations.next().unwrap();
        let ghosts = simulations.collect();
        let ctrl = (0..self.controls).map(|_| number()).collect();
        let vertices = (0..self.deformables)
            .map(|_| {
                let count = u32::from_le_bytes(take(&mut bytes));
                (0..count).map(|_| std::array::from_fn(|_| f32::from_le_bytes(take(&mut bytes)))).collect()
            })
            .collect();
        let (held, problem) = bytes.split_at(self.controls);
        let problem = std::str::from_utf8(problem).unwrap().to_owned();
        let (is_paused, is_batch) = (flags & 1 != 0, flags & 2 != 0);
        State { time, is_paused, is_batch, poses, ghosts, vertices, ctrl, held: held.to_vec(), problem }
    }

    /// Returns the code and the reason with which the server ends the connection, which may have
    /// sent states before.
    pub fn end(&mut self) -> Option<(CloseCode, String)> {
        loop {
            match self.socket.read() {
                Ok(Message::Close(frame)) => return frame.map(|frame| (frame.code, frame.reason.to_string())),
                Ok(_) => {}
                Err(Error::Io(error)) if error.kind() == std::io::ErrorKind::WouldBlock => {
                    panic!("the server does not end the connection")
                }
                Err(_) => return None,
            }
        }
    }
}

fn take<const N: usize>(bytes: &mut &[u8]) -> [u8; N] {
    let (first, rest) = bytes.split_first_chunk().unwrap();
    *bytes = rest;
    *first
}

/// Sends messages, and exchanges until the simulation has carried them out. Returns the state that
/// a browser then receives, and the ticks.
pub fn ask(page: &mut LivePage, data: &mut Data, browser: &mut Browser, messages: &[&str]) -> (State, Vec<Tick>) {
    ask_in(browser, messages, || page.exchange(data).unwrap())
}

/// As [`ask`], with any function that exchanges.
pub fn ask_in(browser: &mut Browser, messages: &[&str], mut exchange: impl FnMut() -> Tick) -> (State, Vec<Tick>) {
    for text in messages {
        browser.send(text);
    }
    let mut ticks = Vec::new();
    let state = thread::scope(|scope| {
        // The server reads the messages before it answers the first request, and the simulation
        // takes them before the state of the second.
        let state = scope.spawn(|| {
            browser.state();
            browser.state()
        });
        while !state.is_finished() {
            ticks.push(exchange());
            thread::sleep(Duration::from_micros(200));
        }
        state.join().unwrap()
    });
    (state, ticks)
}

pub fn connection(page: &LivePage) -> TcpStream {
    let stream = TcpStream::connect(page.address()).unwrap();
    stream.set_read_timeout(Some(TIMEOUT)).unwrap();
    stream
}

/// Sends bytes and returns the answer.
pub fn raw(page: &LivePage, bytes: &[u8]) -> String {
    let mut stream = connection(page);
    // The server may have answered before it has read everything.
    let _ = stream.write_all(bytes);
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    String::from_utf8(answer).unwrap()
}
