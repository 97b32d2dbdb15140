//! Writes what the bindings say as C that compiles only if the engine's headers say the same.

use std::collections::HashMap;
use std::fmt::Write as _;

use crate::rust::{Item, Layout, Signature, Type};

/// What bindgen calls a field that has no name in the headers, and with it the type of that field.
const UNNAMED_FIELD: &str = "__bindgen_anon_";
const UNNAMED_TYPE: &str = "__bindgen_ty_";

/// How many declarations of each kind the C text checks.
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

/// The C text, and what it checks.
pub(crate) fn checks(items: &[Item]) -> (String, Checked) {
    let names = Names::of(items);
    let mut c = String::from("#include <stddef.h>\n#include <stdint.h>\n#include <mujoco/mujoco.h>\n");
    let mut checked = Checked::default();
    // The headers' unnamed structs get bindgen's name for them, so that all that follows can speak of them.
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
                // The fields of an unnamed union are its owner's, and checked as such.
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

/// A check of its own line, whose message names what is wrong.
fn claim(condition: &str, what: &str) -> String {
    format!("_Static_assert({condition}, \"{what}\");\n")
}

/// What the bindings' names are called in C.
struct Names<'a> {
    /// `struct`, `union` or `enum`, for the tags.
    tags: HashMap<&'a str, &'static str>,
    /// bindgen's names of unnamed structs that are the type of a field, with the owner of the field and its name.
    unnamed: Vec<(&'a str, &'a str, &'a str)>,
    /// Unnamed unions whose fields are, in C, fields of the struct around them, with the name of that struct and of the first
    /// field.
    merged: HashMap<&'a str, (&'a str, &'a str)>,
}

impl<'a> Names<'a> {
    fn of(items: &'a [Item]) -> Self {
        let mut names = Names { tags: HashMap::new(), unnamed: Vec::new(), merged: HashMap::new() };
        for item in items {
            match item {
                Item::Alias { name, of: Type::Named(of) } if name.ends_with('_') && is_int(of) => {
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

    /// The C name of a type.
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
            tag => return self.tags.get(tag).map_or_else(|| tag.to_owned(), |kind| format!("{kind} {tag}")),
        };
        c.to_owned()
    }

    /// A C declaration of `inner` with this type: inside out, as C has it.
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
        let int = matches!(of, Type::Named(of) if is_int(of));
        if int && self.tags.contains_key(name) {
            // Which integer an enum is, is the compiler's choice: this one's sign and size have to be bindgen's.
            let condition = format!("__builtin_types_compatible_p(enum {name}, {})", self.declare(of, "", false));
            claim(&condition, &format!("integer type of {name}"))
        } else {
            // C allows a typedef twice, if it is the same.
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
        let condition = format!("_Generic(&(({owner}*)0)->{field}, {pointer}: 1, default: 0)");
        claim(&condition, &format!("type of {owner}.{field}"))
    }

    fn layout(&self, layout: &Layout) -> String {
        match layout {
            // What an unnamed union takes shows in the offset of what comes after it, and in its owner's size.
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

/// A field whose name is a keyword of Rust has an underscore behind it.
fn c_field(field: &str) -> &str {
    if field == "type_" { "type" } else { field }
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
