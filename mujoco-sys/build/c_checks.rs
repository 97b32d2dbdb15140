//! Translates the bindings into C that compiles only if the engine's headers declare the same. Used
//! by the build script and by its tests.

use std::collections::HashMap;
use std::fmt::Write as _;

use super::rust_items::{Item, Layout, Signature, Type};

/// Arguments of the C compiler for the text of [`checks`].
pub(crate) const FLAGS: [&str; 3] = ["-std=gnu11", "-fsyntax-only", "-w"];

/// Prefixes of bindgen's names for unnamed fields and their types.
const UNNAMED_FIELD: &str = "__bindgen_anon_";
const UNNAMED_TYPE: &str = "__bindgen_ty_";

/// Number of declarations of each kind that the C text checks.
#[allow(dead_code, reason = "the tests compare the numbers")]
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Checked {
    pub(crate) constants: usize,
    pub(crate) aliases: usize,
    pub(crate) records: usize,
    pub(crate) fields: usize,
    pub(crate) functions: usize,
    pub(crate) statics: usize,
    pub(crate) layouts: usize,
}

/// Returns the C text and the number of its checks.
pub(crate) fn checks(items: &[Item]) -> (String, Checked) {
    let names = Names::of(items);
    let mut c = String::from("#include <stddef.h>\n#include <stdint.h>\n#include <mujoco/mujoco.h>\n");
    let mut checked = Checked::default();
    // Gives the headers' unnamed structs bindgen's names, for use in the declarations below.
    for (name, owner, field) in &names.unnamed {
        let owner = names.c(owner);
        writeln!(c, "typedef __typeof__((({owner}*)0)->{field}) {name};").expect("a String takes all");
    }
    for item in items {
        let check = match item {
            Item::Constant { name, value } => {
                checked.constants += 1;
                let condition = match value.strip_prefix("b ") {
                    Some(string) => format!("__builtin_strcmp({name}, {string}) == 0"),
                    None => format!("({name}) == ({value})"),
                };
                claim(&condition, &format!("value of {name}"))
            }
            Item::Alias { name, of } => {
                checked.aliases += 1;
                names.alias(name, of)
            }
            Item::Record { name, fields, .. } => {
                checked.records += 1;
                // The fields of an unnamed union are checked as fields of its owner.
                checked.fields += fields.iter().filter(|(field, _)| !field.starts_with(UNNAMED_FIELD)).count();
                fields.iter().map(|(field, of)| names.field(name, field, of)).collect()
            }
            Item::Function { name, signature } => {
                checked.functions += 1;
                format!("{};\n", names.function(name, signature))
            }
            Item::Static { name, of } => {
                checked.statics += 1;
                format!("extern {};\n", names.declare(of, name, false))
            }
            Item::Layout(layout) => {
                checked.layouts += 1;
                names.layout(layout)
            }
        };
        c.push_str(&check);
    }
    (c, checked)
}

/// Returns a static assertion on its own line, with a message that names the difference.
fn claim(condition: &str, what: &str) -> String {
    format!("_Static_assert({condition}, \"{what}\");\n")
}

/// C names of the bindings' types.
struct Names<'a> {
    /// `struct`, `union` or `enum` for each tag.
    tags: HashMap<&'a str, &'static str>,
    /// bindgen's names of the unnamed structs of fields, with the owner and the name of the field.
    unnamed: Vec<(&'a str, &'a str, &'a str)>,
    /// Unnamed unions whose fields belong in C to the enclosing struct, with the names of that
    /// struct and of the first field.
    merged: HashMap<&'a str, (&'a str, &'a str)>,
}

impl<'a> Names<'a> {
    fn of(items: &'a [Item]) -> Self {
        let mut names = Names { tags: HashMap::new(), unnamed: Vec::new(), merged: HashMap::new() };
        for item in items {
            match item {
                // The tag of an enum is `mjtJoint_` in older headers, and `mjtJoint` like its type
                // in newer ones.
                Item::Alias { name, of: Type::Named(of) }
                    if (name.ends_with('_') || name.starts_with("mjt")) && is_int(of) =>
                {
                    names.tags.insert(name, "enum");
                }
                Item::Record { union, name, fields } => {
                    if !name.contains(UNNAMED_TYPE) {
                        names.tags.insert(name, if *union { "union" } else { "struct" });
                    }
                    for (field, of) in fields {
                        let Type::Named(of) = of else { continue };
                        if field.starts_with(UNNAMED_FIELD) {
                            names.merged.insert(of, (name, first_field(items, of)));
                        } else if of.contains(UNNAMED_TYPE) {
                            names.unnamed.push((of, name, c_field(field)));
                        }
                    }
                }
                _ => {}
            }
        }
        names
    }

    /// Returns the C name of a type.
    fn c(&self, name: &str) -> String {
        let c = match name {
            "c_void" => "void",
            "c_char" => "char",
            "c_schar" => "signed char",
            "c_uchar" => "unsigned char",
            "c_short" => "short",
            "c_ushort" => "unsigned short",
            "c_int" => "int",
            "c_uint" => "unsigned int",
            "c_long" => "long",
            "c_ulong" => "unsigned long",
            "c_longlong" => "long long",
            "c_ulonglong" => "unsigned long long",
            "f32" => "float",
            "f64" => "double",
            "bool" => "_Bool",
            "usize" => "size_t",
            "isize" => "ptrdiff_t",
            "i8" => "int8_t",
            "u8" => "uint8_t",
            "i16" => "int16_t",
            "u16" => "uint16_t",
            "i32" => "int32_t",
            "u32" => "uint32_t",
            "i64" => "int64_t",
            "u64" => "uint64_t",
            // Rust's `bool` is restricted to two bit patterns, so the bindings have a byte.
            "mjtBool" => "mjtBool",
            tag => return self.tags.get(tag).map_or_else(|| tag.to_owned(), |kind| format!("{kind} {tag}")),
        };
        c.to_owned()
    }

    /// Returns the C declaration of `inner` with this type, inside out as C requires.
    fn declare(&self, of: &Type, inner: &str, constant: bool) -> String {
        let qualifier = if constant { "const " } else { "" };
        match of {
            Type::Named(name) => format!("{qualifier}{} {inner}", self.c(name)),
            Type::Pointer { constant: pointee, to } => {
                let pointer = format!("*{qualifier}{inner}");
                let pointer = if matches!(**to, Type::Array(..)) { format!("({pointer})") } else { pointer };
                self.declare(to, &pointer, *pointee)
            }
            Type::Array(element, length) => self.declare(element, &format!("{inner}[{length}]"), constant),
            Type::Function(signature) => self.function(&format!("(*{qualifier}{inner})"), signature),
        }
    }

    fn function(&self, name: &str, signature: &Signature) -> String {
        let mut parameters: Vec<String> = signature.parameters.iter().map(|of| self.declare(of, "", false)).collect();
        if signature.variadic {
            parameters.push("...".to_owned());
        }
        let parameters = if parameters.is_empty() { "void".to_owned() } else { parameters.join(", ") };
        let declarator = format!("{name}({parameters})");
        match &signature.result {
            Some(of) => self.declare(of, &declarator, false),
            None => format!("void {declarator}"),
        }
    }

    fn alias(&self, name: &str, of: &Type) -> String {
        if name == "mjtBool" {
            return claim("sizeof(mjtBool) == 1", "size of mjtBool");
        }
        let int = matches!(of, Type::Named(of) if is_int(of));
        if int && self.tags.contains_key(name) {
            // The compiler chooses the integer type of an enum: its signedness and size must match
            // bindgen's.
            let condition = format!("__builtin_types_compatible_p(enum {name}, {})", self.declare(of, "", false));
            claim(&condition, &format!("integer type of {name}"))
        } else {
            // C allows a repeated typedef if both are the same.
            format!("typedef {};\n", self.declare(of, name, false))
        }
    }

    fn field(&self, owner: &str, field: &str, of: &Type) -> String {
        if field.starts_with(UNNAMED_FIELD) {
            return String::new();
        }
        let owner = self.c(self.merged.get(owner).map_or(owner, |(outer, _)| outer));
        let field = c_field(field);
        let pointer = self.declare(&Type::Pointer { constant: false, to: Box::new(of.clone()) }, "", false);
        // Rust has no volatile types.
        let volatile = if matches!(of, Type::Named(_)) { format!("volatile {pointer}: 1, ") } else { String::new() };
        let condition = format!("_Generic(&(({owner}*)0)->{field}, {pointer}: 1, {volatile}default: 0)");
        claim(&condition, &format!("type of {owner}.{field}"))
    }

    fn layout(&self, layout: &Layout) -> String {
        match layout {
            // The size of an unnamed union shows in the offset of the next field and in its owner's
            // size.
            Layout::Size { of, .. } | Layout::Alignment { of, .. } if self.merged.contains_key(of.as_str()) => {
                String::new()
            }
            Layout::Size { of, bytes } => {
                claim(&format!("sizeof({}) == {bytes}", self.c(of)), &format!("size of {of}"))
            }
            Layout::Alignment { of, bytes } => {
                claim(&format!("_Alignof({}) == {bytes}", self.c(of)), &format!("alignment of {of}"))
            }
            Layout::Offset { of, field, bytes } => {
                let (owner, start) = match self.merged.get(of.as_str()) {
                    Some((owner, first)) => (self.c(owner), format!("offsetof({}, {first})", self.c(owner))),
                    None => (self.c(of), "0".to_owned()),
                };
                let field = c_field(field);
                let condition = format!("offsetof({owner}, {field}) - {start} == {bytes}");
                claim(&condition, &format!("offset of {owner}.{field}"))
            }
        }
    }
}

fn is_int(name: &str) -> bool {
    matches!(name, "c_int" | "c_uint")
}

/// Removes the underscore that bindgen appends to a field whose name is a Rust keyword.
fn c_field(field: &str) -> &str {
    match field {
        "type_" => "type",
        "ref_" => "ref",
        field => field,
    }
}

fn first_field<'a>(items: &'a [Item], of: &str) -> &'a str {
    items
        .iter()
        .find_map(|item| match item {
            Item::Record { name, fields, .. } if name == of => fields.first().map(|(field, _)| c_field(field)),
            _ => None,
        })
        .expect("an unnamed union has fields")
}
