//! Lookup of the documentation of the engine's fields.

#![forbid(unsafe_code)]

use std::collections::HashSet;

use mujoco_safe::model::{FieldDoc, Statistics, Visual};
use mujoco_safe::{Data, Error, Model, Options};

/// The two functions of a struct.
struct Docs {
    of: fn(&str) -> mujoco_safe::Result<String>,
    all: Vec<FieldDoc>,
}

fn structures() -> [Docs; 5] {
    [
        Docs { of: Model::field_docs, all: Model::fields().collect() },
        Docs { of: Data::field_docs, all: Data::fields().collect() },
        Docs { of: Options::field_docs, all: Options::fields().collect() },
        Docs { of: Visual::field_docs, all: Visual::fields().collect() },
        Docs { of: Statistics::field_docs, all: Statistics::fields().collect() },
    ]
}

#[test]
fn every_listed_field_is_found_by_its_name() {
    for Docs { of, all } in structures() {
        for field in &all {
            assert_eq!(of(field.name).unwrap(), format!("{}: {}", field.name, field.docs));
        }
        let names: HashSet<_> = all.iter().map(|field| field.name).collect();
        assert_eq!(names.len(), all.len());
    }
}

#[test]
fn shapes_consist_of_numbers_and_sizes_of_the_model() {
    let sizes: HashSet<_> = Model::fields().filter(|field| !field.is_array).map(|field| field.name).collect();
    for field in structures().iter().flat_map(|docs| &docs.all) {
        for factor in field.rows.split('*').chain(field.columns.split('*')) {
            let known = factor.parse::<usize>().is_ok() || sizes.contains(factor) || factor.starts_with("mjN");
            assert!(known, "{field}: {factor}");
        }
        assert_eq!(field.shape().is_empty(), !field.is_array, "{field}");
    }
    let shape = |name| Data::fields().find(|field| field.name == name).unwrap().shape();
    assert_eq!([shape("qpos"), shape("xpos"), shape("time"), shape("energy")], ["(nq)", "(nbody, 3)", "", "(2)"]);
}

#[test]
fn a_wrong_name_suggests_similar_names() {
    let error = Model::field_docs("nvv").unwrap_err();
    assert!(matches!(&error, Error::NoSuchField { structure: "Model", name, .. } if name == "nvv"));
    assert!(error.to_string().starts_with("mjModel has no field 'nvv', did you mean 'nv'"), "{error}");

    let near = |result: mujoco_safe::Result<String>| match result.unwrap_err() {
        Error::NoSuchField { near, .. } => near,
        error => panic!("{error}"),
    };
    assert_eq!(near(Visual::field_docs("fovy")), ["global.fovy"]);
    assert_eq!(near(Options::field_docs("disable")), ["disableflags"]);
    assert_eq!(near(Data::field_docs("geom_pos"))[0], "geom_xpos");
    assert_eq!(near(Statistics::field_docs("centre")), ["center"]);
    assert_eq!(near(Data::field_docs("")), [""; 0]);
    assert_eq!(
        Data::field_docs("quite another thing").unwrap_err().to_string(),
        "mjData has no field 'quite another thing'"
    );
}

#[test]
fn a_field_of_another_struct_is_an_error_that_names_the_struct() {
    for (result, text) in [
        (
            Model::field_docs("geom_xpos"),
            "mjModel has no field 'geom_xpos': it is a field of mjData, see Data::field_docs",
        ),
        (Data::field_docs("nv"), "mjData has no field 'nv': it is a field of mjModel, see Model::field_docs"),
        (
            Model::field_docs("timestep"),
            "mjModel has no field 'timestep': it is a field of mjOption, see Options::field_docs",
        ),
        (
            Options::field_docs("extent"),
            "mjOption has no field 'extent': it is a field of mjStatistic, see Statistics::field_docs",
        ),
        (
            Data::field_docs("map.znear"),
            "mjData has no field 'map.znear': it is a field of mjVisual, see Visual::field_docs",
        ),
    ] {
        let error = result.unwrap_err();
        assert!(matches!(error, Error::NoSuchField { owner: Some(_), .. }));
        assert_eq!(error.to_string(), text);
    }
}
