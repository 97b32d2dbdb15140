//! Imports between the files of `src/` form no cycles, except for known ones. A module and its
//! children may use each other.
//!
//! A name counts as an import of the file that defines it, not of those that export it again.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::{read, sources};

/// Known cycles: two of their files, and the number of files. A simulation belongs to a model, and
/// a load simulates muscles to find their ranges of lengths. Renderers share the pipelines that a
/// device keeps, whose creation needs the device.
const KNOWN: [([&str; 2], usize); 2] = [(["data", "model"], 18), (["render/gpu", "render/pass/pipeline"], 15)];

/// Path of a module in the crate.
type Module = Vec<String>;

/// Declarations of a file, and the paths in it.
struct File {
    /// Names of items.
    items: BTreeSet<String>,
    /// Paths in `use` declarations and the names under which they are known, and other paths.
    uses: Vec<(Module, String)>,
    paths: Vec<Module>,
}

pub fn check(root: &Path) -> Vec<String> {
    let files = files(&root.join("src"));
    let edges: BTreeMap<&Module, BTreeSet<Module>> =
        files.iter().map(|(module, file)| (module, imports(&files, module, file))).collect();
    let count: usize = edges.values().map(BTreeSet::len).sum();
    assert!(files.len() > 300 && count > 1000, "{} files with {count} imports are read", files.len());
    let reached: BTreeMap<&Module, BTreeSet<&Module>> =
        edges.keys().map(|&module| (module, reachable(&edges, module))).collect();
    let mut found = Vec::new();
    let mut done = BTreeSet::new();
    let mut missing: Vec<usize> = (0..KNOWN.len()).collect();
    for (&module, of_module) in &reached {
        let cycle: Vec<&Module> = of_module.iter().copied().filter(|&other| reached[other].contains(module)).collect();
        if cycle.is_empty() || !done.insert(cycle.clone()) {
            continue;
        }
        let names: Vec<String> = cycle.iter().map(|module| module.join("/")).collect();
        let has = |name: &str| names.iter().any(|other| other == name);
        match KNOWN.iter().position(|(files, _)| files.iter().all(|file| has(file))) {
            Some(at) if names.len() <= KNOWN[at].1 => missing.retain(|&other| other != at),
            _ => found.push(format!(
                "src: these {} files import each other in a cycle: {}",
                names.len(),
                names.join(", ")
            )),
        }
    }
    let gone = |at: usize| format!("xtask/src/lint/imports.rs: there is no cycle of {}", KNOWN[at].0.join(" and "));
    found.extend(if found.is_empty() { missing.into_iter().map(gone).collect() } else { Vec::new() });
    found
}

/// Returns the files that a file uses directly, without the modules that contain it.
fn imports(files: &BTreeMap<Module, File>, module: &Module, file: &File) -> BTreeSet<Module> {
    let paths = file.uses.iter().map(|(path, _)| path).chain(&file.paths);
    let found = paths.filter_map(|path| resolve(files, module, without_glob(path), &mut BTreeSet::new()));
    found.filter(|other| !module.starts_with(other)).collect()
}

fn reachable<'f>(edges: &'f BTreeMap<&'f Module, BTreeSet<Module>>, from: &Module) -> BTreeSet<&'f Module> {
    let mut reached = BTreeSet::new();
    let mut next: Vec<&Module> = edges[from].iter().collect();
    while let Some(module) = next.pop() {
        if reached.insert(module) {
            next.extend(&edges[module]);
        }
    }
    reached
}

fn without_glob(path: &[String]) -> &[String] {
    path.strip_suffix(&["*".to_owned()]).unwrap_or(path)
}

/// Returns the file that defines what a path in a module names.
fn resolve(
    files: &BTreeMap<Module, File>,
    module: &[String],
    path: &[String],
    seen: &mut BTreeSet<(Module, Module)>,
) -> Option<Module> {
    let Some((first, rest)) = path.split_first() else { return Some(module.to_vec()) };
    if !seen.insert((module.to_vec(), path.to_vec())) {
        return None;
    }
    match &first[..] {
        "crate" => return resolve(files, &[], rest, seen),
        "self" => return resolve(files, module, rest, seen),
        "super" => return resolve(files, module.split_last()?.1, rest, seen),
        _ => {}
    }
    let file = files.get(module)?;
    let child = [module, std::slice::from_ref(first)].concat();
    if files.contains_key(&child) {
        return resolve(files, &child, rest, seen);
    }
    if file.items.contains(first) {
        return Some(module.to_vec());
    }
    // A path that starts with its name is that of another crate.
    let named = file.uses.iter().filter(|(path, name)| name == first && path.first() != Some(first));
    for (path, _) in named {
        let whole = match path.split_last() {
            Some((last, start)) if last == "self" => [start, rest].concat(),
            _ => [path, rest].concat(),
        };
        if let Some(found) = resolve(files, module, &whole, seen) {
            return Some(found);
        }
    }
    for (glob, _) in file.uses.iter().filter(|(_, name)| name == "*") {
        let base = resolve(files, module, without_glob(glob), seen).filter(|base| base != module);
        if let Some(found) = base.and_then(|base| resolve(files, &base, path, seen)) {
            return Some(found);
        }
    }
    None
}

/// Reads the files of the crate, without tests and without the guide.
fn files(src: &Path) -> BTreeMap<Module, File> {
    let mut files = BTreeMap::new();
    for path in sources(src) {
        let relative = path.strip_prefix(src).expect("a path in src").with_extension("");
        let mut module: Module = relative.iter().map(|part| part.to_string_lossy().into_owned()).collect();
        if module.iter().any(|part| part == "tests") || module[0] == "guide" {
            continue;
        }
        if matches!(&module[module.len() - 1][..], "mod" | "lib") {
            module.pop();
        }
        files.insert(module, parse(&read(&path)));
    }
    files
}

fn parse(text: &str) -> File {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    let code = lines.fold(String::new(), |code, line| code + line + "\n");
    let mut file = File { items: BTreeSet::new(), uses: Vec::new(), paths: Vec::new() };
    for line in code.lines() {
        file.items.extend(item(line));
    }
    for (start, _) in code.match_indices("use ") {
        let line = code[..start].rsplit('\n').next().unwrap_or_default().trim();
        let is_declaration = line.is_empty() || line.starts_with("pub");
        if let (true, Some(tree)) = (is_declaration, code[start + 4..].split(';').next()) {
            let tree: String = tree.replace(" as ", "@").split_whitespace().collect();
            expand("", &tree, &mut file.uses);
        }
    }
    for keyword in ["crate::", "super::", "self::"] {
        let is_path = |character: char| character.is_alphanumeric() || "_:$".contains(character);
        for (start, _) in code.match_indices(keyword).filter(|(start, _)| !code[..*start].ends_with(is_path)) {
            let path = code[start..].split(|character| !is_path(character)).next().unwrap_or_default();
            file.paths.push(path.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect());
        }
    }
    file
}

/// Returns the name that a line declares.
fn item(line: &str) -> Option<String> {
    let mut rest = line.trim_start();
    if let Some(after) = rest.strip_prefix("pub(") {
        rest = after.split_once(')')?.1.trim_start();
    }
    let mut words = rest.split([' ', '(', '<', ':', ';', '!', '{']).filter(|word| !word.is_empty());
    let keyword = words.find(|word| !matches!(*word, "pub" | "unsafe" | "async" | "extern" | "\"C\""))?;
    let is_item =
        matches!(keyword, "struct" | "enum" | "fn" | "trait" | "const" | "static" | "type" | "union" | "macro_rules");
    let name = words.find(|word| *word != "fn")?;
    is_item.then(|| name.to_owned())
}

/// Adds the paths of a use tree without spaces, in which `@` is `as`, with their names.
fn expand(prefix: &str, tree: &str, uses: &mut Vec<(Module, String)>) {
    if let Some((start, group)) = tree.split_once('{') {
        let group = group.strip_suffix('}').unwrap_or(group);
        let (mut depth, mut from) = (0, 0);
        for (at, character) in group.char_indices().chain([(group.len(), ',')]) {
            match character {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    if from < at {
                        expand(&format!("{prefix}{start}"), &group[from..at], uses);
                    }
                    from = at + 1;
                }
                _ => {}
            }
        }
        return;
    }
    let whole = format!("{prefix}{tree}");
    let (path, alias) = whole.split_once('@').map_or((&whole[..], None), |(path, alias)| (path, Some(alias)));
    let path: Module = path.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect();
    let last = path.iter().rev().find(|part| *part != "self").cloned().unwrap_or_default();
    uses.push((path, alias.map_or(last, str::to_owned)));
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::{expand, item, parse, resolve};

    #[test]
    fn use_trees_are_expanded() {
        let mut uses = Vec::new();
        expand("", "super::{a::{self,B},c@D,e::*}", &mut uses);
        let found: Vec<String> = uses.iter().map(|(path, name)| format!("{} {name}", path.join("::"))).collect();
        assert_eq!(found, ["super::a::self a", "super::a::B B", "super::c D", "super::e::* *"]);
    }

    #[test]
    fn items_are_found() {
        for (line, name) in [
            ("pub(crate) struct Model<'a> {", Some("Model")),
            ("    pub const fn size(self) -> usize {", Some("size")),
            ("const MAX: usize = 3;", Some("MAX")),
            ("macro_rules! parts {", Some("parts")),
            ("impl Model {", None),
            ("    let x = 3;", None),
        ] {
            assert_eq!(item(line).as_deref(), name, "{line}");
        }
    }

    #[test]
    fn names_are_imports_of_the_file_that_defines_them() {
        let module =
            |path: &str| path.split('/').filter(|part| !part.is_empty()).map(str::to_owned).collect::<Vec<_>>();
        let files = [
            ("", "mod a;\nmod b;\npub use self::a::Thing;"),
            ("a", "mod inner;\npub use self::inner::Thing;"),
            ("a/inner", "pub struct Thing;"),
            ("b", "use crate::Thing as Other;\nuse other::other;"),
        ];
        let files = files.iter().map(|(path, text)| (module(path), parse(text))).collect();
        let found = resolve(&files, &module("b"), &module("Other"), &mut BTreeSet::new());
        assert_eq!(found, Some(module("a/inner")));
        assert_eq!(resolve(&files, &module("b"), &module("other"), &mut BTreeSet::new()), None);
    }
}
