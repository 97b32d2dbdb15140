//! The table of the engine's arrays and sizes, from which the safe crate's accessors are generated.
//!
//! The engine describes its own structs in `mjxmacro.h` (type, name, rows, columns), which the preprocessor expands for us
//! through `fields.h`; what a field means stands in the comment behind its declaration. A line of the table is
//! `struct, kind, type, name, rows, columns, comment`, separated by tabs, in the order of the engine's buffers.

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
    let model = comments(&read(include, "mjmodel.h")?, "mjModel_");
    let data = comments(&read(include, "mjdata.h")?, "mjData_");

    let mut table = String::from("struct\tkind\ttype\tname\trows\tcolumns\tcomment\n");
    for record in expanded.split('@').skip(1) {
        let record = record.split(';').next().unwrap_or_default();
        // A product such as `nuser*3` may stand between blanks or not.
        let words: Vec<&str> = record.split_whitespace().collect();
        let [owner, kind, ctype, name, rows, columns] = words[..] else {
            return Err(format!("mjxmacro.h has a record of an unknown form: {record}"));
        };
        let comments = if owner == "Model" { &model } else { &data };
        let Some((_, comment)) = comments.iter().find(|(field, _)| field == name) else {
            return Err(format!("{owner}.{name} has no comment in the headers"));
        };
        table.push_str(&[owner, kind, ctype, name, rows, columns, comment].join("\t"));
        table.push('\n');
    }
    Ok(table)
}

fn read(include: &Path, header: &str) -> Result<String, String> {
    let path = include.join("mujoco").join(header);
    std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))
}

/// The fields of a struct, each with the comment behind its declaration. A comment may go on over the next lines.
fn comments(header: &str, name: &str) -> Vec<(String, String)> {
    let start = format!("struct {name} {{");
    let mut fields: Vec<(String, String)> = Vec::new();
    let mut goes_on = false;
    for line in
        header.lines().skip_while(|line| !line.starts_with(&start)).skip(1).take_while(|line| !line.starts_with('}'))
    {
        let (code, comment) = line.split_once("//").unwrap_or((line, ""));
        let comment = comment.split_whitespace().collect::<Vec<_>>().join(" ");
        if let Some(declared) = code.trim().strip_suffix(';') {
            let field = declared.rsplit([' ', '*']).next().unwrap_or_default();
            let field = field.split('[').next().unwrap_or_default();
            fields.push((field.to_owned(), comment));
            goes_on = true;
        } else if goes_on && code.len() > 20 && code.trim().is_empty() && !comment.is_empty() {
            let last = &mut fields.last_mut().expect("a field came before").1;
            *last = format!("{last} {comment}");
        } else {
            goes_on = false;
        }
    }
    fields
}
