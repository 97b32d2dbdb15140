//! The table of the engine's fields, from which the safe crate's accessors and the texts of `field_docs` are made.
//!
//! The engine describes most of its structs in `mjxmacro.h` (type, name, rows, columns), which the preprocessor expands for us
//! through `fields.h`; what a field means stands in the comment behind its declaration. `mjVisual` and `mjStatistic` are not
//! described there and are read from their declarations alone. A line of the table is
//! `struct, kind, type, name, rows, columns, comment`, separated by tabs, in the order of the engine's buffers. The kind tells
//! where the values are: a `size`, a `scalar` and a `vector` in the struct itself, an `array` behind a pointer.

use std::path::Path;

/// The table of the headers in `include`, expanded by the preprocessor of `compiler`.
pub(crate) fn table(include: &Path, compiler: &mut cc::Build) -> Result<String, String> {
    let expanded = compiler
        .file(Path::new(env!("CARGO_MANIFEST_DIR")).join("build/fields.h"))
        .include(include)
        .flag("-P") // no line markers
        .cargo_metadata(false)
        .try_expand()
        .map_err(|error| format!("the preprocessor could not expand the engine's mjxmacro.h: {error}"))?;
    let expanded = String::from_utf8_lossy(&expanded);
    let (model_header, data_header) = (read(include, "mjmodel.h")?, read(include, "mjdata.h")?);
    let model = members(&model_header, "mjModel_");
    let data = members(&data_header, "mjData_");
    let option = members(&model_header, "mjOption_");

    let mut table = String::from("struct\tkind\ttype\tname\trows\tcolumns\tcomment\n");
    let mut line = |cells: [&str; 7]| table.extend([&cells.join("\t"), "\n"]);
    for record in expanded.split('@').skip(1) {
        let record = record.split(';').next().unwrap_or_default();
        // A product such as `nuser*3` may stand between blanks or not.
        let words: Vec<&str> = record.split_whitespace().collect();
        let [owner, kind, ctype, name, rows, columns] = words[..] else {
            return Err(format!("mjxmacro.h has a record of an unknown form: {record}"));
        };
        let members = match owner {
            "Model" => &model,
            "Data" => &data,
            _ => &option,
        };
        let Some(member) = members.iter().find(|member| member.name == name) else {
            return Err(format!("{owner}.{name} has no comment in the headers"));
        };
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
    /// With the names of the structs around it: `global.fovy`.
    name: String,
    /// What stands in brackets behind it.
    length: Option<String>,
    comment: String,
}

/// The members of a struct, each with the comment behind its declaration. A comment may go on over the next lines.
fn members(header: &str, name: &str) -> Vec<Member> {
    let start = format!("struct {name} {{");
    let mut members: Vec<Member> = Vec::new();
    // Where the unnamed struct that is open begins: what it is called stands at its end.
    let mut group = 0;
    let mut goes_on = false;
    for line in
        header.lines().skip_while(|line| !line.starts_with(&start)).skip(1).take_while(|line| !line.starts_with('}'))
    {
        let (code, comment) = line.split_once("//").unwrap_or((line, ""));
        let comment = comment.split_whitespace().collect::<Vec<_>>().join(" ");
        if code.trim_end().ends_with('{') {
            group = members.len();
            goes_on = false;
        } else if let Some(declared) = code.trim().strip_suffix(';') {
            let (ctype, declared) = declared.rsplit_once([' ', '*']).unwrap_or_default();
            if ctype.trim() == "}" {
                for member in &mut members[group..] {
                    member.name = format!("{declared}.{}", member.name);
                }
                continue;
            }
            let (name, length) = match declared.split_once('[') {
                Some((name, length)) => (name, Some(length.trim_end_matches(']').to_owned())),
                None => (declared, None),
            };
            members.push(Member { ctype: ctype.trim().to_owned(), name: name.to_owned(), length, comment });
            goes_on = true;
        } else if goes_on && code.len() > 20 && code.trim().is_empty() && !comment.is_empty() {
            let last = &mut members.last_mut().expect("a member came before").comment;
            *last = format!("{last} {comment}");
        } else {
            goes_on = false;
        }
    }
    members
}
