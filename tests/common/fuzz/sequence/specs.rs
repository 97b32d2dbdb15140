//! Other models for simulations: edited specs, expanded ones and those of archives.

use std::sync::Arc;

use mujoco_safe::kind::{Body, Geom, Joint};
use mujoco_safe::spec::{Any, ElementId, Mount, Spec};
use mujoco_safe::{Batch, Data, Error, Result};

use super::super::models;
use super::{Bytes, Call, Scene, expected};

/// Returns the spec of a small model of the corpus.
fn spec(bytes: &mut Bytes<'_>) -> Result<Spec> {
    Spec::from_xml_str(bytes.choose(&[models::ASSEMBLY, models::ADHESION, models::COLLIDERS, models::COPIES]))
}

/// Changes a spec: removes, adds, renames and attaches elements, and sets keyframes.
fn edit(spec: &mut Spec, bytes: &mut Bytes<'_>) -> Result<()> {
    let bodies = spec.ids::<Body>();
    let body = bodies[bytes.below(bodies.len())];
    match bytes.below(8) {
        kind @ 0..4 => {
            let any = |spec: &Spec| -> Vec<ElementId<Any>> {
                match kind {
                    0 => spec.ids::<Body>().into_iter().map(ElementId::any).collect(),
                    1 => spec.ids::<Joint>().into_iter().map(ElementId::any).collect(),
                    2 => spec.ids::<Geom>().into_iter().map(ElementId::any).collect(),
                    _ => spec.ids::<mujoco_safe::kind::Actuator>().into_iter().map(ElementId::any).collect(),
                }
            };
            let all = any(spec);
            if all.is_empty() { Ok(()) } else { spec.remove_with_references(all[bytes.below(all.len())]) }
        }
        4 => {
            let added = spec.add_body(body).set_pos([bytes.fraction(), 1.0, bytes.fraction()]).id();
            spec.add_joint(added).set_ref(bytes.number());
            spec.add_geom(added).set_size(&[0.1]);
            Ok(())
        }
        5 => {
            let name = if bytes.once_in(2) { "other" } else { "" };
            spec.edit(body).set_name(name);
            Ok(())
        }
        6 => {
            let mount = Mount::body(body).with_pos([bytes.fraction(), bytes.number(), 0.0]);
            let other = self::spec(bytes)?;
            spec.attach(&other, mount, bytes.choose(&["a_", "b_", ""])).map(drop)
        }
        _ => {
            let (values, number) = (bytes.vector(3), bytes.number());
            spec.add_keyframe().set_name(&format!("key{number}")).set_qpos(&values).set_ctrl(&values);
            Ok(())
        }
    }
}

/// Makes a step of a new simulation, changes its model, and makes it the simulation of the scene.
fn adopt(
    scene: &mut Scene<'_>,
    mut spec: Spec,
    bytes: &mut Bytes<'_>,
    change: impl FnOnce(&Spec) -> Result<Spec>,
) -> Result<()> {
    let mut data = Data::new(spec.compile()?)?;
    expected(&data.step());
    for _ in 0..bytes.below(3) {
        edit(&mut spec, bytes)?;
    }
    let spec = change(&spec)?;
    let model = Arc::new(spec.compile()?);
    let adoption = data.adopt(&model)?;
    assert!(adoption.lost.len() <= 10_000 && Arc::ptr_eq(data.model(), &model));
    expected(&data.step());
    scene.data = data;
    Ok(())
}

pub(super) const CALLS: &[(&str, Call)] = &[
    ("adopt the loaded model", |scene, _| scene.data.adopt(&scene.model).map(drop)),
    ("adopt an edited clone", |scene, bytes| {
        let mut model = scene.data.model().try_clone()?;
        let number = bytes.number();
        model.edit().geom_size_mut().iter_mut().for_each(|size| size[0] = number);
        scene.data.adopt(model).map(drop)
    }),
    ("adopt the model of the other simulation", |scene, _| {
        scene.other.as_ref().map_or(Ok(()), |other| scene.data.adopt(other.model()).map(drop))
    }),
    ("adopt another model of the corpus", |scene, bytes| {
        if !bytes.once_in(8) {
            return Ok(());
        }
        scene.data.adopt(models::model(models::choose(bytes))).map(drop)
    }),
    ("adopt an edited spec", |scene, bytes| {
        if !bytes.once_in(4) {
            return Ok(());
        }
        let spec = spec(bytes)?;
        adopt(scene, spec, bytes, |spec| Ok(spec.clone()))
    }),
    ("adopt an expanded spec", |scene, bytes| {
        if !bytes.once_in(8) {
            return Ok(());
        }
        let spec = spec(bytes)?;
        adopt(scene, spec, bytes, Spec::expanded)
    }),
    ("batch: adopt", |scene, bytes| {
        if !bytes.once_in(8) {
            return Ok(());
        }
        let mut spec = spec(bytes)?;
        let mut batch = Batch::new(spec.compile()?, 2)?;
        batch.step(|_, _| ())?;
        edit(&mut spec, bytes)?;
        batch.adopt(spec.compile()?)?;
        batch.step(|_, controls| controls.as_mut_slice().fill(0.5))?;
        scene.other = Some(batch.data(1)?);
        Ok(())
    }),
    #[cfg(feature = "mjz")]
    ("save_archive, from_archive_path", |scene, bytes| {
        if !bytes.once_in(8) {
            return Ok(());
        }
        let folder = tempfile::tempdir().expect("no temporary folder");
        let path = folder.path().join("model.mjz");
        spec(bytes)?.save_archive(&path)?;
        archives::damage(&path, bytes);
        let spec = Spec::from_archive_path(&path)?;
        scene.other = Some(Data::new(spec.compile()?)?);
        match spec.expanded() {
            Ok(_) | Err(Error::XmlReplaced) => Ok(()),
            Err(error) => Err(error),
        }
    }),
];

#[cfg(feature = "mjz")]
mod archives {
    use std::io::{Cursor, Read as _, Write as _};
    use std::path::Path;

    use zip::write::SimpleFileOptions;
    use zip::{ZipArchive, ZipWriter};

    use super::super::super::assets;
    use super::Bytes;

    const NAMES: [&str; 8] =
        ["../model.xml", "/model.xml", "model/model.xml", "model.xml/", "", "a\\..\\b", "con", "model.xml"];

    /// Occasionally damages the bytes of an archive, or the names and contents of its files, whose
    /// checksums are correct then.
    pub(super) fn damage(path: &Path, bytes: &mut Bytes<'_>) {
        let mut content = std::fs::read(path).expect("the file was written");
        match bytes.below(4) {
            0 => assets::damage(&mut content, bytes),
            1 => content = rewritten(&content, bytes),
            _ => return,
        }
        std::fs::write(path, content).expect("the folder is writable");
    }

    fn rewritten(content: &[u8], bytes: &mut Bytes<'_>) -> Vec<u8> {
        let mut archive = ZipArchive::new(Cursor::new(content)).expect("an archive");
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        for index in 0..archive.len() {
            let mut member = archive.by_index(index).expect("a member");
            let mut content = Vec::new();
            member.read_to_end(&mut content).expect("its content");
            let name = match bytes.below(3) {
                0 => NAMES[bytes.below(NAMES.len())].to_owned(),
                _ => member.name().expect("a name").into_owned(),
            };
            if bytes.once_in(2) {
                assets::damage(&mut content, bytes);
            }
            // The writer rejects a second file of the name.
            if writer.start_file(name, SimpleFileOptions::default()).is_ok() {
                writer.write_all(&content).expect("memory");
            }
        }
        writer.finish().expect("memory").into_inner()
    }
}
