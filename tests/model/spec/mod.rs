//! Models in code, compared with texts that the engine compiles itself.

mod alone;
mod angles;
#[cfg(feature = "mjz")]
mod archive;
mod attach;
mod building;
mod counts;
mod defaults;
mod editing;
mod engine_spec;
mod expanded;
mod generated;
mod kept;
mod keyframes;
mod keyframes_generated;
mod keyframes_order;
mod moved;
mod names;
mod operations;
mod oracle;
mod random;
mod reading;
mod removal;
mod settings;
mod text;
mod urdf;

use mujoco_safe::Model;
use mujoco_safe::spec::{Any, ElementId, Spec};

/// Checks that a spec compiles to the same bytes as a text.
#[track_caller]
fn same(spec: &Spec, text: &str) {
    let expected = Model::from_xml_str(text).unwrap();
    let compiled = spec.compile().unwrap_or_else(|error| panic!("{error}\n{}", spec.to_xml()));
    assert!(super::bytes(&compiled) == super::bytes(&expected), "differs:\n{}\nfrom:\n{text}", spec.to_xml());
}

fn parse(text: &str) -> Spec {
    Spec::from_xml_str(text).unwrap()
}

/// Returns all elements in the order of the text.
fn elements(spec: &Spec) -> Vec<ElementId<Any>> {
    let mut found = vec![spec.element(spec.world()).parent().unwrap()];
    let mut open = vec![spec.element(found[0]).children()];
    while let Some(children) = open.last_mut() {
        match children.next() {
            Some(id) => {
                found.push(id);
                open.push(spec.element(id).children());
            }
            None => drop(open.pop()),
        }
    }
    found
}
