//! Inputs that are rejected, and similar ones that are accepted.

use super::{Files, check};

fn message(text: &str) -> String {
    check("the text", text.as_bytes(), &Files::default()).map_or_else(|error| error.to_string(), |_| String::new())
}

#[test]
fn the_check_does_not_panic_on_any_part_of_a_text() {
    let text = b"<mujoco><mesh vertex='0 0 0' face = \"0 1 2\"/><!-- a --><include file='/x/'/><a/ b=/></mujoco>";
    for end in 0..text.len() {
        for start in 0..end {
            let _ = check("", &text[start..end], &Files::default());
        }
    }
}

#[test]
fn unsafe_inputs_are_rejected_with_their_line() {
    for (text, expected) in [
        ("<mujoco>\n<include file=''/></mujoco>", "is empty after its last slash, line 2"),
        ("<mujoco><include\x0bfile\x0b=\x0b''/></mujoco>", "is empty after its last slash"),
        ("<mujoco><include file='a&#47;'/></mujoco>", "is empty after its last slash"),
        ("<mujoco><include file='a/&#0;'/></mujoco>", "invalid character reference"),
        ("<mujoco><include file='a/&#9999999;'/></mujoco>", "invalid character reference"),
        ("<mujoco><mesh file='a/b'/></mujoco>", "too short for an extension"),
        ("<mujoco><skin file='sk'/></mujoco>", "too short for an extension"),
        ("<mujoco><texture fileup='abc'/></mujoco>", "too short for an extension"),
        ("<mujoco><hfield file='a'/></mujoco>", "too short for an extension"),
        ("<mujoco>\0</mujoco>", "NUL byte"),
        ("<mujoco><include file='/dev/null'/></mujoco>", "regular file"),
        ("<mesh vertex='0 0 0 1 0 0 0 1 0' face='0 1 3'/>", "0 to 2"),
        ("<mesh vertex='0 0 0 1 0 0 0 1 0' face='0 1 -1'/>", "0 to 2"),
        ("<texture width='50000' height='50000'/>", "a texture is too large"),
        ("<texture type='2d' builtin='flat' nchannel='1'/>", "3 or 4 channels"),
        ("<texture file='grey.png' nchannel='1'/>", "3 or 4 channels"),
        ("<hfield nrow='50000' ncol='50000'/>", "a height field is too large"),
        ("<composite count='1000 1000 1'/>", "32766 bodies"),
        ("<composite count='&#49;000 1000 1'/>", "32766 bodies"),
        ("<flexcomp count='1000 1000 1'/>", "32766 bodies"),
        ("<flexcomp count='3 3 46341' dof='trilinear'/>", "a flex is too large"),
        ("<flexcomp count='2 2 2' dof='quadratic' cellcount='1000 1000 1000'/>", "a flex is too large"),
        #[cfg(not(engine_since = "3.17.0"))]
        ("<material><layer texture='t' role='x'/></material>", "the role of a layer must be one of rgb, occlusion"),
        #[cfg(all(engine_since = "3.2.0", not(engine_since = "3.17.0")))]
        (
            "<default><default class='c'><joint type='ball'/></default></default><joint type='hinge'/><replicate/>",
            "state the types in the joints only",
        ),
        #[cfg(not(engine_since = "3.17.0"))]
        ("<flexcomp type='box' count='3 1 3'/>", "must be at least 2"),
        ("<flexcomp dof='trilinear' cellcount='2 0 1'/>", "cellcount must not be 0"),
        ("<flex dof='trilinear' cellcount='2 715827883 1'/>", "a flex is too large"),
        #[cfg(not(engine_since = "4.0.0"))]
        ("<flexcomp type='box' dof='trilinear'><pin gridrange='0 0 0 9 9 9'/></flexcomp>", "flexcomp of type grid"),
        #[cfg(not(engine_since = "4.0.0"))]
        (
            "<flexcomp type='mesh' dof='trilinear'>\n<pin id='0' grid='1 1 1'/></flexcomp>",
            "type grid; use id or range, line 2",
        ),
        ("<hfield nrow='-4294917296' ncol='50000'/>", "a height field is too large"),
        ("<mesh file='a.stl'><plugin/></mesh>", "either a file or a plugin"),
        (
            "<mesh file='a.stl'>\n<plugin plugin='p'><config key='a'/></plugin></mesh>",
            "either a file or a plugin, line 2",
        ),
        ("<flexcomp><plugin/></flexcomp>", "needs the attribute plugin or instance"),
        ("<flexcomp><edge/><plugin plugin=''></plugin></flexcomp>", "needs the attribute plugin or instance"),
        ("<size njmax='&#53;'/><adhesion body='b'/>", "adhesion needs an njmax"),
        ("<size njmax='5.5'/><adhesion body='b'/>", "adhesion needs an njmax"),
        ("<size njmax='4294967301'/><adhesion body='b'/>", "adhesion needs an njmax"),
        ("<hfield nrow='3' ncol='2'/><geom hfield='h'/><rangefinder/>", "3 rows and 2 columns"),
        ("<hfield nrow='1' ncol='2'/><geom hfield='h'/><rangefinder/>", "1 rows and 2 columns"),
        ("<hfield nrow='1e1' ncol='5'/><geom hfield='h'/><rangefinder/>", "1 rows and 5 columns"),
    ] {
        let message = message(text);
        assert!(message.contains(expected), "{text}: {message}");
    }
}

#[test]
fn valid_texts_are_accepted() {
    for text in [
        crate::sample::CARTPOLE_XML,
        crate::sample::HUMANOID_XML,
        "<mujoco><!-- <include file=''/> --></mujoco>",
        "<mesh vertex='0 0 0 1 0 0 0 1 0 0 0 1' face='0 1 2\n1 2 3'/>",
        "<size njmax='100'/><adhesion body='b'/>",
        "<size njmax='-1'/><adhesion body='b'/>",
        "<hfield nrow='3' ncol='3'/><geom hfield='h'/><rangefinder/>",
        "<hfield nrow='3' ncol='2'/><geom hfield='h'/>",
        "<hfield nrow='3' ncol='2'/><rangefinder/>",
        "<mesh file='a.stl'/><plugin/><mesh file='a.stl'></mesh><plugin/><mesh name='m'><plugin/></mesh>",
        "<flexcomp><plugin plugin='a'/></flexcomp><plugin/><flexcomp/><plugin/>",
        "<flexcomp type='box'><pin id='0'/></flexcomp><flexcomp type='grid'><pin grid='1 1 1'/></flexcomp>",
        "<flexcomp dof='trilinear' cellcount='2 1 1'/>",
        "<flexcomp type='grid' count='3 1 1'/><flexcomp type='box' count='3 3 2'/>",
        "<default><joint type='ball'/></default><joint type='free'/><joint/><joint type='ball'/><key/>",
        "<default><joint type='hinge'/></default><joint type='ball'/><joint type='hinge'/><key/>",
        "<default><joint type='ball'/></default><joint type='hinge'/>",
        "<extension><plugin plugin='a'><instance name='i'/></plugin></extension><plugin plugin='a' instance='i'/>",
        "<compiler meshdir='parts'/><hfield file='a'/>",
        "<texture file='&#97;.png'/>",
        "<texture type='skybox' builtin='gradient' width='512' height='3072'/>",
    ] {
        assert_eq!(message(text), "");
    }
}

#[test]
#[cfg(all(engine_since = "2.3.0", not(engine_since = "3.17.0")))]
fn references_to_missing_instances_of_plugins_are_rejected() {
    let text =
        "<extension><plugin plugin='a'><instance name='i'/></plugin></extension><plugin plugin='a' instance='j'/>";
    assert!(message(text).contains("the plugin instance 'j' does not exist"));
}
