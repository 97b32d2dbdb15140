//! Texts with extreme and contradictory values of all elements and attributes of the linked engine.

use std::sync::OnceLock;

use super::document::Node;
use super::flexes;
use super::schema::{self, Attribute, Element};
use super::{rig, specimens, values};

/// Numbers that are extreme as a real, an integer, a size or an index.
const NUMBERS: [&str; 30] = [
    "0",
    "-1",
    "1",
    "2",
    "3",
    "0.5",
    "-0.001",
    "1e-9",
    "1e-300",
    "1e-320",
    "1e300",
    "-1e300",
    "1e308",
    "nan",
    "inf",
    "-inf",
    "100",
    "1000",
    "10001",
    "32768",
    "46341",
    "65536",
    "1000000",
    "16777217",
    "2147483647",
    "2147483648",
    "-2147483648",
    "4294967297",
    "1e15",
    "1.5",
];

const WORDS: [&str; 10] = ["", " ", "x", "world", "0", "true", "auto", "none", "extra", "é\u{1F600}"];

/// Returns the elements of the linked engine's schema.
fn elements() -> &'static [Element] {
    static ELEMENTS: OnceLock<Vec<Element>> = OnceLock::new();
    ELEMENTS.get_or_init(schema::elements)
}

/// Returns a word of the list above or the name of an element, such as `frame`, which some
/// attributes take for the type of an object.
fn word(below: &mut dyn FnMut(usize) -> usize) -> &'static str {
    if below(2) == 0 {
        return WORDS[below(WORDS.len())];
    }
    let path = &elements()[below(elements().len())].path;
    path.rsplit('/').next().unwrap_or(path)
}

/// Returns a text. `below` returns a number below its argument, or 0, and decides everything.
pub fn hostile(below: &mut dyn FnMut(usize) -> usize) -> String {
    let elements = elements();
    let mut document = rig();
    if below(8) == 0 && elements.iter().any(|element| element.path == "deformable/flex") {
        flexes::insert(&mut document, elements, below);
        return document.text();
    }
    // Half of the texts have one extreme number or word and are valid otherwise, because the
    // compiler rejects most of the others.
    if below(2) == 0 {
        one_extreme(&mut document, &elements[below(elements.len())], below);
        return document.text();
    }
    for _ in 0..=below(3) {
        let element = &elements[below(elements.len())];
        let all = specimens::of(&element.path);
        let specimen = &all[below(all.len())];
        specimen.insert(&mut document);
        let names = document.clone();
        let node = specimen.find(&mut document, &element.path);
        if element.attributes.is_empty() {
            continue;
        }
        for _ in 0..below(4) {
            let name = element.attributes[below(element.attributes.len())].clone();
            let attribute = Attribute { element: element.path.clone(), name };
            let candidates = values::candidates(&attribute, &names);
            let sensible = candidates.get(below(candidates.len())).cloned().unwrap_or_default();
            let value = if below(2) == 0 { sensible } else { extreme(&sensible, below) };
            node.set(&attribute.name, &value);
        }
    }
    for _ in 0..below(3) {
        damage(&mut document, below);
    }
    document.text()
}

/// Inserts an element with a sensible value of an attribute, in which one word is extreme.
fn one_extreme(document: &mut Node, element: &Element, below: &mut dyn FnMut(usize) -> usize) {
    let Element { path, attributes, .. } = element;
    let all = specimens::of(path);
    let specimen = &all[below(all.len())];
    specimen.insert(document);
    if attributes.is_empty() {
        return;
    }
    let attribute = Attribute { element: path.clone(), name: attributes[below(attributes.len())].clone() };
    let candidates = values::candidates(&attribute, document);
    let sensible = candidates.get(below(candidates.len())).cloned().unwrap_or_default();
    let mut words: Vec<&str> = sensible.split_whitespace().collect();
    let numbers: Vec<usize> = (0..words.len()).filter(|&at| words[at].parse::<f64>().is_ok()).collect();
    let at = below(words.len());
    if let Some(&at) = numbers.get(below(numbers.len())) {
        words[at] = NUMBERS[below(NUMBERS.len())];
    } else if at < words.len() {
        words[at] = word(below);
    }
    specimen.find(document, path).set(&attribute.name, &words.join(" "));
}

/// Returns a value similar to another, with an extreme part.
fn extreme(value: &str, below: &mut dyn FnMut(usize) -> usize) -> String {
    let mut words: Vec<&str> = value.split_whitespace().collect();
    let at = below(words.len());
    let is_number = words.get(at).is_some_and(|word| word.parse::<f64>().is_ok());
    match below(12) {
        0 => return String::new(),
        1 => words.truncate(at),
        2 => words.extend(words.clone()),
        3 => return "a".repeat(10_000),
        4 => return "1 ".repeat(1 + below(1000)),
        5 => words = vec![NUMBERS[below(NUMBERS.len())]; words.len()],
        6 => return word(below).to_owned(),
        _ if words.is_empty() => return NUMBERS[below(NUMBERS.len())].to_owned(),
        _ => words[at] = if is_number { NUMBERS[below(NUMBERS.len())] } else { word(below) },
    }
    words.join(" ")
}

/// Damages an attribute or the structure.
fn damage(document: &mut Node, below: &mut dyn FnMut(usize) -> usize) {
    let mut count = 0;
    document.visit(&mut |_| count += 1);
    let (chosen, kind) = (below(count), below(8));
    let other = {
        let (chosen, mut index, mut other) = (below(count), 0, None);
        document.visit(&mut |node| {
            if index == chosen {
                other = Some(node.clone());
            }
            index += 1;
        });
        other.expect("the index is below the number of nodes")
    };
    let mut index = 0;
    document.visit_mut(&mut |node| {
        index += 1;
        if index - 1 != chosen {
            return;
        }
        match kind {
            0 => node.children.push(other.clone()),
            1 => {
                let at = below(node.children.len());
                node.children.extend(node.children.get(at).cloned());
            }
            2 => {
                let at = below(node.children.len());
                node.children.drain(at..(at + 1).min(node.children.len()));
            }
            3 if matches!(&node.name[..], "body" | "worldbody") => {
                let mut replicate = Node::new("replicate");
                replicate.set("count", ["2", "3", "0", "-1", "1000000"][below(5)]);
                replicate.set("offset", "0.1 0 0");
                replicate.children = std::mem::take(&mut node.children);
                let mut outer = Node::new(["replicate", "frame"][below(2)]);
                outer.set("count", "3");
                outer.children.push(replicate);
                node.children.push(outer);
            }
            _ => {
                let at = below(node.attributes.len());
                if let Some((_, value)) = node.attributes.get_mut(at) {
                    *value = extreme(value, below);
                }
            }
        }
    });
}
