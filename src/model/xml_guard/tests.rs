//! Inputs that are rejected, and similar ones that are accepted.

use super::{Files, check, flexes};

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
        ("<replicate count='1000000'></replicate>", "more than 1000000 elements after its replication"),
        (
            "<replicate count='3'><replicate count='400000'></replicate></replicate>",
            "more than 1000000 elements after its replication",
        ),
        ("<replicate count='33000'><body/></replicate>", "32766 bodies"),
        (
            "<replicate count='182'><replicate count='182'><joint/></replicate></replicate>",
            "32766 bodies or 13377 degrees of freedom",
        ),
        ("<replicate count='100'><flexcomp count='30 30 30'/></replicate>", "more than 1000000 elements"),
        ("<default><texture width='5000'/></default><texture height='429497'/>", "a texture is too large"),
        ("<default><texture nchannel='100000'/></default>", "a texture is too large"),
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
        ("<flexcomp dof='trilinear' cellcount='2 0 1'/>", "cellcount must be at least 1"),
        ("<flex dof='trilinear' cellcount='2 715827883 1'/>", "a flex is too large"),
        ("<flex dof='trilinear' cellcount='1 2 5461'/>", "a flex is too large"),
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
    let numbers = |count: usize| message(&format!("<numeric data='{}'/>", "1 ".repeat(count)));
    let size = |count: usize| message(&format!("<numeric size='{count}'/>"));
    assert_eq!([numbers(500), size(500)], ["", ""]);
    for message in [numbers(501), numbers(502), size(501), size(502)] {
        assert!(message.contains("more than 500 numbers"), "{message}");
    }
}

/// Boundary of a simplex of four dimensions: each face belongs to two tetrahedra.
const CLOSED: &str = "0 1 2 3 0 1 2 4 0 1 3 4 0 2 3 4 1 2 3 4";

#[test]
fn flexes_without_a_border_are_rejected() {
    for element in ["0 1 2 3 0 1 2 3", "0 1 2 3 1 2 0 3", "0 1 2 3 3 2 1 0 0 1 2 3", CLOSED] {
        for tag in ["<flex", "<flexcomp type='direct'"] {
            let message = message(&format!("{tag} dim=' 3' element='{element}'/>"));
            assert!(message.contains("no face that belongs to only one"), "{tag} {element}: {message}");
        }
    }
    for text in [
        format!("<flex dim='3' element='{CLOSED} 5 6 7 8'/><flexcomp type='direct' dim='3' element='0 1 2 3'/>"),
        // Surfaces and lines may be closed.
        format!("<flex dim='2' element='0 1 2 0 1 2'/><flex element='{CLOSED}'/><flex dim='1' element='{CLOSED}'/>"),
    ] {
        assert_eq!(message(&text), "");
    }
}

#[test]
fn flexes_with_contradictory_lists_are_rejected() {
    const NODES: &str = "needs at least 8, the attribute vertex, and a body for each vertex";
    const TEXTURE: &str = "texcoord must have two numbers for each";
    for (text, expected) in [
        ("<flex node='a' body='a' vertex='0 0 0'/>", NODES),
        ("<flex node='a b c d e f g h' body='a' vertex='0 0 0 1 0 0'/>", NODES),
        ("<flex node='a b c d e f g h' body='a b'/>", NODES),
        (
            "<flex node='a b c d e f g h' body='a' vertex='0 0 0' nodecoord='0 0 0 1 1 1'/>",
            "three numbers for each node",
        ),
        ("<flex element='0 1 2' texcoord='0 0 1 0 1 1' elemtexcoord='0 1 2 0'/>", TEXTURE),
        ("<flex element='0 1 2' texcoord='0 0 1 0 1 1' elemtexcoord='0 1'/>", TEXTURE),
        ("<flex element='0 1 2' texcoord='0 0 1 0 1 1' elemtexcoord='0 1 3'/>", TEXTURE),
        ("<flex element='0 1 2' texcoord='0 0 1 0 1 1' elemtexcoord='0 1 -1'/>", TEXTURE),
        ("<flex element='0 1 2' texcoord='0 0 1' elemtexcoord='0 0 0'/>", TEXTURE),
        ("<flexcomp type='direct' point='0 0 0 1 0 0 0 1 0' element='0 1 2' texcoord='0 0'/>", TEXTURE),
        ("<flexcomp type='grid' element='0 1 2'/>", "only a flexcomp of type direct"),
        ("<flexcomp point='0 1 2'/>", "only a flexcomp of type direct"),
        ("<flexcomp dof='trilinear' cellcount='3 -1 -1'/>", "cellcount must be at least 1"),
        #[cfg(not(engine_since = "4.0.0"))]
        ("<flexcomp type='gmsh' file='a.msh' texcoord='0 0'/>", "without texcoord"),
        #[cfg(not(engine_since = "4.0.0"))]
        ("<mesh texcoord='0 0' vertex='0 0 0' face='0 0 0'/><flexcomp mesh='m' dim='3'/>", "must have dim 2"),
        #[cfg(not(engine_since = "3.17.0"))]
        ("<flex dim='1' element='0 1' texcoord='0 0 1 1'/>", "dim 1 need elemtexcoord"),
        (
            "<mesh vertex='0 0 0 1 0 0 0 1 0 0 -0.0 0' face='0 1 2 1 2 3'/><flexcomp mesh='m' dim='3'/>",
            "has a face twice",
        ),
    ] {
        let message = message(text);
        assert!(message.contains(expected), "{text}: {message}");
    }
    for text in [
        "<flex node='a b c d e f g h' body='a b' vertex='0 0 0 1 0 0'/><flex node='' body='a' vertex='0 0 0 1 0 0'/>",
        "<flex element='0 1 2' texcoord='0 0 1 0 1 1' elemtexcoord='0 2 2'/><flex element='0 1 2' texcoord='0 0 1 0 1 1'/>",
        "<flex node='a b c d e f g h' body='a' vertex='0 0 0'
            nodecoord='0 0 0 0 0 1 0 1 0 0 1 1 1 0 0 1 0 1 1 1 0 1 1 1'/>",
        "<flex dim='1' element='0 1' texcoord='0 0 1 1' elemtexcoord='0 1'/>",
        "<flexcomp type='direct' point='0 0 0 1 0 0 0 1 0' element='0 1 2' texcoord='0 0 1 0 1 1'/>",
        "<mesh vertex='0 0 0 1 0 0 0 1 0 0 0 1' face='0 1 2 1 2 3'/><flexcomp mesh='m' dim='3'/>",
        "<mesh vertex='0 0 0 1 0 0' face='0 1 1 0 1 1'/><flexcomp mesh='m' dim='2'/>",
        "<mesh vertex='0 0 0 1 0 0 0 1 0' face='0 1 2 0 1 2'/><flexcomp dim='3'/>",
    ] {
        assert_eq!(message(text), "");
    }
}

/// The compiler renumbers all later points for each point that no element has.
#[test]
fn flexes_with_many_unused_points_are_rejected() {
    let text =
        |points: usize| format!("<flexcomp type='direct' dim='1' element='0 1' point='{}'/>", "0 0 0 ".repeat(points));
    assert!(message(&text(320_000)).contains("too many points that no element uses"));
    assert_eq!(message(&text(310_000)), "");

    let gmsh = |points: usize| {
        let nodes = "1 0 0 0\n".repeat(points);
        let elements = "$Elements\n1\n1 1 0 1 2\n$EndElements\n";
        format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{points}\n{nodes}$EndNodes\n{elements}").into_bytes()
    };
    assert!(flexes::gmsh(&gmsh(320_000)).is_some_and(|reason| reason.contains("too many vertices")));
    assert_eq!(flexes::gmsh(&gmsh(310_000)), None);

    // In binary format, the nodes are tags and coordinates of 8 bytes each.
    let binary = |points: usize| {
        let words = |words: &[u64]| words.iter().flat_map(|word| word.to_ne_bytes()).collect::<Vec<u8>>();
        // One block: its kind is the second half of a word.
        let header = |kind: u64, count: u64| {
            let sizes = words(&[1, count, 1, count]);
            let block = [1_u32, 1, kind as u32].iter().flat_map(|word| word.to_ne_bytes()).collect();
            [b"\n".to_vec(), sizes, block, words(&[count])].concat()
        };
        let nodes = [header(0, points as u64), vec![0; 32 * points]].concat();
        let elements = [header(1, 1), words(&[1, 1, 2])].concat();
        [b"$MeshFormat\n4.1 1 8\n$Nodes", &nodes[..], b"$EndNodes\n$Elements", &elements, b"$EndElements\n"].concat()
    };
    assert!(flexes::gmsh(&binary(320_000)).is_some_and(|reason| reason.contains("too many vertices")));
    assert_eq!(flexes::gmsh(&binary(310_000)), None);
}

/// Since 2.3, the engine reads constraints for which there was no room.
#[test]
fn constraints_in_limited_memory_are_reported() {
    for (text, expected) in [
        ("<equality/>", false),
        ("<size njmax='9'/>", false),
        ("<size memory='1M'/><equality/>", true),
        ("<adhesion body='b'/><size nconmax='5'/><size/>", true),
        ("<option solver='PGS'/><option/><flexcomp/>", true),
        ("<option solver='CG'/><equality/>", false),
        ("<option noslip_iterations='1'/><equality/>", true),
    ] {
        let simulations = check("", text.as_bytes(), &Files::default()).unwrap();
        assert_eq!(simulations.may_lack_room, expected && cfg!(engine_since = "2.3.0"), "{text}");
    }
}

/// The compiler simulates actuators to find the ranges of their lengths.
#[test]
fn a_simulation_is_reported_if_an_actuator_has_the_mode() {
    for (mode, of_motor, of_muscle) in
        [("none", false, false), ("muscle", false, true), ("muscleuser", false, true), ("all", true, true)]
    {
        for (actuator, expected) in [("motor", of_motor), ("muscle", of_muscle)] {
            let text = format!("<compiler><lengthrange mode='{mode}'/></compiler><{actuator}/>");
            let simulations = check("", text.as_bytes(), &Files::default()).unwrap();
            assert_eq!(simulations.muscles.is_some(), expected, "{text}");
        }
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
        // A node for each of the 32,766 bodies that a model can have.
        "<flex dof='trilinear' cellcount='1 2 5460'/>",
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
