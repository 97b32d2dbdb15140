//! Names and texts are data, and the page runs only its own program.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use mujoco_safe::html::{HtmlOptions, Signal};
use mujoco_safe::{Data, Model, Trajectory, sample};

use crate::page::{Page, saved, unpacked};

pub const HOSTILE: [&str; 4] = [
    "</script><script>globalThis.hacked = 1</script>",
    "<img src=x onerror=globalThis.hacked=1>",
    "\" autofocus onfocus=globalThis.hacked=1 x=\"",
    "<!--<script>",
];

/// Returns a model whose every name is hostile, and a page of it.
pub fn hostile() -> (Model, Trajectory, HtmlOptions) {
    let escaped = |index: usize| HOSTILE[index].replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
    let [a, b, c, d] = [0, 1, 2, 3].map(escaped);
    let model = Model::from_xml_str(&format!(
        "<mujoco model=\"{a}\"><worldbody><light name=\"{d}\" pos='0 0 3'/>
           <camera name=\"{a}\" pos='0 -2 .5' xyaxes='1 0 0 0 .2 1'/>
           <body name=\"{b}\"><joint name=\"{a}\"/><geom name=\"{a}\" size='.3' rgba='.8 .3 .2 1'/>
             <site name=\"{c}\" size='.31 .1 .1' type='box'/></body></worldbody>
           <actuator><motor name=\"{c}\" joint=\"{a}\"/></actuator>
           <sensor><jointpos name=\"{d}\" joint=\"{a}\"/></sensor></mujoco>"
    ))
    .unwrap();
    let mut data = Data::new(model.clone()).unwrap();
    let mut trajectory = Trajectory::new(&model);
    trajectory.record(&mut data, &mut mujoco_safe::RandomController::new(1), 600).unwrap();
    let [a, _, c, d] = HOSTILE;
    let options = HtmlOptions::default()
        .with_title(a)
        .with_signals([Signal::Qpos(a.into()), Signal::Ctrl(c.into()), Signal::Sensor(d.into())])
        .with_notes([(0.1, a.into()), (0.2, HOSTILE[1].into())]);
    (model, trajectory, options)
}

fn page_of_hostile() -> Page {
    let (model, trajectory, options) = hostile();
    saved(&model, &[(HOSTILE[0], &trajectory), (HOSTILE[1], &trajectory)], &options)
}

#[test]
fn texts_of_a_model_are_only_in_the_encoded_data() {
    let hostile = page_of_hostile();
    let model = sample::cartpole();
    let mut trajectory = Trajectory::new(&model);
    trajectory.push(&Data::new(model.clone()).unwrap()).unwrap();
    let other = saved(&model, &[("", &trajectory)], &HtmlOptions::default());
    assert_eq!(hostile.around_data(), other.around_data(), "the rest of a page depends on no model");
    for text in HOSTILE {
        assert!(!hostile.text.contains(text));
    }
    // The texts arrive unchanged.
    assert_eq!(hostile.description["title"], HOSTILE[0]);
    assert_eq!(hostile.description["bodies"][1], HOSTILE[1]);
    assert_eq!(hostile.description["notes"][0][1], HOSTILE[0]);
    assert_eq!(hostile.description["tracks"][1]["label"], HOSTILE[1]);
}

#[test]
fn the_policy_allows_only_the_scripts_and_the_style_of_the_page() {
    let text = page_of_hostile().text;
    let policy = text.split_once("Content-Security-Policy\" content=\"").unwrap().1.split_once('"').unwrap().0;
    let directives: Vec<&str> = policy.split("; ").collect();
    assert!(directives.contains(&"default-src 'none'"), "{policy}");
    assert!(!policy.contains("unsafe") && !policy.contains("http") && !policy.contains('*'), "{policy}");
    // Chromium reports a digest that does not match as an error: scripts/try-html checks them.
    for directive in &directives {
        for digest in directive.split_whitespace().filter_map(|part| part.strip_prefix("'sha256-")) {
            assert_eq!(STANDARD.decode(digest.trim_end_matches('\'')).unwrap().len(), 32, "{directive}");
        }
    }
    assert_eq!(text.matches("<script").count(), 3);
    assert!(!text.contains("src=") && !text.contains("href="), "the page loads nothing");
}

#[test]
fn the_program_contains_the_licence_of_its_library() {
    let program = unpacked(&page_of_hostile().text, r#"<script id="program" type="text/plain">"#);
    let program = String::from_utf8(program).unwrap();
    for text in ["The MIT License", "three.js authors", "THE SOFTWARE IS PROVIDED \"AS IS\""] {
        assert!(program[..2000].contains(text), "{text}");
    }
}

#[test]
fn equal_trajectories_have_equal_pages() {
    assert_eq!(page_of_hostile().text, page_of_hostile().text);
}
