//! The build script uses committed bindings for another version if its headers declare the same.
//! Here the other version is made of the headers of this engine.

#[path = "../build/c_checks.rs"]
mod c_checks;
#[path = "../build/compatible.rs"]
mod compatible;
#[path = "header/compiler.rs"]
mod compiler;
#[path = "../build/fields.rs"]
mod fields;
#[path = "../build/rust_items.rs"]
mod rust_items;

use std::fs;
use std::path::{Path, PathBuf};

use compatible::{Bindings, Committed, Headers, Refusal};
use compiler::{INCLUDE, compiler};

const BINDINGS: &str = include_str!(concat!(env!("OUT_DIR"), "/bindings.rs"));
const VERSION: u32 = mujoco_sys::mjVERSION_HEADER;

/// Copies the headers, changes a text in the one that has it, and returns the bindings of the copy.
fn bindings_with(from: &str, to: &str) -> Result<Bindings, Refusal> {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("mujoco")).unwrap();
    let mut is_changed = false;
    for entry in fs::read_dir(Path::new(INCLUDE).join("mujoco")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "h") {
            continue;
        }
        let name = path.file_name().unwrap();
        // Some of Debian's headers contain Latin-1.
        let mut text = String::from_utf8_lossy(&fs::read(&path).unwrap()).into_owned();
        if !is_changed && text.contains(from) {
            is_changed = true;
            text = text.replacen(from, to, 1);
        }
        if name == "mujoco.h" {
            let line = |version| format!("#define mjVERSION_HEADER {version}");
            assert!(text.contains(&line(VERSION)));
            text = text.replace(&line(VERSION), &line(VERSION + 1));
        }
        fs::write(folder.path().join("mujoco").join(name), text).unwrap();
    }
    assert!(is_changed, "no header has {from:?}");
    let fields_h = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/build/fields.h"));
    let command = || compiler().get_compiler().to_command();
    let headers = Headers {
        include: folder.path(),
        version: VERSION + 1,
        compiler: &command,
        fields: &fields::table(folder.path(), &fields_h, command()).unwrap(),
        scratch: &folder.path().join("declarations.c"),
    };
    let committed = Committed { bindings: BINDINGS.to_owned(), fields: mujoco_sys::FIELDS.to_owned() };
    compatible::bindings(&headers, &committed)
}

#[test]
fn a_patch_release_uses_the_bindings_of_the_version_before_it() {
    let Bindings { text, absent } = bindings_with("// Compute", "// Calculate").unwrap();
    let line = |version| format!("pub const mjVERSION_HEADER: u32 = {version};");
    assert!(absent.is_empty());
    assert_eq!(text, BINDINGS.replace(&line(VERSION), &line(VERSION + 1)));
}

#[test]
fn new_functions_are_not_bound_and_absent_ones_are_left_out() {
    let added = "MJAPI int mj_version(void);\nMJAPI int mj_made_up(int number);";
    let Bindings { text, absent } = bindings_with("MJAPI int mj_version(void);", added).unwrap();
    assert!(absent.is_empty() && text.contains("fn mj_version()") && !text.contains("mj_made_up"));
    let Bindings { text, absent } = bindings_with("MJAPI int mj_version(void);", "").unwrap();
    assert_eq!(absent, ["mj_version"]);
    // The compiler suggests mju_zero4.
    assert_eq!(bindings_with("mju_zero3(", "mju_none(").unwrap().absent, ["mju_zero3"]);
    let functions = |text: &str| text.matches("pub fn ").count();
    assert!(!text.contains("fn mj_version()") && functions(&text) + 1 == functions(BINDINGS));
}

#[test]
fn a_different_declaration_is_refused_with_its_name() {
    for (from, to, named) in [
        ("struct mjLROpt_ {", "struct mjLROpt_ {\nint added;", "offset of struct mjLROpt_.mode"),
        ("mjJNT_HINGE", "mjJNT_NEW, mjJNT_HINGE", "mjJNT_HINGE"),
        ("MJAPI int mj_version(void);", "MJAPI double mj_version(void);", "mj_version"),
        ("mjcb_time;", "mjcb_other;", "mjcb_time"),
        ("MJ_M(nu)", "MJ_M(na)", "mjxmacro.h has: Model array"),
    ] {
        let what = match bindings_with(from, to) {
            Err(Refusal::Different(what)) => what,
            Err(Refusal::Unchecked(what)) => panic!("{to}: {what}"),
            Ok(_) => panic!("{to} is accepted"),
        };
        assert!(what.contains(named) && what.lines().count() == 1, "{to}: {what}");
    }
}
