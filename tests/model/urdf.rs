//! URDF is untrusted text: inputs that the engine's URDF reader cannot handle are rejected.

use mujoco_safe::{Data, Error, LoadOptions, Model};

fn link(name: &str) -> String {
    format!(
        r#"<link name="{name}"><inertial><mass value="1"/>
           <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>"#
    )
}

fn joint(name: &str, kind: &str, parent: &str, child: &str) -> String {
    format!(
        r#"<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><axis xyz="0 0 1"/></joint>"#
    )
}

fn robot(content: &str) -> String {
    format!(r#"<robot name="robot">{content}</robot>"#)
}

/// Returns links `l0`, `l1`, … where `parent(i)` is the parent of link `i`.
fn tree(links: usize, kind: &str, parent: impl Fn(usize) -> usize) -> String {
    let links_text: String = (0..links).map(|i| link(&format!("l{i}"))).collect();
    let joints: String =
        (1..links).map(|i| joint(&format!("j{i}"), kind, &format!("l{}", parent(i)), &format!("l{i}"))).collect();
    robot(&(links_text + &joints))
}

fn error(xml: &str) -> String {
    match Model::from_xml_str(xml) {
        Err(error @ Error::Load { .. }) => error.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_unknown_joint_type_is_an_error_that_lists_the_known_types() {
    let ends = link("a") + &link("b");
    for root in ["robot", "ROBOT", "Robot"] {
        for kind in [
            "",
            " ",
            "Revolute",
            "REVOLUTE",
            "revolute ",
            " revolute",
            "\trevolute",
            "revolutе",
            "Spherical",
            "ball",
            "hinge",
            "slide",
            "free",
            "screw",
            "fixed\u{a0}",
            "revolute&#32;",
            "&#82;evolute",
            "revolute&quot;",
            "fixe",
            "fixedd",
        ] {
            let xml = format!("<{root} name='r'>{ends}\n{}</{root}>", joint("j", kind, "a", "b"));
            let message = error(&xml);
            assert!(message.contains("revolute, continuous, prismatic, fixed, floating, planar"), "{kind}: {message}");
            assert!(message.contains("line 4"), "{message}");
        }
    }
    let message = error(&robot(&(ends.clone() + r#"<joint name="j"><parent link="a"/><child link="b"/></joint>"#)));
    assert!(message.contains("required attribute missing: 'type'"), "{message}");
}

#[test]
fn the_known_joint_types_load_in_every_xml_spelling() {
    let ends = link("a") + &link("b");
    for (kind, nv) in [
        ("revolute", 1),
        ("continuous", 1),
        ("prismatic", 1),
        ("fixed", 0),
        ("floating", 6),
        ("planar", 3),
        ("&#114;evolute", 1),
        ("&#x66;ixed", 0),
    ] {
        let model = Model::from_xml_str(&robot(&(ends.clone() + &joint("j", kind, "a", "b")))).unwrap();
        assert_eq!(model.nv(), nv, "{kind}");
        Data::new(model).unwrap().step().unwrap();
    }
    // The reader ignores elements named `joint` elsewhere; ROS uses them in transmissions.
    let other = r#"<transmission name="t"><joint name="j"><hardwareInterface>e</hardwareInterface></joint></transmission>
                   <gazebo><joint type="no"/></gazebo><Joint type="no"/><!-- <joint type="no"/> --><mujoco><joint type="no"/></mujoco>"#;
    let model = Model::from_xml_str(&robot(&(ends + &joint("j", "revolute", "a", "b") + other))).unwrap();
    assert_eq!(model.nv(), 1);
}

#[test]
fn a_chain_of_more_than_400_joints_is_rejected_without_recursion() {
    let model = Model::from_xml_str(&tree(401, "revolute", |i| i - 1)).unwrap();
    assert_eq!(model.nv(), 400);
    for (links, kind) in [(402, "revolute"), (402, "fixed"), (20_000, "revolute"), (60_000, "fixed")] {
        let message = error(&tree(links, kind, |i| i - 1));
        assert!(message.contains("more than"), "{links}: {message}");
    }
    // With the joints in reverse order, and below a branch.
    let reversed: String =
        (1..1000).rev().map(|i| joint(&format!("j{i}"), "fixed", &format!("l{}", i - 1), &format!("l{i}"))).collect();
    let links: String = (0..1000).map(|i| link(&format!("l{i}"))).collect();
    assert!(error(&robot(&(links + &reversed))).contains("chain of more than 400 joints"));
    let comb = tree(1000, "fixed", |i| if i % 2 == 0 { i - 2 } else { i - 1 });
    assert!(error(&comb).contains("chain of more than 400 joints"));
}

#[test]
fn a_robot_with_too_many_links_is_rejected() {
    for links in [400, 1000] {
        let model = Model::from_xml_str(&tree(links, "revolute", |i| (i - 1) / 2)).unwrap();
        assert_eq!(model.nv(), links - 1);
    }
    let message = error(&tree(40_000, "fixed", |_| 0));
    assert!(message.contains("more than 32766 bodies or 13377 degrees of freedom"), "{message}");
    let message = error(&tree(13_500, "prismatic", |_| 0));
    assert!(message.contains("13377 degrees of freedom"), "{message}");
}

#[test]
fn cyclic_links_are_errors_that_name_the_link() {
    let links = link("a") + &link("b") + &link("c");
    for joints in [
        joint("j", "revolute", "a", "a"),
        joint("j", "revolute", "a", "b") + &joint("k", "fixed", "b", "a"),
        joint("j", "revolute", "a", "b") + &joint("k", "fixed", "b", "c") + &joint("l", "fixed", "c", "a"),
        joint("j", "revolute", "a", "b") + &joint("k", "fixed", "b", "&#97;"),
    ] {
        let message = error(&robot(&(links.clone() + &joints)));
        assert!(message.contains("is its own ancestor"), "{message}");
    }
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers accept some of these robots")]
fn missing_or_duplicate_parents_and_children_of_joints_are_errors() {
    let links = link("world") + &link("a") + &link("b");
    for (joints, expected) in [
        (joint("j", "revolute", "a", "world"), "joint found in world body"),
        (joint("j", "floating", "a", "world"), "joint found in world body"),
        (joint("j", "revolute", "world", "world"), "its own ancestor"),
        (joint("j", "revolute", "a", "nobody"), "parent or child missing"),
        (joint("j", "revolute", "nobody", "a"), "parent or child missing"),
        (joint("j", "revolute", "a", "b") + &joint("k", "fixed", "world", "b"), "multiple parents"),
        (joint("j", "revolute", "world", "a") + &joint("j", "revolute", "world", "b"), "repeated name"),
        (r#"<joint name="j" type="fixed"/>"#.to_owned(), "parent"),
        (
            r#"<joint name="j" type="fixed"><parent link="a"/><parent link="a"/><child link="b"/></joint>"#.to_owned(),
            "parent",
        ),
        (r#"<joint name="j" type="fixed"><parent/><child link="b"/></joint>"#.to_owned(), "link"),
        (
            r#"<joint type="fixed" name="j" type="no"><parent link="a"/><child link="b"/></joint>"#.to_owned(),
            "ATTRIBUTE",
        ),
        (link("a"), "repeated URDF name"),
    ] {
        let message = error(&robot(&(links.clone() + &joints)));
        assert!(message.contains(expected), "{joints}: {message}");
    }
    for joints in [joint("j", "fixed", "a", "world"), joint("j", "floating", "world", "a")] {
        let mut data = Data::new(Model::from_xml_str(&robot(&(links.clone() + &joints))).unwrap()).unwrap();
        data.step().unwrap();
    }
}

#[test]
fn numbers_in_urdf_are_checked_as_in_mjcf() {
    let with = |inertial: &str, dynamics: &str| {
        let b = format!(r#"<link name="b"><inertial>{inertial}</inertial></link>"#);
        let joint = joint("j", "revolute", "a", "b").replace("</joint>", &format!("{dynamics}</joint>"));
        Model::from_xml_str(&robot(&(link("a") + &b + &joint)))
    };
    let inertia = r#"<mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>"#;
    with(inertia, r#"<limit lower="-1" upper="1" effort="2"/><dynamics damping="1" friction="1"/>"#).unwrap();
    for (inertial, dynamics) in [
        (inertia.replace("\"1\"", "\"1e300\"").replace("\"0\"", "\"1e300\""), ""),
        (inertia.replace("mass value=\"1\"", "mass value=\"-1\""), ""),
        (inertia.replace("mass value=\"1\"", "mass value=\"x\""), ""),
        (inertia.to_owned(), r#"<axis xyz="0 0 0"/>"#),
    ] {
        with(&inertial, dynamics).unwrap_err();
    }
    // Values that are not finite load, as they do from MJCF, and a step reports them.
    for (inertial, dynamics) in [
        (inertia.to_owned(), r#"<dynamics damping="nan"/>"#),
        (inertia.replace("mass value=\"1\"", "mass value=\"nan\""), ""),
    ] {
        if let Ok(model) = with(&inertial, dynamics) {
            let mut data = Data::new(model).unwrap();
            let _ = data.step();
        }
    }
}

/// Returns a folder with two packages, whose meshes `part.obj` differ in size, and a URDF that
/// names both.
fn workspace() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    for (package, size) in [("arm", 1.0), ("hand", 2.0)] {
        let meshes = folder.path().join(package).join("meshes");
        std::fs::create_dir_all(&meshes).unwrap();
        let text = format!("v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nv 0 0 {size}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
        std::fs::write(meshes.join("part.obj"), text).unwrap();
    }
    let link = |name: &str, uri: &str| {
        format!(
            r#"<link name="{name}"><visual><geometry><mesh filename="package://nowhere/{name}.dae"/></geometry></visual>
               <collision><geometry><mesh filename="{uri}"/></geometry></collision></link>"#
        )
    };
    let links = link("a", "package://arm/meshes/part.obj") + &link("b", "package://h&#97;nd/meshes/part.obj");
    let urdf = robot(&(links + &joint("j", "revolute", "a", "b")));
    (folder, urdf)
}

/// Returns the lengths of the meshes' short edges in ascending order. (The compiler moves vertices
/// to the inertia frame.)
fn edges(model: &Model) -> Vec<f64> {
    let mut edges: Vec<f64> = (0..model.nmesh())
        .map(|mesh| {
            let (start, count) = (model.mesh_vertadr()[mesh] as usize, model.mesh_vertnum()[mesh] as usize);
            let vertices = &model.mesh_vert()[start..start + count];
            let distance =
                |a: [f32; 3], b: [f32; 3]| (0..3).map(|i| f64::from(a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
            let lengths = vertices.iter().flat_map(|&a| vertices.iter().map(move |&b| distance(a, b)));
            let shortest = lengths.filter(|&length| length > 0.0).fold(f64::MAX, f64::min);
            (shortest * 1e3).round() / 1e3
        })
        .collect();
    edges.sort_by(f64::total_cmp);
    edges
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers look up files in memory with their path")]
fn package_uris_are_resolved_by_name_and_by_search_path() {
    let (folder, urdf) = workspace();
    let mut lists = vec![
        folder.path().as_os_str().to_owned(),
        std::env::join_paths([folder.path().join("no"), folder.path().join("hand"), folder.path().join("arm")])
            .unwrap(),
    ];
    let in_share = tempfile::tempdir().unwrap();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(folder.path(), in_share.path().join("share")).unwrap();
        lists.push(in_share.path().as_os_str().to_owned());
    }
    let by_name = LoadOptions::default()
        .with_package("arm", folder.path().join("arm"))
        .with_package("hand", folder.path().join("hand"));
    let all = lists.iter().map(|list| LoadOptions::default().with_package_path(list)).chain([by_name]);
    for options in all {
        let model = Model::from_xml_str_with(&urdf, &options).unwrap();
        assert_eq!(edges(&model), [1.0, 2.0]);
        assert!(model.mesh("part").is_ok() && model.mesh("hand-meshes-part").is_ok());
        Data::new(model).unwrap().step().unwrap();
    }
    // Files in memory take precedence.
    let small = b"v 0 0 0\nv .5 0 0\nv 0 .5 0\nv 0 0 .5\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    let options = LoadOptions::default().with_package_path(folder.path()).with_file("part.obj", small);
    assert_eq!(edges(&Model::from_xml_str_with(&urdf, &options).unwrap()), [0.5]);
}

/// The reader of engines before 3.7 looks for the last part of the name beside the URDF.
#[test]
#[cfg_attr(all(engine_since = "3.0.0", not(engine_since = "3.7.0")), ignore = "these engines do not find them")]
fn meshes_in_other_directories_are_found() {
    let (folder, _) = workspace();
    let path = folder.path().join("arm.urdf");
    let link = |mesh: &str| {
        robot(&format!(
            r#"<link name="a"><collision><geometry><mesh filename="{mesh}"/></geometry></collision></link>"#
        ))
    };
    let absolute = folder.path().join("hand/meshes/part.obj").display().to_string();
    for (mesh, size) in [("arm/meshes/part.obj", 1.0), ("./hand/meshes/part.obj", 2.0), (&absolute[..], 2.0)] {
        std::fs::write(&path, link(mesh)).unwrap();
        assert_eq!(edges(&Model::from_xml_path(&path).unwrap()), [size], "{mesh}");
    }
    // A package around the URDF.
    #[cfg(not(engine_since = "2.3.0"))]
    {
        std::fs::write(folder.path().join("arm/arm.urdf"), link("package://hand/meshes/part.obj")).unwrap();
        assert_eq!(edges(&Model::from_xml_path(folder.path().join("arm/arm.urdf")).unwrap()), [2.0]);
    }
    std::fs::write(&path, link("away/part.obj")).unwrap();
    assert!(Model::from_xml_path(&path).unwrap_err().to_string().contains("part.obj"));
}

#[test]
fn a_missing_package_or_file_is_an_error_that_names_it() {
    let (folder, urdf) = workspace();
    let error = |options: &LoadOptions<'_>| Model::from_xml_str_with(&urdf, options).unwrap_err().to_string();
    let none = error(&LoadOptions::default());
    assert!(none.contains("the directory of package 'arm' is unknown") && none.contains("with_package"), "{none}");
    std::fs::remove_file(folder.path().join("hand/meshes/part.obj")).unwrap();
    let options = LoadOptions::default().with_package_path(folder.path());
    // The engine's search by name would find the other package's file, which is the wrong mesh.
    let missing = error(&options);
    assert!(missing.contains("hand/meshes/part.obj"), "{missing}");
}
