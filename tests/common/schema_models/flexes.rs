//! Flexes whose lists have independent lengths, and whose elements are open, closed or doubled
//! complexes.

use super::document::Node;
use super::schema::Element;

/// Bodies of the rig.
const BODIES: [&str; 5] = ["arm", "host", "hand", "crate", "loose"];

/// Inserts a flex or `flexcomp`. `below` returns a number below its argument, or 0, and decides
/// everything.
pub fn insert(document: &mut Node, elements: &[Element], below: &mut dyn FnMut(usize) -> usize) {
    let is_direct = below(2) == 0;
    let path = if is_direct { "body/flexcomp" } else { "deformable/flex" };
    let known = elements.iter().find(|element| element.path == path);
    let dim = 1 + below(3);
    let element = complex(dim, below);
    let vertices = element.iter().max().map_or(0, |last| last + 1);
    let mut node = Node::new(if is_direct { "flexcomp" } else { "flex" });
    let mut set = |name: &str, words: Vec<String>| {
        if known.is_some_and(|known| known.attributes.iter().any(|attribute| attribute == name)) && !words.is_empty() {
            node.set(name, &words.join(" "));
        }
    };
    let coordinates = |count: usize| (0..count).map(|at| format!("{}", (at * at % 11) as f64 / 10.0)).collect();
    let names = |count: usize| (0..count).map(|at| BODIES[at % BODIES.len()].to_owned()).collect();
    let word = |word: &str| vec![word.to_owned()];
    set("name", word("lists"));
    set("dim", word(["1", "2", "3", "0"][if below(8) == 0 { below(4) } else { dim - 1 }]));
    set("radius", word("0.01"));
    // A texture in the text is likely, because it has the most lists.
    let texcoords = if below(2) == 0 { near(vertices, below) } else { 0 };
    set("texcoord", coordinates(2 * texcoords + usize::from(below(16) == 0)));
    let has_dof = below(4) == 0;
    if has_dof {
        set("dof", word(["trilinear", "quadratic", "radial", "2d"][below(4)]));
    }
    if below(8) == 0 {
        set("cellcount", (0..3).map(|_| ["1", "2", "3", "-1", "-2", "0"][below(6)].to_owned()).collect());
    }
    set("element", element.iter().map(ToString::to_string).collect());
    if is_direct {
        let kinds = ["direct", "grid", "box", "mesh", "gmsh", "square"];
        set("type", word(kinds[if below(8) == 0 { below(kinds.len()) } else { 0 }]));
        set("point", coordinates(3 * near(vertices, below) + usize::from(below(16) == 0)));
        set("file", if below(8) == 0 { word("meshes/solid.obj") } else { Vec::new() });
        set("count", word("3 3 2"));
        set("spacing", word("0.1 0.1 0.1"));
        set("rigid", word(["true", "false", "false"][below(3)]));
        set("origin", word("0.01 0.01 0.01"));
    } else {
        let bodies = if below(6) == 0 { 1 } else { near(vertices, below) };
        set("body", names(bodies));
        set("vertex", if below(3) == 0 { Vec::new() } else { coordinates(3 * near(bodies.max(vertices), below)) });
        let nodes = if has_dof || below(8) == 0 { near([1, 8, 27][below(3)], below) } else { 0 };
        set("node", names(nodes));
        set("nodecoord", if below(3) == 0 { coordinates(3 * near(nodes, below)) } else { Vec::new() });
        if below(2) == 0 {
            let end = near(texcoords, below).max(1);
            let indices = (0..near(element.len(), below)).map(|at| (at % end).to_string());
            set("elemtexcoord", indices.collect());
        }
    }
    if below(4) > 0 {
        let mut contact = Node::new("contact");
        contact.set("selfcollide", "none");
        node.children.push(contact);
    }
    if below(4) == 0 {
        let mut elasticity = Node::new("elasticity");
        elasticity.set("young", "1000");
        node.children.push(elasticity);
    }
    if is_direct {
        let world = document.descend(["worldbody"]);
        let mut body = Node::new("body");
        body.set("name", "holder");
        body.children.push(node);
        world.children.push(body);
    } else {
        document.descend(["deformable"]).children.push(node);
    }
}

/// Returns a number that is most likely `expected`, or a similar one.
fn near(expected: usize, below: &mut dyn FnMut(usize) -> usize) -> usize {
    match below(16) {
        0 => 0,
        1 => 1,
        2 => expected + 1,
        3 => expected.saturating_sub(1),
        4 => 2 * expected,
        5 => 40 * expected,
        _ => expected,
    }
}

/// Returns the vertices of elements of a dimension.
fn complex(dim: usize, below: &mut dyn FnMut(usize) -> usize) -> Vec<usize> {
    let corners = dim + 1;
    let boundary = |first: usize| {
        (0..=corners).flat_map(move |without| (0..=corners).filter(move |&at| at != without).map(move |at| first + at))
    };
    let strip = |count: usize, first: usize| (0..count).flat_map(move |at| (0..corners).map(move |it| first + at + it));
    let mut element: Vec<usize> = match below(4) {
        0 => boundary(0).collect(),
        1 => boundary(0).chain(strip(1 + below(3), corners + 1)).collect(),
        _ => strip(1 + below(6), 0).collect(),
    };
    match below(4) {
        0 => element.extend(element.clone()),
        1 => element.extend(element.clone().iter().rev()),
        _ => {}
    }
    match below(24) {
        0 => element.truncate(element.len() - 1),
        1 => element.extend([0, 1]),
        2 => element.push(1000),
        _ => {}
    }
    element
}
