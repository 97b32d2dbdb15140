//! The generated accessors, and the lists of them, are what the generator makes of the field table.

use std::path::Path;
use std::process::{Command, Stdio};

#[path = "../../src/generated/generator.rs"]
mod generator;

/// The output of `rustfmt` on `source`, with this repository's settings.
fn formatted(source: &str) -> String {
    use std::io::Write as _;
    let mut rustfmt = Command::new("rustfmt")
        .args(["--edition", "2024", "--config-path", env!("CARGO_MANIFEST_DIR")])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("rustfmt runs: `rustup component add rustfmt`");
    rustfmt.stdin.take().expect("piped").write_all(source.as_bytes()).expect("rustfmt reads");
    let output = rustfmt.wait_with_output().expect("rustfmt ends");
    assert!(output.status.success(), "rustfmt does not accept the generated source");
    String::from_utf8(output.stdout).expect("rustfmt writes UTF-8")
}

#[test]
fn accessors_are_those_of_the_field_table() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let table = std::fs::read_to_string(root.join("mujoco-sys/fields/v2_2_2.tsv")).expect("the table is committed");
    for (name, source) in generator::generate(&table) {
        let path = root.join(name);
        let made = formatted(&source);
        if std::env::var_os("UPDATE_GENERATED").is_some() {
            std::fs::write(&path, &made).expect("the file can be written to");
        }
        let committed = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(committed == made, "{} is out of date: UPDATE_GENERATED=1 cargo test --test coverage", path.display());
    }
}
