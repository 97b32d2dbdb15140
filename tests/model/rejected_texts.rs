//! Texts on which the engine's compiler crashes, hangs or reads out of bounds: each is rejected.

#![forbid(unsafe_code)]

use mujoco_safe::{Data, Error, LoadOptions, Model};

use crate::{DEVICE, is_default};

#[test]
fn recursive_includes_are_rejected() {
    let load = |names: usize, body: &str, end: &str| {
        let texts: Vec<(String, String)> = (0..names)
            .map(|file| {
                let next = format!(r#"<include file="f{}.xml"/>"#, file + 1);
                let inner = if file + 1 < names { next } else { r#"<geom size=".1"/>"#.to_owned() };
                (format!("f{file}.xml"), format!("<mujoco>{body}{inner}{end}</mujoco>"))
            })
            .collect();
        let files: Vec<(&str, &[u8])> = texts.iter().map(|(name, text)| (name.as_str(), text.as_bytes())).collect();
        let first = r#"<mujoco><worldbody><include file="f0.xml"/></worldbody></mujoco>"#;
        Model::from_xml_str_with(first, &LoadOptions::default().with_files(&files))
    };
    assert_eq!(load(40, "", "").unwrap().ngeom(), 1);
    assert!(load(1900, "", "").unwrap_err().to_string().contains("includes are nested"));
    assert_eq!(load(4, &"<body>".repeat(80), &"</body>".repeat(80)).unwrap().nbody(), 321);
    let deep = load(40, &"<body>".repeat(80), &"</body>".repeat(80)).unwrap_err();
    assert!(deep.to_string().contains("nested more than 400 deep"), "{deep}");

    // Up to 3.17 newer compilers do not recognise the file by another name.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.xml");
    let other_name = format!("../{}/a.xml", folder.path().file_name().unwrap().to_str().unwrap());
    std::fs::write(&path, format!(r#"<mujoco><include file="{other_name}"/></mujoco>"#)).unwrap();
    let error = Model::from_xml_path(&path).unwrap_err().to_string();
    assert!(error.contains("must not include itself"), "{error}");
}

#[test]
fn an_invalid_file_name_in_an_included_file_is_an_error_and_loading_still_works() {
    let dir = std::env::temp_dir().join(format!("mujoco_safe_include_{}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    let part = dir.join("part.xml");
    std::fs::write(&part, r#"<mujoco><include file=""/></mujoco>"#).unwrap();
    let xml = format!(r#"<mujoco><include file="{}"/></mujoco>"#, part.display());
    for _ in 0..2 {
        let error = Model::from_xml_str(&xml).unwrap_err();
        assert!(error.to_string().contains("is empty after its last slash"), "{error}");
    }
    let main = dir.join("main.xml");
    std::fs::write(&main, r#"<mujoco><include file="part.xml"/></mujoco>"#).unwrap();
    assert!(matches!(Model::from_xml_path(&main), Err(Error::Load { .. })));
    std::fs::write(&part, "<mujoco><worldbody><geom size='.1'/></worldbody></mujoco>").unwrap();
    assert_eq!(Model::from_xml_path(&main).unwrap().ngeom(), 1);
    std::fs::remove_dir_all(&dir).unwrap();
}

#[test]
fn texts_that_crash_the_compiler_are_rejected() {
    for (xml, expected) in [
        ("<mujoco>\0</mujoco>", "NUL byte"),
        (
            "<mujoco><asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 1' face='0 1 -99000000 0 2 1'/></asset></mujoco>",
            "0 to 3",
        ),
        ("<mujoco><asset><hfield name='h' nrow='50000' ncol='50000' size='1 1 1 1'/></asset></mujoco>", "too large"),
        (
            "<mujoco><asset><texture name='t' type='cube' builtin='flat' width='40000' height='40000'/></asset></mujoco>",
            "too large",
        ),
        (
            "<mujoco><option jacobian='sparse'/><worldbody><body><joint name='j'/><geom size='.1'/></body></worldbody>
             <tendon><fixed><joint joint='j' coef='1'/><joint joint='j' coef='1'/></fixed></tendon></mujoco>",
            "same joint twice",
        ),
        (
            "<mujoco><option jacobian='sparse'/><worldbody><body><joint name='j'/><geom size='.1'/></body></worldbody>
             <tendon><fixed><joint joint='j' coef='1'/><joint joint='&#106;' coef='1'/></fixed></tendon></mujoco>",
            "same joint twice",
        ),
        (
            "<mujoco><size njmax='5'/><worldbody><geom type='plane' size='1 1 1'/>
             <body name='b'><freejoint/><geom size='.1'/></body></worldbody>
             <actuator><adhesion body='b' ctrlrange='0 1'/></actuator></mujoco>",
            "adhesion needs an njmax",
        ),
        ("<mujoco><include file='/dev/zero'/></mujoco>", "regular file"),
        ("<mujoco><include file='/dev/stdin'/></mujoco>", ""),
    ] {
        let error = Model::from_xml_str(&xml.replace("/dev/zero", DEVICE)).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
    Model::from_xml_str("<mujoco/>").unwrap();
}

/// The compiler's trial step writes to the wrong place in scratch memory, which must not affect the
/// model.
#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer engines ignore njmax")]
fn adhesion_on_more_contacts_than_njmax_allows_fails_in_a_step() {
    let ball = |x: usize| format!("<body pos='{x} 0 .09'><freejoint/><geom size='.1' condim='6'/></body>");
    let balls: String = (0..40).map(ball).collect();
    let model = |room: usize, jacobian: &str| {
        let text = format!(
            "<mujoco><size njmax='{room}' nstack='3000000'/><option jacobian='{jacobian}'/>
             <worldbody><geom type='plane' size='99 9 1'/><body name='b' pos='0 1 .09'><freejoint/><geom size='.1'/></body>{balls}
             <body name='c' pos='1 1 .09'><freejoint/><geom size='.1'/></body></worldbody>
             <actuator><adhesion body='b' ctrlrange='0 1'/><adhesion body='c' ctrlrange='0 1'/></actuator></mujoco>"
        );
        Model::from_xml_str(&text).unwrap()
    };
    for jacobian in ["dense", "sparse"] {
        let (little, enough) = (model(100, jacobian), model(600, jacobian));
        assert_eq!(little.statistics(), enough.statistics());
        assert_eq!(little.body_invweight0(), enough.body_invweight0());
        assert_eq!(little.dof_M0(), enough.dof_M0());
        assert_eq!(little.actuator_length0(), enough.actuator_length0());
        assert_eq!(little.actuator_acc0(), enough.actuator_acc0());
        assert!(matches!(Data::new(little).unwrap().step(), Err(Error::Engine { .. })));
        let mut data = Data::new(enough).unwrap();
        data.step().unwrap();
        assert!(data.nefc() > 100);
    }
}

#[test]
fn a_similar_element_or_attribute_is_suggested() {
    let message = |inner: &str| {
        let text = format!("<mujoco><worldbody><body>{inner}</body></worldbody></mujoco>");
        Model::from_xml_str(&text).unwrap_err().to_string()
    };
    for (inner, meant) in [
        ("<gaom size='1'/>", "geom"),
        ("<boddy/>", "body"),
        ("<freejiont/>", "freejoint"),
        ("<geom size='1' rbga='1 0 0 1'/>", ""), // two letters of four differ
        ("<geom size='1' frction='1'/>", "friction"),
        ("<joint dampin='1'/>", "damping"),
        ("<site zzz='1'/>", ""),
        ("<joint kv='1'/>", ""), // an attribute of actuators, like `kp`
        ("<whatever/>", ""),
    ] {
        let message = message(inner);
        assert!(message.contains("line 1"), "{message}");
        match meant {
            "" => assert!(!message.contains("did you mean"), "{message}"),
            _ => assert!(message.ends_with(&format!("did you mean '{meant}'?")), "{message}"),
        }
    }
}

#[test]
fn names_may_contain_any_characters() {
    let long = "n".repeat(5000);
    let xml = format!(
        r#"<mujoco><worldbody><body name="{long}"><joint name="Gelenk äöü &#x2713;"/><geom size=".1"/><geom size=".1" name=""/></body></worldbody></mujoco>"#
    );
    let model = Model::from_xml_str(&xml).unwrap();
    assert_eq!(model.body(&long).unwrap().name(), Some(&long[..]));
    assert_eq!(model.joint("Gelenk äöü ✓").unwrap().index(), 0);
    for name in ["", "\0", "no\0such", "\u{FFFD}", &"x".repeat(1 << 20)] {
        assert!(matches!(model.geom(name), Err(Error::NoSuchName { .. })));
    }
    assert!(matches!(model.joint(usize::MAX), Err(Error::NoSuchIndex { .. })));
    assert!(matches!(model.joint(1 << 32), Err(Error::NoSuchIndex { .. })));

    // Latin 1, which is not UTF-8: the element exists, its name is not returned.
    let path = std::env::temp_dir().join(format!("mujoco_safe_latin_{}.xml", std::process::id()));
    std::fs::write(&path, b"<mujoco><worldbody><geom name='\xe4' size='.1'/></worldbody></mujoco>").unwrap();
    let model = Model::from_xml_path(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert_eq!(model.geom(0).unwrap().name(), None);
    assert!(format!("{}", model.geom(0).unwrap()).contains("(none)"));
}

#[test]
fn extreme_sizes_are_errors() {
    for size in [
        "njmax='1000000000'",
        "njmax='46341' nstack='1000000'",
        "nconmax='1000000000'",
        "nuserdata='2000000000'",
        "nuserdata='-7'",
        "nuser_body='-5'",
        "nuser_geom='200000000'",
        "nstack='10'",
    ]
    .into_iter()
    // A model for newer engines loads with any stack, and its steps fail.
    .filter(|size| is_default() || !size.starts_with("nstack"))
    {
        let xml = format!(
            "<mujoco><size {size}/><worldbody><body><freejoint/><geom size='.1'/><geom size='.1'/></body></worldbody></mujoco>"
        );
        assert!(matches!(Model::from_xml_str(&xml), Err(Error::Load { .. } | Error::OutOfMemory { .. })), "{size}");
    }
    for size in ["njmax='-5'", "nconmax='-5'", "nstack='-5'", "nkey='-3'", "njmax='0' nconmax='0' nstack='0'"] {
        let xml = format!(
            "<mujoco><size {size}/><worldbody><geom type='plane' size='1 1 1'/><body><freejoint/><geom size='.1'/></body></worldbody></mujoco>"
        );
        // Newer compilers reject negative sizes.
        let model = Model::from_xml_str(&xml);
        if !is_default() && model.is_err() {
            continue;
        }
        let mut data = Data::new(model.unwrap()).unwrap();
        data.step().unwrap();
        drop(data.clone());
    }
}

#[test]
fn counts_beyond_the_compilers_arrays_are_rejected() {
    let numbers = "1 ".repeat(501);
    let mesh = "vertex='0 0 0 1 0 0 0 1 0 0 0 1'";
    for (xml, expected) in [
        ("<size nkey='10000000'/>".to_owned(), "nkey must be"),
        ("<size nkey='1e9'/>".to_owned(), "nkey must be"),
        ("<size nuser_site='2000000000'/>".to_owned(), "nuser_site must be"),
        (format!("<custom><numeric name='n' size='1000' data='{numbers}'/></custom>"), "custom numeric"),
        (format!("<custom><numeric name='n' data='{numbers}'/></custom>"), "custom numeric"),
        (
            "<worldbody><body><composite type='cloth' count='3 3 1' spacing='.1'><skin subgrid='100000'/><geom size='.02'/>
             </composite></body></worldbody>"
                .to_owned(),
            "skin of a composite",
        ),
        ("<asset><texture name='t' type='cube' file='x.png' gridsize='65536 65536'/></asset>".to_owned(), "gridsize"),
        (format!("<asset><mesh name='m' file='x.msh' {mesh}/></asset>"), "both a file and"),
        ("<asset><mesh name='m' file='x.msh' face='0 1 99'/></asset>".to_owned(), "both a file and"),
        ("<asset><mesh name='m' vertex='0 0 nan 1 0 0 0 1 0 0 0 1'/></asset>".to_owned(), "not finite"),
        (
            "<asset><skin name='s' vertex='0 0 0 1 0 0 0 1 0' face='0 1 3'><bone body='world' bindpos='0 0 0' bindquat='1 0 0 0'
             vertid='0 1 2' vertweight='1 1 1'/></skin></asset>"
                .to_owned(),
            "skin_face[2] is 3; it must be from 0 to 2",
        ),
        ("<asset><texture name='t' type='cube' fileleft='/dev/zero'/></asset>".to_owned(), "regular file"),
        ("<asset><mesh name='m' file='../../../../../../../..//dev/zero'/></asset>".to_owned(), "regular file"),
    ] {
        let xml = xml.replace("/dev/zero", DEVICE);
        let error = Model::from_xml_str(&format!("<mujoco>{xml}</mujoco>")).unwrap_err().to_string();
        // Newer compilers check the faces of skins.
        let is_outside = !is_default() && error.contains("out of range");
        assert!(error.contains(expected) || is_outside, "{xml:.60}: {error}");
    }
}

/// Returns a hinge with a muscle whose length range the compiler determines by simulation.
fn with_muscle(lengthrange: &str) -> String {
    format!(
        "<mujoco><compiler angle='radian'><lengthrange {lengthrange}/></compiler>
         <worldbody><body><joint name='j' limited='true' range='-1 1'/><geom size='.1' pos='.2 0 0'/></body></worldbody>
         <actuator><muscle joint='j'/></actuator></mujoco>"
    )
}

#[test]
fn a_length_range_that_does_not_converge_is_rejected() {
    for (settings, expected) in [
        ("accel='1e12'", "unstable"),
        ("accel='1e300'", "unstable"),
        ("accel='nan'", "unstable"),
        ("timeconst='nan'", "unstable"),
        ("inttotal='1e300'", "steps"),
        ("inttotal='inf'", "steps"),
        ("timestep='1e-9'", "steps"),
    ] {
        let error = Model::from_xml_str(&with_muscle(settings)).unwrap_err();
        assert!(error.to_string().contains(expected), "{settings}: {error}");
    }
    let model = Model::from_xml_str(&with_muscle("mode='muscle'")).unwrap();
    let [low, high] = model.actuator_lengthrange()[0];
    assert!((low + 1.0).abs() < 0.1 && (high - 1.0).abs() < 0.1, "{low} {high}");
    // A known range needs no simulation, so the settings of the simulation do not matter.
    let known = with_muscle("inttotal='inf'").replace("<muscle joint='j'/>", "<muscle joint='j' lengthrange='-1 2'/>");
    assert_eq!(Model::from_xml_str(&known).unwrap().actuator_lengthrange(), [[-1.0, 2.0]]);
    assert!(Model::from_xml_str(&with_muscle("uselimit='true' inttotal='inf'")).is_ok());
    assert!(Model::from_xml_str(&with_muscle("mode='none' inttotal='inf'")).is_ok());

    let path = std::env::temp_dir().join(format!("mujoco_safe_muscle_{}.xml", std::process::id()));
    std::fs::write(&path, with_muscle("accel='1e12'")).unwrap();
    let error = Model::from_xml_path(&path).unwrap_err();
    std::fs::write(&path, with_muscle("")).unwrap();
    assert_eq!(Model::from_xml_path(&path).unwrap().actuator_lengthrange(), model.actuator_lengthrange());
    std::fs::remove_file(&path).unwrap();
    assert!(error.to_string().contains("unstable"), "{error}");
}

/// Before 4.0, `uselimit` takes the limits of another joint for the second actuator, or reads
/// before the start of their array. Where these are no limits, the compiler simulates an actuator
/// that has limits, which 2.2.2 may do without end.
#[test]
fn the_limits_of_the_wrong_joint_are_rejected() {
    let load = |settings: &str, limited: bool| {
        Model::from_xml_str(&format!(
            "<mujoco><compiler><lengthrange mode='all' uselimit='true' {settings}/></compiler><worldbody>
             <body><joint name='a' type='slide' range='-1 2' limited='true'/><geom size='.1'/></body>
             <body><joint name='b' type='slide' range='-3 4' limited='{limited}'/><geom size='.1'/></body></worldbody>
             <actuator><motor joint='a'/><motor joint='b'/></actuator></mujoco>"
        ))
    };
    if cfg!(engine_since = "4.0.0") {
        assert_eq!(load("accel='1e12'", true).unwrap().actuator_lengthrange(), [[-1.0, 2.0], [-3.0, 4.0]]);
    } else {
        let error = load("accel='1e12'", true).unwrap_err().to_string();
        assert!(error.contains("lengthrange of actuator 1 from the wrong joint"), "{error}");
    }
    let error = load("accel='1e12'", false).unwrap_err().to_string();
    assert!(error.contains("actuator 1"), "{error}");
}

/// The compiler simulates muscles with a time step of 0.01 s, whatever the step of the model is.
#[test]
fn a_length_range_is_checked_with_the_time_step_of_the_compiler() {
    let with = |lengthrange: &str| {
        format!(
            "<mujoco><compiler>{lengthrange}</compiler><option timestep='.001'/><worldbody>
             <body><joint name='m' type='slide' range='-1 1' limited='true'/><geom size='.1'/></body>
             <body pos='1 0 0'><joint name='s' type='slide'/><geom size='.1'/></body></worldbody>
             <equality><joint joint1='s' solref='-100000 -1' polycoef='.1 0 0 0 0'/></equality>
             <actuator><muscle joint='m'/></actuator></mujoco>"
        )
    };
    let error = Model::from_xml_str(&with("")).unwrap_err().to_string();
    assert!(error.contains("unstable"), "{error}");
    let [low, high] = Model::from_xml_str(&with("<lengthrange timestep='0'/>")).unwrap().actuator_lengthrange()[0];
    assert!((low + 1.0).abs() < 0.1 && (high - 1.0).abs() < 0.1, "{low} {high}");
}

/// The inputs are described in `tests/regressions/README.md`.
#[test]
fn texts_that_once_crashed_the_compiler_are_rejected() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/regressions");
    let mut tried = 0;
    for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.extension().is_some_and(|extension| extension == "xml") {
            let text = std::fs::read_to_string(&path).unwrap();
            let expected = text.strip_prefix("<!-- rejected: ").unwrap().split(" -->").next().unwrap();
            let error = Model::from_xml_path(&path).unwrap_err();
            assert!(matches!(error, Error::Load { .. }) && error.to_string().contains(expected), "{path:?}: {error}");
            tried += 1;
        }
    }
    assert!(tried >= 6);
}

/// The compiler of 4.0.0 crashes on a reference to a frame in a model with keyframes.
#[test]
fn references_to_frames_are_errors() {
    for reference in [
        "<custom><tuple name='t'><element objtype='frame' objname='f'/></tuple></custom>",
        "<sensor><user objtype='frame' objname='f' dim='1'/></sensor>",
        "<sensor><framepos objtype='body' objname='b' reftype='frame' refname='f'/></sensor>",
    ] {
        let text = format!(
            "<mujoco><worldbody><body name='b'><freejoint/><geom size='.1'/></body></worldbody>{reference}
             <keyframe><key/></keyframe></mujoco>"
        );
        // Some older compilers take `frame` for no object.
        let loaded = Model::from_xml_str(&text);
        assert!(loaded.is_err() || cfg!(not(engine_since = "4.0.0")), "{reference}");
    }
}

/// Engines from PyPI have another C++ library than the program.
#[test]
fn exceptions_of_the_compiler_are_errors_and_loading_still_works() {
    let body = |equality: &str| {
        let text = format!("<mujoco><worldbody><body name='b'/></worldbody><equality>{equality}</equality></mujoco>");
        Model::from_xml_str(&text)
    };
    for _ in 0..3 {
        for anchor in ["anchor=''", "anchor=' '"] {
            // Since 3.17 the compiler throws std::bad_optional_access.
            let error = body(&format!("<connect body1='b' {anchor}/>")).unwrap_err().to_string();
            assert!(error.contains("anchor") || error.contains("bad_optional_access"), "{error}");
        }
        assert_eq!(body("<connect body1='b' anchor='0 0 0'/>").unwrap().neq(), 1);
    }
}

/// Returns a model with a camera of this resolution, of which a rangefinder casts a ray for each
/// pixel, and with this size of memory.
#[cfg(engine_since = "3.5.0")]
fn camera_rays(width: u32, height: u32, memory: &str) -> mujoco_safe::Result<Model> {
    use mujoco_safe::enums::SensorType;
    use mujoco_safe::spec::Spec;

    let mut spec = Spec::new("camera");
    let world = spec.world();
    spec.section_mut("size")?.set("memory", memory)?;
    spec.add_geom(world).set_size(&[0.1]);
    spec.add_camera(world).set_name("c").set("resolution", [width, height])?;
    spec.add_sensor(SensorType::Rangefinder)?.set("camera", "c")?;
    let compiled = spec.compile();
    let loaded = Model::from_xml_str(&spec.to_xml());
    assert_eq!(compiled.is_ok(), loaded.is_ok(), "{width} {height}");
    compiled
}

#[test]
#[cfg(engine_since = "3.5.0")]
fn cameras_with_too_many_rays_are_rejected_in_a_spec() {
    for (width, height) in [(65_537, 65_537), (30_000, 30_000), (46_341, 46_341), (2001, 2000), (4_000_001, 1)] {
        let error = camera_rays(width, height, "1G").map(|_| ()).unwrap_err().to_string();
        assert!(error.contains("cast more than 4000000 rays"), "{width} {height}: {error}");
    }
}

#[test]
#[cfg(engine_since = "3.5.0")]
fn a_camera_with_as_many_rays_as_permitted_steps_if_its_memory_suffices() {
    let error = camera_rays(2000, 2000, "1M").map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("out of memory"), "{error}");
    let mut data = Data::new(camera_rays(2000, 2000, "200M").unwrap()).unwrap();
    data.step().unwrap();
    assert_eq!(data.sensordata().len(), 4_000_000);
    // The camera is at the centre of the sphere with the radius 0.1.
    assert!(data.sensordata().iter().all(|distance| *distance == -1.0 || (*distance - 0.1).abs() < 1e-12));
}

#[test]
fn as_many_sensor_values_as_permitted_load_and_step() {
    let text = |dim: u32| {
        format!(
            "<mujoco><worldbody><body name='b'><geom size='1'/></body></worldbody>
               <sensor><user objtype='body' objname='b' dim='{dim}' needstage='pos' datatype='real'/></sensor></mujoco>"
        )
    };
    let error = Model::from_xml_str(&text(20_000_001)).unwrap_err().to_string();
    assert!(error.contains("more than 20000000 values"), "{error}");
    let mut data = Data::new(Model::from_xml_str(&text(20_000_000)).unwrap()).unwrap();
    data.step().unwrap();
    assert_eq!(data.sensordata().len(), 20_000_000);
}
