//! Messages of a browser, and their checks.

use serde::Deserialize;

use crate::error::{Error, InvalidKind, Result};

/// Largest absolute value of a coordinate and of a control without a range. The engine itself
/// rejects larger values than 10¹⁰.
const LARGEST: f64 = 1e9;

/// Largest number of steps in a message.
const MOST_STEPS: u32 = 1000;

/// Message of a browser.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Message {
    /// Requests a state.
    Next,
    Pause(bool),
    /// Number of steps to take while paused.
    Step(u32),
    Reset,
    /// Index of a control and its value, until it is released.
    Hold(usize, f64),
    Release(usize),
    Pull(Pull),
    LetGo,
}

/// Pull at a point of a body.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Pull {
    pub(super) body: usize,
    /// Point, m, body frame.
    pub(super) point: [f64; 3],
    /// Target of the point, m, world frame.
    pub(super) target: [f64; 3],
}

/// Limits of the numbers in messages.
#[derive(Clone, Debug)]
pub(super) struct Limits {
    /// Number of bodies.
    pub(super) bodies: usize,
    /// Range of each control.
    pub(super) controls: Vec<[f64; 2]>,
}

impl Limits {
    /// Range of a control without a range.
    pub(super) const UNLIMITED: [f64; 2] = [-LARGEST, LARGEST];

    /// Parses and checks a message.
    pub(super) fn parse(&self, text: &str) -> Result<Message> {
        let message = serde_json::from_str(text).map_err(|error| {
            // Neither text can break a line of a log.
            let start: String = text.chars().take(40).collect();
            let error: String = error.to_string().escape_debug().take(80).collect();
            Error::invalid(InvalidKind::Text, "a message", format!("{start:?}"), format!("valid: {error}"))
        })?;
        match message {
            Message::Step(steps) => {
                let expected = format_args!("1 to {MOST_STEPS}");
                Error::check_range((1..=MOST_STEPS).contains(&steps), "the number of steps", steps, expected)?;
            }
            Message::Hold(index, value) => {
                let [low, high] = self.control(index)?;
                // NaN is in no range.
                let (is_valid, what) = ((low..=high).contains(&value), format_args!("control {index}"));
                Error::check_range(is_valid, what, value, format_args!("within [{low}, {high}]"))?;
            }
            Message::Release(index) => _ = self.control(index)?,
            Message::Pull(pull) => self.check(&pull)?,
            _ => {}
        }
        Ok(message)
    }

    fn control(&self, index: usize) -> Result<[f64; 2]> {
        let count = self.controls.len();
        let error = || Error::out_of_range("the index of a control", index, format!("below {count}"));
        self.controls.get(index).copied().ok_or_else(error)
    }

    fn check(&self, pull: &Pull) -> Result<()> {
        // The world, of index 0, does not move.
        let expected = format_args!("at least 1 and below {}", self.bodies);
        Error::check_range((1..self.bodies).contains(&pull.body), "the body of a pull", pull.body, expected)?;
        let (limits, expected) = (-LARGEST..=LARGEST, format_args!("within ±{LARGEST:e}"));
        let mut coordinates = pull.point.iter().chain(&pull.target);
        coordinates.try_for_each(|at| Error::check_range(limits.contains(at), "a coordinate of a pull", at, expected))
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    use super::{LARGEST, Limits, Message, Pull};

    fn limits() -> Limits {
        Limits { bodies: 3, controls: vec![[-1.0, 2.0], Limits::UNLIMITED] }
    }

    const VALID: [&str; 8] = [
        r#""next""#,
        r#"{"pause":true}"#,
        r#"{"step":1}"#,
        r#""reset""#,
        r#"{"hold":[0,1.5]}"#,
        r#"{"release":1}"#,
        r#"{"pull":{"body":2,"point":[0,0.1,-2e-1],"target":[1,2,3]}}"#,
        r#""let_go""#,
    ];

    #[test]
    fn each_message_is_understood() {
        let pull = Pull { body: 2, point: [0.0, 0.1, -0.2], target: [1.0, 2.0, 3.0] };
        let expected = [
            Message::Next,
            Message::Pause(true),
            Message::Step(1),
            Message::Reset,
            Message::Hold(0, 1.5),
            Message::Release(1),
            Message::Pull(pull),
            Message::LetGo,
        ];
        assert_eq!(VALID.map(|text| limits().parse(text).unwrap()), expected);
    }

    #[test]
    fn wrong_messages_are_errors_that_name_the_mistake() {
        for (text, mistake) in [
            ("", "EOF"),
            ("next", "expected"),
            (r#""next" "next""#, "trailing"),
            (r#""quit""#, "quit"),
            (r#"{"pause":1}"#, "boolean"),
            (r#"{"pause":true,"step":1}"#, "expected"),
            (r#"{"step":0}"#, "1 to 1000"),
            (r#"{"step":1001}"#, "1 to 1000"),
            (r#"{"step":-1}"#, "u32"),
            (r#"{"hold":[2,0]}"#, "below 2"),
            (r#"{"hold":[0,2.1]}"#, "[-1, 2]"),
            (r#"{"hold":[1,1e10]}"#, "control 1"),
            (r#"{"hold":[0,1e999]}"#, "out of range"),
            (r#"{"hold":[0,NaN]}"#, "expected"),
            (r#"{"hold":[0,null]}"#, "f64"),
            (r#"{"hold":[-1,0]}"#, "usize"),
            (r#"{"hold":[0,0,0]}"#, "trailing"),
            (r#"{"release":18446744073709551615}"#, "below 2"),
            (r#"{"pull":{"body":0,"point":[0,0,0],"target":[0,0,0]}}"#, "at least 1 and below 3"),
            (r#"{"pull":{"body":3,"point":[0,0,0],"target":[0,0,0]}}"#, "at least 1 and below 3"),
            (r#"{"pull":{"body":1,"point":[0,0,0],"target":[0,0,1e300]}}"#, "±1e9"),
            (r#"{"pull":{"body":1,"point":[0,0],"target":[0,0,0]}}"#, "length 2"),
            (r#"{"pull":{"body":1,"point":[0,0,0],"target":[0,0,0],"force":1}}"#, "force"),
        ] {
            let error = limits().parse(text).unwrap_err().to_string();
            assert!(error.contains(mistake), "{text}: {error}");
        }
        let error = limits().parse("\"a\nb\u{7}<script>").unwrap_err().to_string();
        assert!(!error.contains(char::is_control), "{error}");
    }

    /// Reproducible: a failure prints its message.
    #[test]
    fn mutated_messages_are_valid_or_errors() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let limits = limits();
        let mut accepted = 0;
        for _ in 0..200_000 {
            let mut bytes = VALID[random.random_range(0..VALID.len())].as_bytes().to_vec();
            for _ in 0..random.random_range(1..4) {
                let at = random.random_range(0..bytes.len());
                let other = VALID[random.random_range(0..VALID.len())].as_bytes();
                match random.random_range(0..4) {
                    0 => bytes[at] = random.random(),
                    1 => bytes.insert(at, b"0123456789eE+-.[]{}\",:"[random.random_range(0..22)]),
                    2 if bytes.len() > 1 => _ = bytes.remove(at),
                    _ => bytes.extend_from_slice(&other[random.random_range(0..other.len())..]),
                }
            }
            let text = String::from_utf8_lossy(&bytes);
            let Ok(message) = limits.parse(&text) else { continue };
            accepted += 1;
            let is_valid = match message {
                Message::Hold(0, value) => (-1.0..=2.0).contains(&value),
                Message::Hold(index, value) => index == 1 && value.abs() <= LARGEST,
                Message::Release(index) => index < 2,
                Message::Step(steps) => (1..=1000).contains(&steps),
                Message::Pull(Pull { body, point, target }) => {
                    (1..3).contains(&body) && point.iter().chain(&target).all(|number| number.abs() <= LARGEST)
                }
                Message::Next | Message::Pause(_) | Message::Reset | Message::LetGo => true,
            };
            assert!(is_valid, "{text}: {message:?}");
        }
        assert!(accepted > 1000, "{accepted} messages are accepted");
    }
}
