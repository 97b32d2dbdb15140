//! The table of the engine's fields, the source of the safe crate's accessors and of the texts of
//! `field_docs`. Used by the build script, by the tests and by `xtask`.
//!
//! The engine describes most of its structs in `mjxmacro.h` (type, name, rows, columns), which the
//! C preprocessor expands through `fields.h`; the comment behind a field's declaration describes
//! its meaning. `mjVisual` and `mjStatistic` are missing from `mjxmacro.h` of older engines and are
//! read from their declarations. A line of the table is
//! `struct, kind, type, name, rows, columns, comment`, separated by tabs, in the order of the
//! engine's buffers. The kind is `size`, `scalar` or `vector` for values inside the struct, `array`
//! for values behind a pointer, and `arena` for arrays in the arena of the data, which each call of
//! the pipeline allocates again.

use std::path::Path;
use std::process::Command;

/// Returns the table of the headers in `include`. `compiler` is a C compiler, which expands
/// `fields_h` (the file `fields.h`).
pub(crate) fn table(include: &Path, fields_h: &Path, mut compiler: Command) -> Result<String, String> {
    // -P: no line markers.
    let expanded = compiler.args(["-E", "-P", "-I"]).arg(include).arg(fields_h).output();
    let expanded = expanded.map_err(|error| format!("the C compiler does not start: {error}"))?;
    if !expanded.status.success() {
        let errors = String::from_utf8_lossy(&expanded.stderr);
        return Err(format!("the preprocessor could not expand the engine's mjxmacro.h: {errors}"));
    }
    let expanded = expanded.stdout;
    let expanded = String::from_utf8_lossy(&expanded);
    let (model_header, data_header) = (read(include, "mjmodel.h")?, read(include, "mjdata.h")?);
    let model = members(&model_header, "mjModel_");
    let data = members(&data_header, "mjData_");
    let option = members(&model_header, "mjOption_");

    let mut table = String::from("struct\tkind\ttype\tname\trows\tcolumns\tcomment\n");
    let mut line = |cells: [&str; 7]| table.extend([&cells.join("\t"), "\n"]);
    for record in expanded.split('@').skip(1) {
        let record = record.split(';').next().unwrap_or_default();
        // A product such as `nuser*3` has no blanks in it; the preprocessor may put blanks around
        // it.
        let words: Vec<&str> = record.split_whitespace().collect();
        let [owner, kind, ctype, name, rows, columns] = words[..] else {
            return Err(format!("mjxmacro.h has a record of unknown form: {record}"));
        };
        let members = match owner {
            "Model" => &model,
            "Data" => &data,
            _ => &option,
        };
        let Some(member) = members.iter().find(|member| member.name == name) else {
            return Err(format!("{owner}.{name} has no comment in the headers"));
        };
        let ctype = if ctype == "-" { &member.ctype } else { ctype };
        line([owner, kind, ctype, name, rows, columns, &member.comment]);
    }
    for owner in ["Visual", "Statistic"] {
        for member in members(&model_header, &format!("mj{owner}_")) {
            let kind = if member.length.is_some() { "vector" } else { "scalar" };
            let length = member.length.as_deref().unwrap_or("1");
            line([owner, kind, &member.ctype, &member.name, length, "1", &member.comment]);
        }
    }
    Ok(table)
}

fn read(include: &Path, header: &str) -> Result<String, String> {
    let path = include.join("mujoco").join(header);
    std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))
}

/// One declaration of a struct.
struct Member {
    ctype: String,
    /// Qualified by the enclosing structs: `global.fovy`.
    name: String,
    /// The array length in brackets.
    length: Option<String>,
    comment: String,
}

/// Returns the members of a struct with their comments. A comment may continue on the following
/// lines.
fn members(header: &str, name: &str) -> Vec<Member> {
    let starts = [format!("struct {name} {{"), format!("typedef struct {name} {{")];
    let mut members: Vec<Member> = Vec::new();
    // First member of the current unnamed struct, whose name follows its closing brace.
    let mut group = 0;
    let mut continues = false;
    let lines = header.lines().skip_while(|line| !starts.iter().any(|start| line.starts_with(start)));
    for line in lines.skip(1).take_while(|line| !line.starts_with('}')) {
        let (code, comment) = line.split_once("//").unwrap_or((line, ""));
        let comment = comment.split_whitespace().collect::<Vec<_>>().join(" ");
        if code.trim_end().ends_with('{') {
            group = members.len();
            continues = false;
        } else if let Some(declared) = code.trim().strip_suffix(';') {
            let (declared, length) = match declared.split_once('[') {
                Some((declared, length)) => (declared, Some(length.trim_end_matches(']').to_owned())),
                None => (declared, None),
            };
            let (ctype, name) = declared.rsplit_once([' ', '*']).unwrap_or_default();
            if ctype.trim() == "}" {
                for member in &mut members[group..] {
                    member.name = format!("{name}.{}", member.name);
                }
                continue;
            }
            members.push(Member { ctype: ctype.trim().to_owned(), name: name.to_owned(), length, comment });
            continues = true;
        } else if continues && code.len() > 20 && code.trim().is_empty() && !comment.is_empty() {
            let last = &mut members.last_mut().expect("a member came before").comment;
            *last = format!("{last} {comment}");
        } else {
            continues = false;
        }
    }
    members
}
