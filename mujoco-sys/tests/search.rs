//! The places in which the build script searches for an engine and for libclang, the names of the
//! engine's library, and its links beside programs.

#[allow(dead_code, reason = "the build script uses all of it")]
#[path = "../build/headers.rs"]
mod headers;
#[allow(dead_code, reason = "the build script uses all of it")]
#[path = "../build/libclang.rs"]
mod libclang;
#[path = "../build/programs.rs"]
mod programs;
#[allow(dead_code, reason = "the build script uses all of it")]
#[path = "../build/target.rs"]
mod target;

use std::ffi::OsString;
use std::fs;
use std::path::PathBuf;

use target::System;

#[test]
fn environments_come_before_the_system() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let wheel = path("venv/lib/python3.10/site-packages/mujoco");
    let vendor = path("ros/opt/mujoco_vendor");
    fs::create_dir_all(&wheel).unwrap();
    fs::create_dir_all(&vendor).unwrap();

    let prefixes = std::env::join_paths([path("workspace"), path("ros")]).unwrap();
    let roots = headers::found_roots(|name| {
        Some(match name {
            "VIRTUAL_ENV" => path("venv").into_os_string(),
            "CONDA_PREFIX" => path("conda").into_os_string(),
            "AMENT_PREFIX_PATH" => prefixes.clone(),
            other => panic!("{other} is not searched"),
        })
    });
    assert_eq!(roots[..3], [wheel, path("conda"), vendor]);
    assert!(roots[3..].contains(&PathBuf::from("/usr")));
}

#[test]
fn environments_of_windows_have_other_directories() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (wheel, library) = (path("venv/Lib/site-packages/mujoco"), path("conda/Library"));
    fs::create_dir_all(&wheel).unwrap();
    fs::create_dir_all(&library).unwrap();
    let roots = headers::found_roots(|name| match name {
        "VIRTUAL_ENV" => Some(path("venv").into_os_string()),
        "CONDA_PREFIX" => Some(path("conda").into_os_string()),
        _ => None,
    });
    assert_eq!(roots[..3], [wheel, path("conda"), library]);
}

#[test]
fn each_system_has_its_names_of_the_library() {
    let files =
        ["libmujoco.so", "libmujoco.so.2.2.2", "libmujoco.2.2.2.dylib", "libmujoco.dylib", "mujoco.dll", "mujoco.lib"];
    let found = |system: System| files.into_iter().filter(|name| system.is_library(name)).collect::<Vec<_>>();
    assert_eq!(found(System::Elf), files[..2]);
    assert_eq!(found(System::MacOs), files[2..4]);
    assert_eq!(found(System::Windows), files[4..5]);
    assert_eq!(System::Elf.search_names("libmujoco.so"), ["libmujoco.so"]);
    assert_eq!(System::Elf.search_names("libmujoco.so.2.2.2"), ["libmujoco.so", "libmujoco.so.2.2.2"]);
    // The third is the path that the official library records.
    assert_eq!(
        System::MacOs.search_names("libmujoco.2.2.2.dylib"),
        ["libmujoco.dylib", "libmujoco.2.2.2.dylib", "mujoco.framework/Versions/A/libmujoco.2.2.2.dylib"]
    );
}

#[test]
fn a_named_directory_can_be_that_of_pip_and_relative_to_a_directory_above() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let out = path("user/workspace/target/debug/build/sys/out");
    let roots = |dir: &str| headers::named_roots(&path(dir), &out);
    let relative = |dir: &str| headers::named_roots(dir.as_ref(), &out);
    // Without headers, the directories are those that an error names.
    assert_eq!(roots("engines"), [path("engines")]);
    assert!(relative("engines").starts_with(&[out.join("engines"), out.parent().unwrap().join("engines")]));
    assert!(relative("engines").contains(&path("user/engines")));

    let install = |dir: &str| {
        fs::create_dir_all(path(dir).join("include/mujoco")).unwrap();
        fs::write(path(dir).join("include/mujoco/mujoco.h"), "").unwrap();
        path(dir)
    };
    // `pip install --target user/engines`.
    let package = install("user/engines/mujoco");
    for dir in ["user/engines", "user/engines/mujoco"] {
        assert!(roots(dir).iter().eq([&package]), "{dir}: {:?}", roots(dir));
    }
    for dir in ["engines", "./engines", "engines/mujoco"] {
        assert!(relative(dir).iter().eq([&package]), "{dir}: {:?}", relative(dir));
    }
    // The nearest has precedence, also if a directory above has the headers without `mujoco`.
    install("engines");
    assert_eq!(relative("engines"), [package]);
    let nearest = install("user/workspace/engines");
    assert_eq!(relative("engines"), [nearest]);
}

#[cfg(unix)]
#[test]
fn directories_of_programs_have_links_to_the_present_engine_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for dir in ["lib", "target/debug/build/sys/out", "target/debug/deps", "target/debug/examples"] {
        fs::create_dir_all(path(dir)).unwrap();
    }
    // As in archives for Linux: the linker's name is a link.
    fs::write(path("lib/libmujoco.so.3.5.0"), "").unwrap();
    std::os::unix::fs::symlink("libmujoco.so.3.5.0", path("lib/libmujoco.so")).unwrap();
    let profile = path("target/debug");
    let programs = ["", "deps", "examples"].map(|name| profile.join(name));
    let folders = |system, out: &str| programs::folders(system, &path(out));
    assert_eq!(folders(System::Windows, "target/debug/build/sys/out"), programs);
    assert_eq!(folders(System::Elf, "target/debug/build/sys/out"), programs.map(|folder| folder.join("mujoco-lib")));
    assert!(folders(System::Elf, "target/debug/sys/out").is_empty());

    let beside = profile.join("deps/mujoco-lib");
    let found = || {
        let mut names: Vec<_> = fs::read_dir(&beside).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let library = path("lib/libmujoco.so");
    let names = programs::names(System::Elf, &library);
    programs::place(System::Elf, &library, &names, &beside).unwrap();
    assert_eq!(found(), ["libmujoco.so", "libmujoco.so.3.5.0"]);
    // Files that the build did not make remain, as do other links.
    fs::write(beside.join("libmujoco.so.2.2.2"), "").unwrap();
    std::os::unix::fs::symlink("program", beside.join("other")).unwrap();
    let names = programs::loader_names(System::Elf, &library);
    programs::place(System::Elf, &library, &names, &beside).unwrap();
    assert_eq!(found(), ["libmujoco.so.2.2.2", "libmujoco.so.3.5.0", "other"]);
    assert!(fs::canonicalize(beside.join("libmujoco.so.3.5.0")).unwrap().ends_with("lib/libmujoco.so.3.5.0"));
    // Another engine of the same version takes the place of the first, and none that of all.
    fs::create_dir_all(path("other")).unwrap();
    fs::write(path("other/libmujoco.so.3.5.0"), "").unwrap();
    programs::place(System::Elf, &path("other/libmujoco.so.3.5.0"), &names, &beside).unwrap();
    assert!(fs::canonicalize(beside.join("libmujoco.so.3.5.0")).unwrap().ends_with("other/libmujoco.so.3.5.0"));
    programs::place(System::Elf, &library, &[], &beside).unwrap();
    assert_eq!(found(), ["libmujoco.so.2.2.2", "other"]);

    let library = path("lib/libmujoco.3.5.0.dylib");
    fs::write(&library, "").unwrap();
    let framework = beside.join("mujoco.framework/Versions/A/libmujoco.3.5.0.dylib");
    let names = programs::loader_names(System::MacOs, &library);
    programs::place(System::MacOs, &library, &names, &beside).unwrap();
    assert_eq!(fs::canonicalize(&framework).unwrap(), fs::canonicalize(&library).unwrap());
    programs::place(System::MacOs, &library, &[], &beside).unwrap();
    assert!(!framework.is_symlink());
}

#[test]
fn without_environments_only_the_system_is_searched() {
    let roots = headers::found_roots(|_| None::<OsString>);
    assert!(roots.ends_with(&["/usr", "/usr/local", "/opt/mujoco"].map(PathBuf::from)), "{roots:?}");
    // pkg-config may report one more prefix.
    assert!(roots.len() <= 4, "{roots:?}");
}

#[test]
fn headers_without_a_version_are_an_error_that_names_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let include = folder.path().join("include/mujoco");
    fs::create_dir_all(&include).unwrap();
    let error = |root| headers::probe(root).map(|found| found.version).unwrap_err();
    assert!(error(folder.path()).contains("mujoco.h"));
    fs::write(include.join("mujoco.h"), "int mj_version(void);\n").unwrap();
    assert!(error(folder.path()).contains("mjVERSION_HEADER"));
    fs::write(include.join("mujoco.h"), "#define mjVERSION_HEADER 222\n").unwrap();
    assert_eq!(headers::probe(folder.path()).map(|found| found.version), Ok(222));
}

#[cfg(unix)]
#[test]
fn libclang_is_found_in_a_python_that_has_the_package() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    // Not found: no program, a package without the library, a Python without the package.
    let python = folder.path().join("python3");
    assert_eq!(libclang::of_python(&python), None);
    let write = |script: String| {
        fs::write(&python, script).unwrap();
        fs::set_permissions(&python, fs::Permissions::from_mode(0o755)).unwrap();
    };
    let prints_package = format!("#!/bin/sh\necho {}/clang\n", folder.path().display());
    write(prints_package.clone());
    assert_eq!(libclang::of_python(&python), None);
    let native = folder.path().join("clang/native");
    fs::create_dir_all(&native).unwrap();
    assert_eq!(libclang::of_python(&python), Some(native));
    write(prints_package + "exit 1\n");
    assert_eq!(libclang::of_python(&python), None);
}
