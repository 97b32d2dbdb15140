//! Statement of the fields and constants of the engine that the renderer knows.
//!
//! `support.tsv` decides about each field of the structs of a scene, each constant of their enums,
//! and each field of materials, textures, lights, cameras and quality settings of all engine
//! versions. What a newer engine adds is unknown until the table has a row for it, and a renderer
//! logs its name. So does a renderer for values of the model that it does not draw.

use std::sync::Once;

use mujoco_sys::FIELDS;

use crate::model::Model;

/// Reason, group, and names. The group of a field is its struct; other groups are titles.
const TABLE: &str = include_str!("support.tsv");

/// Members of the visualiser's structs and constants of its enums in the headers of the linked
/// engine: `mjvGeom.type`, `mjGEOM_BOX`. Empty in a documentation build without an engine.
const DECLARED: &[&str] = &include!(concat!(env!("OUT_DIR"), "/drawn.rs"));

/// Beginnings of the fields of a model that a renderer reads.
const OF_MODEL: [&str; 6] = ["mat_", "tex_", "light_", "cam_", "quality.", "map."];

/// Logs what the linked engine has and the renderer does not know, once per process, and what it
/// does not draw of a model.
pub(crate) fn log(model: &Model) {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        for name in undecided(DECLARED.iter().copied().chain(fields_of_model())) {
            log::warn!(
                "the renderer does not know {name} of this engine: images may differ from those of its renderer"
            );
        }
    });
    for text in undrawn(model) {
        log::warn!("{text} is not drawn, as by the engine's OpenGL renderer");
    }
}

/// Returns the fields of a model of the linked engine that a renderer reads.
fn fields_of_model() -> impl Iterator<Item = &'static str> {
    let names = FIELDS.lines().filter_map(|line| {
        let mut cells = line.split('\t');
        let (of, kind, name) = (cells.next()?, cells.next()?, cells.nth(1)?);
        (matches!(of, "Model" | "Visual") && kind != "size").then_some(name)
    });
    names.filter(|name| OF_MODEL.iter().any(|start| name.starts_with(start)))
}

/// Returns the names without a decision.
fn undecided<'n>(names: impl Iterator<Item = &'n str>) -> Vec<&'n str> {
    names.filter(|name| !is_decided(name)).collect()
}

fn is_decided(name: &str) -> bool {
    let (group, member) = name.split_once('.').filter(|(group, _)| group.starts_with("mjv")).unwrap_or(("", name));
    TABLE.lines().any(|row| {
        let mut cells = row.split('\t').skip(1);
        let of_group = cells.next();
        (group.is_empty() || of_group == Some(group))
            && cells.next().is_some_and(|names| names.split(' ').any(|name| name == member))
    })
}

/// Describes the values of a model that differ from their defaults and are not drawn.
#[cfg(engine_since = "3.5.0")]
fn undrawn(model: &Model) -> Vec<String> {
    use mujoco_sys as sys;

    const ROLES: usize = sys::mjNTEXROLE as usize;
    let mut texts = Vec::new();
    for material in model.materials() {
        let (index, name) = (material.id().index(), material.name().unwrap_or("without a name"));
        for (field, value) in
            [("mat_metallic", model.mat_metallic()[index]), ("mat_roughness", model.mat_roughness()[index])]
        {
            if value >= 0.0 {
                texts.push(format!("{field} = {value} of material {name}"));
            }
        }
        for role in (0..ROLES).filter(|&role| role != sys::mjTEXROLE_RGB as usize) {
            let texture = model.mat_texid()[index][role];
            if texture >= 0 {
                texts.push(format!("the texture {texture} in the role {role} of material {name}"));
            }
        }
    }
    for light in model.lights() {
        let (index, name) = (light.id().index(), light.name().unwrap_or("without a name"));
        let kind = model.light_type()[index];
        if kind != sys::mjLIGHT_SPOT as i32 && kind != sys::mjLIGHT_DIRECTIONAL as i32 {
            texts.push(format!("light {name} of type {kind}"));
        }
        for (field, value, default) in [
            ("light_bulbradius", model.light_bulbradius()[index], 0.02),
            ("light_intensity", model.light_intensity()[index], 0.0),
            ("light_range", model.light_range()[index], 10.0),
            #[cfg(engine_since = "3.12.0")]
            ("light_softness", model.light_softness()[index], 0.2),
        ] {
            if value != default {
                texts.push(format!("{field} = {value} of light {name}"));
            }
        }
    }
    texts
}

/// Describes the values of a model that differ from their defaults and are not drawn.
#[cfg(not(engine_since = "3.5.0"))]
fn undrawn(_: &Model) -> Vec<String> {
    Vec::new()
}

#[cfg(test)]
mod tests {
    use super::{DECLARED, TABLE, fields_of_model, is_decided, undecided, undrawn};
    use crate::Model;

    #[test]
    fn every_field_and_constant_of_the_linked_engine_is_decided() {
        // One member or constant of each struct and enum.
        let mut some = vec!["mjvGeom.rgba", "mjvLight.dir", "mjvGLCamera.up", "mjvScene.skinvert", "mjvOption.flags"];
        some.extend(["mjGEOM_BOX", "mjVIS_JOINT", "mjRND_FOG", "mjTEXTURE_2D", "mjSTEREO_NONE"]);
        if cfg!(engine_since = "3.5.0") {
            some.extend(["mjTEXROLE_RGB", "mjLIGHT_SPOT", "mjPROJ_ORTHOGRAPHIC", "mjCOLORSPACE_SRGB"]);
        }
        for name in some {
            assert!(DECLARED.contains(&name), "{name}");
        }
        assert!(fields_of_model().count() > 40);
        let unknown = undecided(DECLARED.iter().copied().chain(fields_of_model()));
        assert!(unknown.is_empty(), "add rows to support.tsv: {unknown:?}");
    }

    #[test]
    fn an_invented_field_is_not_decided() {
        let invented =
            ["mjvGeom.iridescence", "mjvLight.colortemperature", "mjGEOM_TORUS", "mat_clearcoat", "map.bloom"];
        assert_eq!(undecided(invented.into_iter()), invented);
        // A field of another struct does not decide.
        assert!(is_decided("mjvLight.cutoff") && !is_decided("mjvGeom.cutoff"));
    }

    #[test]
    fn every_row_has_a_reason_a_group_and_names() {
        for row in TABLE.lines() {
            let cells: Vec<_> = row.split('\t').collect();
            assert!(cells.len() == 3 && cells.iter().all(|cell| !cell.is_empty()), "{row}");
        }
    }

    #[test]
    fn a_model_with_defaults_draws_everything() {
        let xml = "<mujoco><asset><texture name='t' type='2d' builtin='flat' width='4' height='4'/><material name='m' texture='t'/></asset>
                   <worldbody><light/><light directional='true'/><geom size='1' material='m'/></worldbody></mujoco>";
        assert!(undrawn(&Model::from_xml_str(xml).unwrap()).is_empty());
    }

    #[cfg(engine_since = "3.5.0")]
    #[test]
    fn values_that_are_not_drawn_are_named() {
        let xml = "<mujoco><asset><texture name='t' type='2d' builtin='flat' width='4' height='4'/>
                   <material name='shiny' metallic='.5'/><material name='rough'><layer role='normal' texture='t'/></material></asset>
                   <worldbody><light name='bulb' type='point'/><light name='near' range='2'/></worldbody></mujoco>";
        let texts = undrawn(&Model::from_xml_str(xml).unwrap());
        for part in [
            "mat_metallic = 0.5 of material shiny",
            "of material rough",
            "light bulb of type 2",
            "light_range = 2 of light near",
        ] {
            assert_eq!(texts.iter().filter(|text| text.contains(part)).count(), 1, "{part}: {texts:?}");
        }
    }
}
