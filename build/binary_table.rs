//! Generates the table of the sizes and arrays of binary models for the module `model::mjb`, in the
//! order of the file.

use std::fmt::Write as _;

/// Numbers (`mjVERSION_HEADER`) of the engines whose binary models the module validates.
pub(crate) const VALIDATED: [u32; 2] = [222, 3_005_000];

/// Returns calls of the macros in `src/model/mjb/layout.rs` with the sizes and arrays in the
/// engine's field table.
pub(crate) fn generate(fields: &str) -> String {
    let rows: Vec<Vec<&str>> = fields.lines().skip(1).map(|line| line.split('\t').collect()).collect();
    let select = |owner: &'static str, kind: &'static str| rows.iter().filter(move |row| row[..2] == [owner, kind]);
    let mut text = String::from("sizes! {");
    for row in select("Model", "size") {
        write!(text, " {}", row[3]).unwrap();
    }
    text.push_str(" }\n");
    for (list, owner) in [("model_arrays", "Model"), ("data_arrays", "Data")] {
        writeln!(text, "{list}! {{").unwrap();
        for row in select(owner, "array") {
            let element = match row[2] {
                "mjtNum" => "f64",
                "float" => "f32",
                "int" => "i32",
                "mjtSize" => "i64",
                "mjtByte" | "char" => "u8",
                "uintptr_t" => "usize",
                "mjContact" => "mujoco_sys::mjContact",
                other => panic!("the layout of binary models has no element type {other}"),
            };
            let (rows, columns) = (row[4].replace('*', " * "), row[5].replace('*', " * "));
            writeln!(text, "    {}: {element}, [{rows}] [{columns}];", row[3]).unwrap();
        }
        text.push_str("}\n");
    }
    text
}
