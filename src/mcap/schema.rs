//! Schemas of the messages: protobuf descriptors from the text of `.proto` files.

use super::protobuf::Message;

/// Names and texts of the files with all messages but that of the sensors.
pub(super) const COMMON: [(&str, &str); 3] = [
    ("google/protobuf/timestamp.proto", include_str!("timestamp.proto")),
    ("foxglove.proto", include_str!("foxglove.proto")),
    ("mujoco.proto", include_str!("mujoco.proto")),
];

/// Returns the `FileDescriptorSet` of files, each of which imports the previous ones.
pub(super) fn descriptors(files: &[(&str, &str)]) -> Vec<u8> {
    let mut set = Message::default();
    for (index, (name, text)) in files.iter().enumerate() {
        put_file(&mut set, name, text, &files[..index]);
    }
    set.bytes().to_vec()
}

/// Appends a `FileDescriptorProto`. Each line of the text is a package, the start or the end of a
/// message, a field or a comment.
fn put_file(set: &mut Message, name: &str, text: &str, imports: &[(&str, &str)]) {
    let mut package = "";
    let mut lines = text.lines().map(|line| line.trim().trim_end_matches([';', ' ', '{']));
    set.put_message(1, |file| {
        file.put_text(1, name);
        for (import, _) in imports {
            file.put_text(3, import);
        }
        file.put_text(12, "proto3");
        while let Some(line) = lines.next() {
            if let Some(name) = line.strip_prefix("package ") {
                package = name;
                file.put_text(2, package);
            } else if let Some(name) = line.strip_prefix("message ") {
                file.put_message(4, |message| {
                    message.put_text(1, name);
                    for field in lines.by_ref().take_while(|&line| line != "}") {
                        message.put_message(2, |descriptor| put_field(descriptor, field, package));
                    }
                });
            }
        }
    });
}

/// Fills a `FieldDescriptorProto`.
fn put_field(descriptor: &mut Message, field: &str, package: &str) {
    const OPTIONAL: u64 = 1;
    const REPEATED: u64 = 3;
    const MESSAGE: u64 = 11;
    let (label, field) = field.strip_prefix("repeated ").map_or((OPTIONAL, field), |field| (REPEATED, field));
    let mut words = field.split([' ', '=']).filter(|word| !word.is_empty());
    let mut word = || words.next().expect("Bug: a field of a schema is incomplete");
    let (kind, name, number) = (word(), word(), word());
    descriptor.put_text(1, name);
    descriptor.put_number(3, number.parse().expect("Bug: a field of a schema has no number"));
    descriptor.put_number(4, label);
    let code = match kind {
        "double" => 1,
        "int64" => 3,
        "int32" => 5,
        "fixed32" => 7,
        "bool" => 8,
        "string" => 9,
        "bytes" => 12,
        _ => MESSAGE,
    };
    descriptor.put_number(5, code);
    if code == MESSAGE {
        let name = if kind.contains('.') { format!(".{kind}") } else { format!(".{package}.{kind}") };
        descriptor.put_text(6, &name);
    }
}
