//! Requests, handshakes and messages that the server refuses.

use std::io::{Read, Write};
use std::time::Duration;

use mujoco_safe::live::{LiveOptions, LivePage};
use mujoco_safe::{Data, Model, sample};
use tungstenite::Message;
use tungstenite::protocol::frame::coding::CloseCode;

use crate::browser::{Browser, ask, connection, raw};
use crate::requests::humanoid;

fn token(page: &LivePage) -> String {
    page.url().rsplit('/').next().unwrap().to_owned()
}

/// Returns the head of a request. `{}` in the values are the address of the server.
fn head(page: &LivePage, path: &str, headers: &[(&str, &str)]) -> String {
    let address = page.address().to_string();
    let lines: Vec<String> =
        headers.iter().map(|(name, value)| format!("{name}: {}\r\n", value.replace("{}", &address))).collect();
    format!("GET {path} HTTP/1.1\r\n{}\r\n", lines.concat())
}

const HANDSHAKE: [(&str, &str); 4] = [
    ("Connection", "Upgrade"),
    ("Upgrade", "websocket"),
    ("Sec-WebSocket-Version", "13"),
    ("Sec-WebSocket-Key", "dGhlIHNhbXBsZSBub25jZQ=="),
];

fn handshake(page: &LivePage, host: &str, origin: Option<&str>) -> String {
    let mut headers = HANDSHAKE.to_vec();
    headers.push(("Host", host));
    headers.extend(origin.map(|origin| ("Origin", origin)));
    let answer = raw_until_head(page, &head(page, &format!("/{}/live", token(page)), &headers));
    answer.lines().next().unwrap_or_default().to_owned()
}

/// Returns the head of the answer. The connection of an accepted handshake does not end.
fn raw_until_head(page: &LivePage, request: &str) -> String {
    let mut stream = connection(page);
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = Vec::new();
    while !answer.ends_with(b"\r\n\r\n") {
        let mut byte = [0];
        if stream.read(&mut byte).unwrap_or(0) == 0 {
            break;
        }
        answer.push(byte[0]);
    }
    String::from_utf8(answer).unwrap()
}

#[test]
fn the_page_needs_the_token() {
    let (_, page) = humanoid();
    let token = token(&page);
    assert!(token.len() == 32 && token.bytes().all(|byte| byte.is_ascii_hexdigit()), "{token}");
    let other = LivePage::bind(sample::cartpole(), &LiveOptions::default()).unwrap();
    assert_ne!(token, self::token(&other), "tokens are random");
    let get = |path: &str| raw(&page, head(&page, path, &[("Host", "{}")]).as_bytes());
    for path in [format!("/{token}"), format!("/{token}/"), format!("/{token}?x=1")] {
        let answer = get(&path);
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        assert!(head.starts_with("HTTP/1.1 200 OK"), "{path}: {head}");
        for line in ["Cache-Control: no-store", "frame-ancestors 'none'", "Referrer-Policy: no-referrer", "nosniff"] {
            assert!(head.contains(line), "{line}: {head}");
        }
        assert!(head.contains(&format!("Content-Length: {}\r\n", body.len())));
        assert!(
            body.contains("default-src 'none'; connect-src 'self'; img-src data:; script-src 'sha256-"),
            "the policy"
        );
        assert!(body.ends_with("</html>\n") && !body.contains(&token));
    }
    let almost = format!("/{}{}", &token[..31], if token.ends_with('0') { '1' } else { '0' });
    let upper = format!("/{}", token.to_uppercase());
    let is_same = token == token.to_uppercase();
    for path in
        ["/", "/favicon.ico", "/live", "//", &token[..31], &almost, &format!("/{token}0"), &format!("/x/{token}")]
    {
        let path = if path.starts_with('/') { path.to_owned() } else { format!("/{path}") };
        let answer = get(&path);
        assert!(answer.starts_with("HTTP/1.1 403 ") && answer.contains("token"), "{path}: {answer}");
    }
    assert!(is_same || get(&upper).starts_with("HTTP/1.1 403 "));
    assert!(get(&format!("/{token}/etc/passwd")).starts_with("HTTP/1.1 404 "));
}

#[test]
fn other_names_of_the_server_are_refused() {
    let mut options = LiveOptions::default();
    options.hosts.push("robot.lan".to_owned());
    let page = LivePage::bind(sample::cartpole(), &options).unwrap();
    let path = format!("/{}", token(&page));
    let get = |headers: &[(&str, &str)]| raw(&page, head(&page, &path, headers).as_bytes());
    for host in ["{}", "localhost:9000", "[::1]:9000", "127.0.0.1", "robot.lan:80"] {
        assert!(get(&[("Host", host)]).starts_with("HTTP/1.1 200 "), "{host}");
    }
    for host in ["evil.example", "127.0.0.1.evil.example:80", "robot.lan.evil.example", "", "localhost:x"] {
        assert!(get(&[("Host", host)]).starts_with("HTTP/1.1 403 "), "{host}");
        // A name that leads here by DNS rebinding has the origin of its page.
        let origin = format!("http://{host}");
        assert!(handshake(&page, host, Some(&origin)).starts_with("HTTP/1.1 403 "), "{host}");
    }
    assert!(get(&[]).starts_with("HTTP/1.1 400 "), "a request has a host");
    assert!(get(&[("Host", "{}"), ("Host", "evil.example")]).starts_with("HTTP/1.1 400 "));
}

#[test]
fn other_origins_cannot_connect() {
    let (_, page) = humanoid();
    for (host, origin) in
        [("{}", "http://{}"), ("localhost:9000", "http://localhost:9000"), ("localhost:9000", "https://localhost:9000")]
    {
        assert!(handshake(&page, host, Some(origin)).starts_with("HTTP/1.1 101 "), "{origin}");
    }
    for origin in [
        "http://evil.example",
        "null",
        "",
        "{}",
        "http://localhost:1",
        "http://{}.evil.example",
        "http://evil.example/{}",
        "file://",
        "ws://{}",
    ] {
        assert!(handshake(&page, "{}", Some(origin)).starts_with("HTTP/1.1 403 "), "{origin}");
    }
    assert!(handshake(&page, "{}", None).starts_with("HTTP/1.1 403 "), "browsers send an origin");
    let twice = [&HANDSHAKE[..], &[("Host", "{}"), ("Origin", "http://{}"), ("Origin", "http://{}")]].concat();
    let path = format!("/{}/live", token(&page));
    assert!(raw_until_head(&page, &head(&page, &path, &twice)).starts_with("HTTP/1.1 400 "));
    let without_key = [&HANDSHAKE[..3], &[("Host", "{}"), ("Origin", "http://{}")]].concat();
    assert!(raw_until_head(&page, &head(&page, &path, &without_key)).starts_with("HTTP/1.1 400 "));
    let wrong_token = [&HANDSHAKE[..], &[("Host", "{}"), ("Origin", "http://{}")]].concat();
    assert!(raw_until_head(&page, &head(&page, "/0123/live", &wrong_token)).starts_with("HTTP/1.1 403 "));
}

#[test]
fn malformed_requests_are_refused() {
    let (_, page) = humanoid();
    let post = head(&page, &format!("/{}", token(&page)), &[("Host", "{}")]).replacen("GET", "POST", 1);
    assert!(raw(&page, post.as_bytes()).starts_with("HTTP/1.1 405 "));
    let version = head(&page, &format!("/{}", token(&page)), &[("Host", "{}")]).replacen("HTTP/1.1", "HTTP/1.0", 1);
    assert!(raw(&page, version.as_bytes()).starts_with("HTTP/1.1 400 "));
    for bytes in [
        &b"\r\n\r\n\xff"[..],
        b"GET\r\n\r\n",
        b"\0\xff\xfe\r\n\r\n",
        b"GET / HTTP/1.1\r\n: x\r\n\r\n",
        b"GET http://a:b:c HTTP/1.1\r\nHost: localhost\r\n\r\n",
    ] {
        assert!(raw(&page, bytes).starts_with("HTTP/1.1 400 "), "{bytes:?}");
    }
    let many: Vec<(String, &str)> = (0..100).map(|index| (format!("X{index}"), "1")).collect();
    let many: Vec<(&str, &str)> = many.iter().map(|(name, value)| (&**name, *value)).collect();
    assert!(raw(&page, head(&page, "/", &many).as_bytes()).starts_with("HTTP/1.1 400 "));
    let long = "a".repeat(100_000);
    assert!(raw(&page, format!("GET /{long}").as_bytes()).starts_with("HTTP/1.1 431 "));
}

#[test]
fn an_unfinished_request_ends_after_a_time() {
    let (_, page) = humanoid();
    assert!(raw(&page, b"GET / HTTP/1.1\r\n").starts_with("HTTP/1.1 408 "));
}

#[test]
fn wrong_messages_end_the_connection_without_an_effect() {
    let (mut data, mut page) = humanoid();
    page.exchange(&mut data).unwrap();
    let before = data.state(mujoco_safe::StateSpec::INTEGRATION);
    for (text, reason) in [
        ("", "a message"),
        ("garbage", "a message"),
        (r#"{"hold":[21,0]}"#, "below 21"),
        (r#"{"hold":[0,1e9]}"#, "control 0"),
        (r#"{"hold":[0,NaN]}"#, "a message"),
        (r#"{"hold":[0,1e999]}"#, "a message"),
        (r#"{"pull":{"body":99,"point":[0,0,0],"target":[0,0,0]}}"#, "the body of a pull"),
        (r#"{"step":4000000000}"#, "the number of steps"),
    ] {
        let mut browser = Browser::open(&page, &data);
        browser.send(text);
        let (code, found) = browser.end().unwrap();
        assert_eq!(code, CloseCode::Policy);
        assert!(found.contains(reason), "{text}: {found}");
    }
    let mut browser = Browser::open(&page, &data);
    browser.socket.send(Message::binary(vec![0; 10])).unwrap();
    assert_eq!(browser.end().unwrap().0, CloseCode::Policy);
    let mut browser = Browser::open(&page, &data);
    browser.send(&format!("\"{}\"", "a".repeat(2000)));
    assert_eq!(browser.end().unwrap().0, CloseCode::Size);
    let tick = page.exchange(&mut data).unwrap();
    assert!(tick.advance && !tick.reset);
    assert_eq!(data.state(mujoco_safe::StateSpec::INTEGRATION), before);
    // The server still works.
    let mut browser = Browser::open(&page, &data);
    ask(&mut page, &mut data, &mut browser, &[]);
}

#[test]
fn wrong_frames_end_the_connection() {
    let (mut data, mut page) = humanoid();
    for bytes in [
        &[0xff; 32][..],
        b"\x81\x04next",                                     // without a mask
        b"\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xff\0\0\0\0", // 2^63 bytes
        b"\x81\xfe\xff\xff\0\0\0\0",                         // 65535 bytes
        b"\x81\x82\0\0\0\0\xff\xfe",                         // no UTF-8
        b"\x80\x81\0\0\0\0a",                                // a continuation of nothing
    ] {
        let mut browser = Browser::open(&page, &data);
        browser.socket.get_mut().write_all(bytes).unwrap();
        browser.end();
    }
    // A message in fragments has the same limit.
    let mut browser = Browser::open(&page, &data);
    let stream = browser.socket.get_mut();
    stream.write_all(b"\x01\x81\0\0\0\0\"").unwrap();
    for _ in 0..2000 {
        if stream.write_all(b"\x00\x81\0\0\0\0a").is_err() {
            break;
        }
    }
    browser.end();
    let mut browser = Browser::open(&page, &data);
    ask(&mut page, &mut data, &mut browser, &[]);
}

#[test]
fn the_number_of_browsers_is_limited() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut page = LivePage::bind(data.model(), &LiveOptions::default().with_clients(2)).unwrap();
    let mut browsers = [Browser::open(&page, &data), Browser::open(&page, &data)];
    assert!(handshake(&page, "{}", Some("http://{}")).starts_with("HTTP/1.1 503 "));
    for browser in &mut browsers {
        ask(&mut page, &mut data, browser, &[]);
    }
    drop(browsers);
    while page.browsers() > 0 {
        std::thread::yield_now();
    }
    let mut browser = Browser::open(&page, &data);
    ask(&mut page, &mut data, &mut browser, &[]);
}

#[test]
fn many_idle_connections_do_not_disturb_a_browser() {
    let (mut data, mut page) = humanoid();
    let mut browser = Browser::open(&page, &data);
    let idle: Vec<_> = (0..200).map(|_| connection(&page)).collect();
    for _ in 0..20 {
        ask(&mut page, &mut data, &mut browser, &[]);
        data.step().unwrap();
    }
    drop(idle);
    // The server has closed those above the limit, and serves new ones.
    let path = format!("/{}", token(&page));
    while !raw(&page, head(&page, &path, &[("Host", "{}")]).as_bytes()).starts_with("HTTP/1.1 200 ") {
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn names_of_a_model_are_only_in_the_encoded_data() {
    let hostile = "</script><script>alert(1)</script>";
    let escaped = hostile.replace('<', "&lt;");
    let model = Model::from_xml_str(&format!(
        "<mujoco><worldbody><body name=\"{escaped}\"><joint name=\"j\"/><geom size='1'/></body></worldbody>
           <actuator><motor name=\"{escaped}\" joint=\"j\"/></actuator></mujoco>"
    ))
    .unwrap();
    let page = LivePage::bind(model, &LiveOptions::default()).unwrap();
    let text = raw(&page, head(&page, &format!("/{}", token(&page)), &[("Host", "{}")]).as_bytes());
    assert!(text.starts_with("HTTP/1.1 200 ") && !text.contains(hostile));
    assert_eq!(text.matches("<script").count(), 3, "the program, the data and the loader");
}
