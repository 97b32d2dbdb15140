//! The statements about the fields of models that decide where the formulas apply: they are
//! complete, and fields without a statement are not understood.

use std::collections::BTreeSet;

use mujoco_safe::derivative::{Fallback, InverseForce, LinearisationReport, TransitionMethod, TransitionOptions};
use mujoco_safe::{Data, Lineariser, Model};

#[path = "../../build/support.rs"]
mod generator;

use generator::{PARTS, generate, model_fields, statements};

const KNOWLEDGE: &str = include_str!("../../build/knowledge/derivative.tsv");

/// `mjVERSION_HEADER` and the committed field tables.
const TABLES: [(u32, &str); 7] = [
    (222, include_str!("../../mujoco-sys/fields/v2_2_2.tsv")),
    (237, include_str!("../../mujoco-sys/fields/v2_3_7.tsv")),
    (301, include_str!("../../mujoco-sys/fields/v3_0_1.tsv")),
    (337, include_str!("../../mujoco-sys/fields/v3_3_7.tsv")),
    (3_005_000, include_str!("../../mujoco-sys/fields/v3_5_0.tsv")),
    (3_017_000, include_str!("../../mujoco-sys/fields/v3_17_0.tsv")),
    (4_000_001, include_str!("../../mujoco-sys/fields/v4_0_1.tsv")),
];

/// Returns the checks of a part in generated text.
fn part<'t>(text: &'t str, name: &str) -> &'t str {
    text.split("part! {").find(|part| part.trim_start().starts_with(&format!("{name}("))).unwrap()
}

#[test]
fn every_field_of_every_engine_has_one_statement() {
    for (version, table) in TABLES {
        // `generate` panics at two statements about one field.
        let text = generate(table, KNOWLEDGE, version);
        let undecided = part(&text, "unknown").lines().filter(|line| line.contains(';'));
        assert_eq!(undecided.collect::<Vec<_>>(), [""; 0], "fields of engine {version} without a statement");
    }
}

#[test]
fn statements_name_only_fields_that_exist() {
    let fields: BTreeSet<String> =
        TABLES.iter().flat_map(|(_, table)| model_fields(table)).map(|field| field.path()).collect();
    let unknown = statements(KNOWLEDGE).into_iter().filter(|statement| !fields.contains(statement.field));
    assert_eq!(unknown.map(|statement| statement.field).collect::<Vec<_>>(), [""; 0]);
}

#[test]
fn a_field_without_a_statement_must_have_its_default() {
    let (version, table) = TABLES[6];
    let invented = "Model\tarray\tmjtNum\tjnt_flutter\tnjnt\t3\tfluttering (njnt x 3)\nModel\tsize\tint\tnflutter\t1\t1\tnumber\n\
                    Option\tscalar\tint\tflutter\t1\t1\toption\n";
    let text = generate(&format!("{table}{invented}"), KNOWLEDGE, version);
    let checks: Vec<&str> = part(&text, "unknown").lines().map(str::trim).filter(|line| line.contains(';')).collect();
    assert_eq!(checks, ["array jnt_flutter: model.njnt(), 3;", "value nflutter;", "value opt.flutter;"]);
}

#[test]
fn statements_hold_for_ranges_of_engines() {
    let line = |engines: &str| format!("head\nnq\t{engines}\t-\tany\tdefault\t-\t-\t\t");
    for (engines, expected) in [
        ("", [true; 4]),
        ("3.5.0..", [false, true, true, true]),
        ("..3.17.0", [true, true, false, false]),
        ("3.1.2..4.0.0", [false, true, true, false]),
    ] {
        let line = line(engines);
        let [statement] = &statements(&line)[..] else { panic!("one statement") };
        let versions = [222, 3_005_000, 3_017_000, 4_000_001];
        assert_eq!(versions.map(|version| statement.is_about(version)), expected, "{engines}");
    }
    assert_eq!(PARTS.len(), statements(&line(""))[0].treatments.len());
}

/// The struct of the bindings has these members that the field tables do not: the other structs,
/// memory, and flags that the engine derives from arrays.
const MEMBERS: [&str; 8] =
    ["buffer", "flg_adhesion", "flg_gravcomp", "flg_surfacevel", "opt", "signature", "stat", "vis"];

#[test]
fn field_tables_contain_every_member_of_the_bindings() {
    let committed = [
        (222, include_str!("../../mujoco-sys/src/bindings/v2_2_2.rs")),
        (3_005_000, include_str!("../../mujoco-sys/src/bindings/v3_5_0.rs")),
        (3_017_000, include_str!("../../mujoco-sys/src/bindings/v3_17_0.rs")),
        (4_000_001, include_str!("../../mujoco-sys/src/bindings/v4_0_1.rs")),
    ];
    for (version, bindings) in committed {
        let (_, table) = TABLES.into_iter().find(|(number, _)| *number == version).unwrap();
        let fields: BTreeSet<String> = model_fields(table).map(|field| field.path()).collect();
        for (name, prefix) in [("mjModel_", ""), ("mjOption_", "opt."), ("mjStatistic_", "stat.")] {
            let start = bindings.find(&format!("pub struct {name} {{")).unwrap();
            let members = bindings[start..].lines().take_while(|line| *line != "}");
            let members = members.filter_map(|line| line.trim().strip_prefix("pub ")?.split_once(':'));
            for (member, _) in members {
                let is_known = fields.contains(&format!("{prefix}{member}")) || MEMBERS.contains(&member);
                assert!(is_known, "engine {version}: {name}.{member}");
            }
        }
    }
}

fn report(xml: &str, method: TransitionMethod) -> Option<LinearisationReport> {
    let mut data = Data::new(Model::from_xml_str(xml).ok()?).unwrap();
    let options = TransitionOptions::default().with_method(method);
    Some(Lineariser::new(data.model(), options).unwrap().linear_system(&mut data).unwrap().1)
}

/// Returns a pendulum with attributes of its joint and its actuator.
fn pendulum(option: &str, joint: &str, actuator: &str) -> String {
    format!(
        r#"<mujoco><option {option}/><worldbody><body><joint name="i"/><geom size="0.1" pos="0.3 0 0"/>
             <body><joint name="j" axis="0 1 0" {joint}/><geom size="0.1" pos="0.3 0 0"/></body></body></worldbody>
           <actuator><motor joint="i"/><position joint="j" kp="3" {actuator}/></actuator></mujoco>"#
    )
}

#[test]
fn reports_name_the_field_and_the_element() {
    let not_understood = |field, element| Some(Fallback::NotUnderstood { field, element });
    let mut count = 0;
    for (option, joint, actuator, fallback, method) in [
        ("", r#"actuatorfrcrange="-1 1""#, "", not_understood("jnt_actfrclimited", 1), TransitionMethod::Columns),
        (
            r#"integrator="implicit""#,
            r#"actuatorfrcrange="-1 1""#,
            "",
            not_understood("jnt_actfrclimited", 1),
            TransitionMethod::Columns,
        ),
        ("", r#"damping="1 2 3""#, "", not_understood("dof_dampingpoly", 1), TransitionMethod::Columns),
        ("", r#"stiffness="1 2 3""#, "", not_understood("jnt_stiffnesspoly", 1), TransitionMethod::Implicit),
        ("", r#"stiffness="1" springyield="1""#, "", not_understood("nplastic", 0), TransitionMethod::Columns),
        ("", "", r#"armature="2""#, not_understood("actuator_armature", 1), TransitionMethod::Columns),
        ("", "", r#"damping="2""#, not_understood("actuator_damping", 1), TransitionMethod::Columns),
        (r#"actuatorgroupdisable="2""#, "", "", not_understood("opt.disableactuator", 0), TransitionMethod::Columns),
        (
            r#"integrator="RK4""#,
            r#"actuatorfrcrange="-1 1""#,
            "",
            Some(Fallback::RungeKutta),
            TransitionMethod::Columns,
        ),
        ("", "", "", None, TransitionMethod::Analytic),
    ] {
        let xml = pendulum(option, joint, actuator);
        let Some(used) = report(&xml, TransitionMethod::Analytic) else { continue };
        assert_eq!((used.method, used.fallback), (method, fallback), "{xml}");
        count += 1;
    }
    assert!(count >= 1);
    let text = Fallback::NotUnderstood { field: "jnt_actfrclimited", element: 1 }.to_string();
    assert_eq!(text, "the method does not understand the value of jnt_actfrclimited, element 1");
}

/// The engine cannot evaluate a touch sensor on a mesh: each step is an error, so the linearisation
/// is too.
#[cfg(engine_since = "3.17.0")]
#[test]
fn a_touch_sensor_that_the_engine_cannot_evaluate_is_an_error() {
    let model = Model::from_xml_str(
        r#"<mujoco><asset><mesh name="m" vertex="0 0 0 .3 0 0 0 .3 0 0 0 .3"/></asset><worldbody><geom type="plane" size="1 1 1"/>
             <body pos="0 0 .09"><freejoint/><geom size=".1"/><site name="s" type="mesh" mesh="m"/></body></worldbody>
             <sensor><touch site="s"/></sensor></mujoco>"#,
    );
    let mut data = Data::new(model.unwrap()).unwrap();
    assert!(matches!(data.clone().step(), Err(mujoco_safe::Error::Engine { .. })));
    let mut lineariser = Lineariser::new(data.model(), TransitionOptions::default()).unwrap();
    assert!(matches!(lineariser.linear_system(&mut data), Err(mujoco_safe::Error::Engine { .. })));
}

#[test]
fn an_edit_is_examined_again() {
    let mut data = Data::new(Model::from_xml_str(&pendulum("", "", "")).unwrap()).unwrap();
    let mut lineariser = Lineariser::new(data.model(), TransitionOptions::default()).unwrap();
    assert_eq!(lineariser.linear_system(&mut data).unwrap().1.fallback, None);
    data.edit_model(|model| model.edit_options(|options| options.noslip_iterations = 3)).unwrap();
    assert_eq!(lineariser.linear_system(&mut data).unwrap().1.fallback, Some(Fallback::NoSlip));
    // The solver without slip does not affect inverse dynamics.
    assert_eq!(lineariser.inverse_jacobians(&mut data, InverseForce::Total).unwrap().1.fallback, None);
    data.edit_model(|model| model.edit_options(|options| options.noslip_iterations = 0)).unwrap();
    assert_eq!(lineariser.linear_system(&mut data).unwrap().1.fallback, None);
}
