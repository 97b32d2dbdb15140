//! Names of the visualiser's structs and enums in the engine's headers, which the renderer compares
//! with its statement of support.

use std::path::Path;

/// Structs whose members are listed, and enums whose constants are listed.
const STRUCTS: [&str; 5] = ["mjvGeom", "mjvLight", "mjvGLCamera", "mjvScene", "mjvOption"];
const ENUMS: [&str; 9] = [
    "mjtGeom",
    "mjtVisFlag",
    "mjtRndFlag",
    "mjtTexture",
    "mjtTextureRole",
    "mjtLightType",
    "mjtProjection",
    "mjtColorSpace",
    "mjtStereo",
];

/// Generates a Rust array of the names that the headers in a directory declare. It is empty without
/// a directory.
pub(super) fn generate(include: Option<&Path>) -> String {
    let mut text = String::new();
    for entry in include.and_then(|folder| std::fs::read_dir(folder).ok()).into_iter().flatten().flatten() {
        if entry.path().extension().is_some_and(|extension| extension == "h") {
            text += &without_comments(&std::fs::read_to_string(entry.path()).unwrap_or_default());
        }
    }
    let mut names: Vec<String> = Vec::new();
    for name in STRUCTS {
        let members = body(&text, "struct", name).unwrap_or_default().split(';');
        let members = members.filter_map(|member| member.split('[').next()?.split_whitespace().last());
        names.extend(members.map(|member| format!("{name}.{}", member.trim_start_matches('*'))));
    }
    for name in ENUMS {
        let constants = body(&text, "enum", name).unwrap_or_default().split(',');
        let constants = constants.filter_map(|constant| constant.split('=').next());
        names.extend(constants.map(|constant| constant.trim().to_owned()).filter(|constant| !constant.is_empty()));
    }
    format!("{names:?}")
}

fn without_comments(text: &str) -> String {
    text.lines().flat_map(|line| [line.split("//").next().unwrap_or_default(), "\n"]).collect()
}

/// Returns the text between the braces of a declaration, whose tag ends with an underscore in some
/// headers.
fn body<'t>(text: &'t str, kind: &str, name: &str) -> Option<&'t str> {
    let tags = [format!("{kind} {name}_ {{"), format!("{kind} {name} {{")];
    let (_, after) = tags.iter().find_map(|tag| text.split_once(tag.as_str()))?;
    after.split_once('}').map(|(body, _)| body)
}
