//! Watched values: elements of the data, addressed by the name of their field, and an index or the
//! name of an element of the model.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use crate::data::Data;
use crate::error::{Error, InvalidKind, Result};
use crate::field_docs::FieldDoc;
use crate::matrix::MatrixView;
use crate::model::Model;

/// Element of a field of [`Data`]. The index counts over rows and columns in row-major order.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Watch {
    field: usize,
    index: usize,
    /// Text that selects the element.
    name: Arc<str>,
}

/// Kinds of elements, and the field that their names select without the name of a field.
const KINDS: [(&str, &str); 8] = [
    ("joint", "qpos"),
    ("actuator", "actuator_force"),
    ("sensor", "sensordata"),
    ("tendon", "ten_length"),
    ("body", "xpos"),
    ("geom", "geom_xpos"),
    ("site", "site_xpos"),
    ("camera", "cam_xpos"),
];

impl Watch {
    /// Returns the values that a text selects: `qpos[3]`; `time` for the first element;
    /// `qvel hip_x` or `xpos torso[2]` for the values of an element of the model, or one of them;
    /// `joint hip_x`, `sensor touch_left` for the usual field of an element.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchField`] if no real-valued field and no kind of elements has the name,
    /// [`Error::NoSuchName`], and [`Error::Invalid`] for an index out of range.
    pub fn parse(text: &str, model: &Model) -> Result<Vec<Self>> {
        let text = text.trim();
        // Names of elements can contain spaces and brackets.
        let end = text.find([' ', '[']).unwrap_or(text.len());
        let (word, rest) = text.split_at(end);
        let rest = rest.trim();
        let name = KINDS.iter().find(|(kind, _)| *kind == word).map_or(word, |(_, field)| field);
        let Some(field) = FIELDS.iter().position(|(known, _)| *known == name) else {
            return Err(FieldDoc::unknown("Data", name, Self::fields()));
        };
        let shape = Shape::of(name, model);
        let at = |index: usize, name: String| Self { field, index, name: name.into() };
        if rest.is_empty() || rest.starts_with('[') {
            let index = if rest.is_empty() { 0 } else { parse_index(name, rest)? };
            check_index(name, index, shape.len)?;
            return Ok(vec![at(index, format!("{name}[{index}]"))]);
        }
        let (element, values, column) = match (shape.rows_of(name, rest), rest.rfind('[')) {
            (Ok(rows), _) => (rest, rows, None),
            (Err(_), Some(bracket)) => {
                let (element, index) = rest.split_at(bracket);
                (element.trim(), shape.rows_of(name, element.trim())?, Some(parse_index(name, index)?))
            }
            (Err(error), None) => return Err(error),
        };
        let values = values.start * shape.columns..values.end * shape.columns;
        if let Some(column) = column {
            check_index(&format!("{word} {element}"), column, Some(values.len()))?;
        }
        let is_single = values.len() == 1;
        let numbers = values.clone().enumerate().filter(|(number, _)| column.is_none_or(|column| column == *number));
        let named = |(number, index)| {
            at(index, if is_single { format!("{word} {element}") } else { format!("{word} {element}[{number}]") })
        };
        Ok(numbers.map(named).collect())
    }

    /// Selects the element of the same name in another model, or no value if it has none.
    pub fn resolve(&mut self, model: &Model) {
        let resolved = Self::parse(&self.name, model).ok().filter(|watches| watches.len() == 1);
        self.index = resolved.and_then(|watches| Some(watches.first()?.index)).unwrap_or(usize::MAX);
    }

    /// Returns the names of the fields that can be watched.
    pub fn fields() -> impl Iterator<Item = &'static str> {
        FIELDS.iter().map(|(name, _)| *name)
    }

    /// Returns the name of the field.
    pub fn field(&self) -> &'static str {
        FIELDS[self.field].0
    }

    /// Returns the index in the field.
    pub fn index(&self) -> usize {
        self.index
    }

    /// Returns the text that selects the value.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the current value, or NaN if there is none.
    pub fn value(&self, data: &Data) -> f64 {
        FIELDS[self.field].1(data, self.index).unwrap_or(f64::NAN)
    }
}

impl fmt::Display for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

/// Returns the index in brackets.
fn parse_index(field: &str, text: &str) -> Result<usize> {
    let index = text.strip_prefix('[').and_then(|text| text.strip_suffix(']')).unwrap_or(text).trim();
    index
        .parse()
        .map_err(|_| Error::invalid(InvalidKind::Text, format!("the index of {field}"), index, "an integer from 0"))
}

/// Rejects an index beyond the number of values, if that is known.
fn check_index(what: &str, index: usize, len: Option<usize>) -> Result<()> {
    match len {
        Some(0) => {
            Err(Error::out_of_range(format!("the index of {what}"), index, "no index, because it has no values"))
        }
        Some(len) if index >= len => {
            Err(Error::out_of_range(format!("the index of {what}"), index, format!("0 to {}", len - 1)))
        }
        _ => Ok(()),
    }
}

/// Shape of a field for a model.
struct Shape<'m> {
    model: &'m Model,
    /// Size of the model that is the number of rows.
    rows: &'static str,
    columns: usize,
    /// Number of values, unless it depends on the state.
    len: Option<usize>,
}

impl<'m> Shape<'m> {
    fn of(field: &str, model: &'m Model) -> Self {
        let docs = Data::fields().find(|docs| docs.name == field);
        let (rows, columns) = docs.map_or(("", ""), |docs| (docs.rows, docs.columns));
        let size = |text: &str| {
            let size = match text {
                "nq" => model.nq(),
                "nv" => model.nv(),
                "na" => model.na(),
                "nu" => model.nu(),
                "nbody" => model.nbody(),
                "njnt" => model.njnt(),
                "ngeom" => model.ngeom(),
                "nsite" => model.nsite(),
                "ncam" => model.ncam(),
                "nlight" => model.nlight(),
                "ntendon" => model.ntendon(),
                "nsensordata" => model.nsensordata(),
                "nmocap" => model.nmocap(),
                "nuserdata" => model.nuserdata(),
                number => return number.parse().ok(),
            };
            Some(size)
        };
        let len = size(rows).zip(size(columns)).map(|(rows, columns)| rows * columns);
        Self { model, rows, columns: size(columns).unwrap_or(1), len }
    }

    /// Returns the rows of an element of the model.
    fn rows_of(&self, field: &str, name: &str) -> Result<Range<usize>> {
        let model = self.model;
        let one = |index: usize| index..index + 1;
        Ok(match self.rows {
            "nq" => model.joint(name)?.qpos_range(),
            "nv" => model.joint(name)?.dofs(),
            "njnt" => one(model.joint(name)?.index()),
            "nu" => model.actuator(name)?.controls(),
            "nout" => model.actuator(name)?.outputs(),
            "na" => model.actuator(name)?.activations(),
            "nbody" => one(model.body(name)?.index()),
            "ngeom" => one(model.geom(name)?.index()),
            "nsite" => one(model.site(name)?.index()),
            "ncam" => one(model.camera(name)?.index()),
            "nlight" => one(model.light(name)?.index()),
            "ntendon" => one(model.tendon(name)?.index()),
            "nsensordata" => model.sensor(name)?.data_range(),
            _ => {
                let expected = format!("an index: {field}[0]");
                return Err(Error::invalid(InvalidKind::Text, format!("the element of {field}"), name, expected));
            }
        })
    }
}

/// Array or scalar of real numbers.
trait Elements {
    /// Returns an element by its row-major index.
    fn element(&self, index: usize) -> Option<f64>;
}

impl Elements for &[f64] {
    fn element(&self, index: usize) -> Option<f64> {
        self.get(index).copied()
    }
}

impl<const N: usize> Elements for &[[f64; N]] {
    fn element(&self, index: usize) -> Option<f64> {
        self.as_flattened().get(index).copied()
    }
}

impl<const N: usize> Elements for [f64; N] {
    fn element(&self, index: usize) -> Option<f64> {
        self.get(index).copied()
    }
}

impl Elements for MatrixView<'_> {
    fn element(&self, index: usize) -> Option<f64> {
        self.as_slice().get(index).copied()
    }
}

impl Elements for f64 {
    fn element(&self, index: usize) -> Option<f64> {
        (index == 0).then_some(*self)
    }
}

/// Accessor of one element of a field.
type Read = fn(&Data, usize) -> Option<f64>;

macro_rules! fields {
    ($($(#[$condition:meta])? $name:ident)*) => {
        &[$($(#[$condition])? (stringify!($name), |data, index| data.$name().element(index))),*]
    };
}

/// Real-valued fields, in the order of 2.2.2, which alone has some of them.
#[rustfmt::skip]
static FIELDS: &[(&str, Read)] = fields! {
    time energy solver_fwdinv
    qpos qvel act qacc_warmstart ctrl qfrc_applied xfrc_applied mocap_pos mocap_quat qacc act_dot userdata
    sensordata xpos xquat xmat xipos ximat xanchor xaxis geom_xpos geom_xmat site_xpos site_xmat cam_xpos
    cam_xmat light_xpos light_xdir subtree_com cdof cinert ten_length ten_J wrap_xpos actuator_length
    actuator_moment crb
    #[cfg(not(engine_since = "2.3.0"))] qM
    qLD qLDiagInv
    #[cfg(not(engine_since = "2.3.0"))] qLDiagSqrtInv
    efc_J
    #[cfg(not(engine_since = "2.3.0"))] efc_JT
    efc_pos efc_margin efc_frictionloss
    #[cfg(not(engine_since = "2.3.0"))] efc_diagApprox
    efc_KBIP efc_D efc_R efc_AR ten_velocity actuator_velocity cvel cdof_dot qfrc_bias
    qfrc_passive efc_vel efc_aref subtree_linvel subtree_angmom qH qHDiagInv qDeriv qLU actuator_force
    qfrc_actuator qfrc_smooth qacc_smooth efc_b efc_force qfrc_constraint qfrc_inverse cacc cfrc_int cfrc_ext
};

#[cfg(test)]
mod tests {
    use super::Watch;
    use crate::{Data, Error, Model, sample};

    fn watch(text: &str, data: &Data) -> Vec<Watch> {
        Watch::parse(text, data.model()).unwrap()
    }

    #[test]
    fn value_is_found_by_field_and_index() {
        let mut data = Data::new(sample::humanoid()).unwrap();
        data.step().unwrap();
        let value = |text: &str| watch(text, &data)[0].value(&data);
        assert_eq!(value("qpos[2]"), data.qpos()[2]);
        assert_eq!(value("time"), data.time());
        assert_eq!(value(" xpos [ 5 ]"), data.xpos()[1][2]);
        // Newer engines store sparse rows.
        #[cfg(not(engine_since = "3.2.5"))]
        assert_eq!(value("actuator_moment[27]"), data.actuator_moment().row(1)[0]);
        assert_eq!(watch("qvel[3]", &data)[0].to_string(), "qvel[3]");
        // The number of constraints depends on the state.
        assert!(value("efc_force[100000]").is_nan());
    }

    #[test]
    fn values_are_found_by_the_names_of_elements() {
        let mut data = Data::new(sample::humanoid()).unwrap();
        data.reset_to_key("squat").unwrap();
        data.step().unwrap();
        let model = data.model().clone();
        let knee = model.joint("left_knee").unwrap();
        let torso = model.body("torso").unwrap().index();
        let touch = model.sensor("left_foot_touch").unwrap().data_range();
        let values = |text: &str| watch(text, &data).iter().map(|watch| watch.value(&data)).collect::<Vec<_>>();
        let names = |text: &str| watch(text, &data).iter().map(Watch::to_string).collect::<Vec<_>>();
        assert_eq!(values("joint left_knee"), data.qpos()[knee.qpos_range()]);
        assert_eq!(values("qvel left_knee"), data.qvel()[knee.dofs()]);
        assert_eq!(values("sensor left_foot_touch"), data.sensordata()[touch]);
        assert_eq!(values("xpos torso"), data.xpos()[torso]);
        assert_eq!(values("body torso[2]"), [data.xpos()[torso][2]]);
        assert_eq!(values("actuator left_knee").len(), 1);
        assert_eq!(names("qvel left_knee"), ["qvel left_knee"]);
        assert_eq!(names("body torso"), ["body torso[0]", "body torso[1]", "body torso[2]"]);
        for name in names("sensor torso_gyro") {
            assert_eq!(names(&name), [name.as_str()], "a name selects the same value");
        }
    }

    #[test]
    fn another_model_has_the_element_in_another_place() {
        let text = |added: &str| {
            format!("<mujoco><worldbody>{added}<body><joint name='x'/><geom size='1'/></body></worldbody></mujoco>")
        };
        let [before, after, without] =
            [text(""), text("<body><joint/><geom size='1'/></body>"), text("").replace("'x'", "'y'")]
                .map(|text| Model::from_xml_str(&text).unwrap());
        let mut watch = Watch::parse("joint x", &before).unwrap().remove(0);
        assert_eq!(watch.index(), 0);
        watch.resolve(&after);
        assert_eq!(watch.index(), 1);
        watch.resolve(&without);
        assert!(watch.value(&Data::new(without).unwrap()).is_nan());
    }

    #[test]
    fn unknown_names_and_invalid_indices_are_errors() {
        let model = sample::humanoid();
        let error = |text: &str| Watch::parse(text, &model).unwrap_err();
        assert!(error("qpso[0]").to_string().contains("qpos"));
        for text in ["qpos[x]", "qpos[-1]", "efc_force left_knee", "body torso[x]"] {
            assert!(matches!(error(text), Error::Invalid { .. }), "{text}");
        }
        let range = format!("0 to {}", model.nq() - 1);
        assert!(error("qpos[99]").to_string().contains(&range), "{}", error("qpos[99]"));
        assert!(error("body torso[3]").to_string().contains("0 to 2"));
        assert!(error("energy[2]").to_string().contains("0 to 1"));
        assert!(matches!(error("joint left_kne"), Error::NoSuchName { .. }));
    }

    #[test]
    #[cfg_attr(engine_since = "2.3.0", ignore = "the list has the arrays of 2.2.2")]
    fn every_real_array_can_be_watched() {
        let known: Vec<_> = Watch::fields().collect();
        let missing: Vec<_> = Data::fields()
            .filter(|field| field.ctype == "mjtNum" && field.is_array && !known.contains(&field.name))
            .map(|field| field.name)
            .collect();
        assert_eq!(missing, [""; 0]);
    }
}
