//! Parser of the bindings, used by the build script and by its tests. It accepts only the Rust that
//! bindgen writes and panics on anything else, so that every declaration is checked.

/// Type in the bindings.
#[derive(Clone, Debug)]
pub(crate) enum Type {
    /// Last segment of a path: `c_int`, `f64`, `mjModel`.
    Named(String),
    /// `*const T` or `*mut T`.
    Pointer { constant: bool, to: Box<Type> },
    /// `[T; N]`.
    Array(Box<Type>, usize),
    /// `Option<unsafe extern "C" fn(…) -> …>`.
    Function(Signature),
}

/// Parameters, and the result unless it is `void`.
#[derive(Clone, Debug)]
pub(crate) struct Signature {
    pub(crate) parameters: Vec<Type>,
    pub(crate) variadic: bool,
    pub(crate) result: Option<Box<Type>>,
}

/// Declaration in the bindings.
#[derive(Debug)]
pub(crate) enum Item {
    Constant {
        name: String,
        value: String,
    },
    /// `pub type`, or `pub use self::a as b`.
    Alias {
        name: String,
        of: Type,
    },
    Record {
        union: bool,
        name: String,
        fields: Vec<(String, Type)>,
    },
    Function {
        name: String,
        signature: Signature,
    },
    Static {
        name: String,
        of: Type,
    },
    Layout(Layout),
}

/// Line of bindgen's layout assertions.
#[derive(Debug)]
pub(crate) enum Layout {
    Size { of: String, bytes: usize },
    Alignment { of: String, bytes: usize },
    Offset { of: String, field: String, bytes: usize },
}

/// Returns all declarations of the bindings, in order.
pub(crate) fn items(text: &str) -> Vec<Item> {
    let mut tokens = Tokens { rest: text };
    let mut items = Vec::new();
    while let Some(token) = tokens.next_if_any() {
        match token {
            "#" => tokens.skip_brackets(),
            "pub" => items.push(public(&mut tokens)),
            "unsafe" => tokens.expect(&["extern", "\"C\"", "{"]),
            "const" => tokens.expect(&["_", ":", "(", ")", "=", "{"]),
            "[" => items.push(Item::Layout(layout(&mut tokens))),
            "}" | ";" => {}
            other => {
                panic!("the bindings have an item that this parser does not know, at {other:?} {:.60}", tokens.rest)
            }
        }
    }
    items
}

fn public(tokens: &mut Tokens<'_>) -> Item {
    match tokens.next() {
        "const" => {
            let name = tokens.word();
            tokens.expect(&[":"]);
            tokens.take("&"); // a string is a reference to its bytes
            let _type = of(tokens);
            tokens.expect(&["="]);
            Item::Constant { name, value: tokens.until(";") }
        }
        "type" => {
            let name = tokens.word();
            tokens.expect(&["="]);
            Item::Alias { name, of: of(tokens) }
        }
        "use" => {
            tokens.expect(&["self", "::"]);
            let of = Type::Named(tokens.word());
            tokens.expect(&["as"]);
            Item::Alias { name: tokens.word(), of }
        }
        kind @ ("struct" | "union") => {
            let name = tokens.word();
            tokens.expect(&["{"]);
            Item::Record { union: kind == "union", name, fields: fields(tokens) }
        }
        "fn" => {
            let name = tokens.word();
            Item::Function { name, signature: signature(tokens) }
        }
        "static" => {
            tokens.expect(&["mut"]);
            let name = tokens.word();
            tokens.expect(&[":"]);
            Item::Static { name, of: of(tokens) }
        }
        other => {
            panic!("the bindings have a public item that this parser does not know: {other:?} {:.60}", tokens.rest)
        }
    }
}

fn fields(tokens: &mut Tokens<'_>) -> Vec<(String, Type)> {
    let mut fields = Vec::new();
    while !tokens.take("}") {
        while tokens.take("#") {
            tokens.skip_brackets();
        }
        tokens.expect(&["pub"]);
        let name = tokens.word();
        tokens.expect(&[":"]);
        fields.push((name, of(tokens)));
        tokens.take(",");
    }
    fields
}

/// Parses a signature from `(` on.
fn signature(tokens: &mut Tokens<'_>) -> Signature {
    tokens.expect(&["("]);
    let mut parameters = Vec::new();
    let mut variadic = false;
    while !tokens.take(")") {
        if tokens.take("...") {
            variadic = true;
            continue;
        }
        let _name = tokens.word();
        tokens.expect(&[":"]);
        parameters.push(of(tokens));
        tokens.take(",");
    }
    let result = tokens.take("->").then(|| Box::new(of(tokens)));
    Signature { parameters, variadic, result }
}

fn of(tokens: &mut Tokens<'_>) -> Type {
    match tokens.next() {
        "*" => {
            let constant = match tokens.next() {
                "const" => true,
                "mut" => false,
                other => panic!("a pointer to {other:?}"),
            };
            Type::Pointer { constant, to: Box::new(of(tokens)) }
        }
        "[" => {
            let element = Box::new(of(tokens));
            tokens.expect(&[";"]);
            let length = number(tokens.next());
            tokens.expect(&["]"]);
            Type::Array(element, length)
        }
        first => {
            let mut last = if first == "::" { tokens.next() } else { first };
            while tokens.take("::") {
                last = tokens.next();
            }
            if last != "Option" {
                return Type::Named(last.to_owned());
            }
            tokens.expect(&["<", "unsafe", "extern", "\"C\"", "fn"]);
            let signature = signature(tokens);
            tokens.take(",");
            tokens.expect(&[">"]);
            Type::Function(signature)
        }
    }
}

/// `["Offset of field: mjModel_::nq"][::core::mem::offset_of!(mjModel_, nq) - 0usize];`
fn layout(tokens: &mut Tokens<'_>) -> Layout {
    let what = tokens.next().trim_matches('"').to_owned();
    tokens.expect(&["]", "["]);
    let difference = tokens.until(";");
    let bytes = difference.rsplit(' ').find(|word| word.ends_with("usize")).map(number).expect("a number of bytes");
    if let Some(of) = what.strip_prefix("Size of ") {
        Layout::Size { of: of.to_owned(), bytes }
    } else if let Some(of) = what.strip_prefix("Alignment of ") {
        Layout::Alignment { of: of.to_owned(), bytes }
    } else if let Some((of, field)) = what.strip_prefix("Offset of field: ").and_then(|name| name.split_once("::")) {
        Layout::Offset { of: of.to_owned(), field: field.to_owned(), bytes }
    } else {
        panic!("the bindings have a layout assertion that this parser does not know: {what}")
    }
}

fn number(token: &str) -> usize {
    token.trim_end_matches("usize").parse().unwrap_or_else(|_| panic!("{token} is no number"))
}

/// Tokeniser: words, strings and punctuation.
struct Tokens<'a> {
    rest: &'a str,
}

impl<'a> Tokens<'a> {
    fn skip_blanks(&mut self) {
        loop {
            self.rest = self.rest.trim_start();
            let end = match self.rest.get(..2) {
                Some("//") => self.rest.find('\n').unwrap_or(self.rest.len()),
                Some("/*") => self.rest.find("*/").map_or(self.rest.len(), |at| at + 2),
                _ => return,
            };
            self.rest = &self.rest[end..];
        }
    }

    fn next_if_any(&mut self) -> Option<&'a str> {
        self.skip_blanks();
        let first = self.rest.chars().next()?;
        let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
        let length = if is_word(first) {
            self.rest.find(|c| !is_word(c)).unwrap_or(self.rest.len())
        } else if first == '"' {
            let mut escaped = false;
            let ends = |c: char| {
                let ends = c == '"' && !escaped;
                escaped = c == '\\' && !escaped;
                ends
            };
            self.rest[1..].find(ends).expect("a string ends") + 2
        } else if self.rest.starts_with("::") || self.rest.starts_with("->") {
            2
        } else {
            first.len_utf8()
        };
        let (token, rest) = self.rest.split_at(length);
        self.rest = rest;
        Some(token)
    }

    fn next(&mut self) -> &'a str {
        self.next_if_any().expect("the bindings go on")
    }

    fn word(&mut self) -> String {
        self.next().to_owned()
    }

    /// Consumes `token` if it is next.
    fn take(&mut self, token: &str) -> bool {
        let before = self.rest;
        let taken = self.next_if_any() == Some(token);
        if !taken {
            self.rest = before;
        }
        taken
    }

    #[track_caller]
    fn expect(&mut self, tokens: &[&str]) {
        for expected in tokens {
            assert_eq!(self.next(), *expected, "before {:.60}", self.rest);
        }
    }

    /// Returns the tokens before `end`, separated by blanks.
    fn until(&mut self, end: &str) -> String {
        let mut words = Vec::new();
        loop {
            match self.next() {
                token if token == end => return words.join(" "),
                token => words.push(token),
            }
        }
    }

    /// Skips an attribute's brackets, which may be nested.
    fn skip_brackets(&mut self) {
        let mut depth = 0_u32;
        loop {
            match self.next() {
                "[" => depth += 1,
                "]" if depth == 1 => return,
                "]" => depth -= 1,
                _ => {}
            }
        }
    }
}
