//! Visual and collision geometry of a URDF as geoms.

use std::collections::{HashMap, HashSet};

use super::element::{Urdf, abbreviated};
use super::inertial::pose;
use super::links::Link;
use super::meshes::{Files, Found, Meshes};
use super::{Attributes, UrdfWarning};
use crate::error::Result;
use crate::spec::tree::{Index, Tree};
use crate::spec::value::Value;

/// Conversion of geometry, link by link in the order of the text.
pub(super) struct Geometry<'t, 'f> {
    urdf: Urdf<'t>,
    files: Files<'f>,
    has_visuals: bool,
    pub(super) meshes: Meshes,
    /// Colours of the materials.
    colours: HashMap<&'t str, Index>,
    names: HashSet<&'t str>,
    /// Number of visual elements that are left out.
    pub(super) visuals: usize,
}

impl<'t, 'f> Geometry<'t, 'f> {
    pub(super) fn new(urdf: Urdf<'t>, files: Files<'f>, has_visuals: bool) -> Result<Self> {
        let mut colours = HashMap::new();
        // The first material of a name that has a colour counts, wherever it is.
        for element in urdf.tree.descendants(Tree::ROOT) {
            if urdf.tree.tag(element) == "material"
                && let Some(name) = urdf.text(element, "name")
                && !colours.contains_key(name)
                && let Some(colour) = urdf.child(element, "color")?
            {
                colours.insert(name, colour);
            }
        }
        Ok(Self { urdf, files, has_visuals, meshes: Meshes::default(), colours, names: HashSet::new(), visuals: 0 })
    }

    /// Returns the geoms of a link.
    pub(super) fn geoms(&mut self, link: &Link<'t>, warnings: &mut Vec<UrdfWarning>) -> Result<Vec<Attributes>> {
        let mut geoms = Vec::new();
        // A colour is that of the following elements too.
        let mut rgba = None;
        for &element in self.urdf.tree.children(link.element) {
            let is_visual = match self.urdf.tree.tag(element) {
                "visual" => true,
                "collision" => false,
                _ => continue,
            };
            if is_visual {
                rgba = self.colour(element)?.or(rgba);
                if !self.has_visuals {
                    self.visuals += 1;
                    continue;
                }
            }
            let Some(shape) = self.shape(link, element, is_visual, warnings)? else { continue };
            let mut geom = Attributes::new();
            let name = self.urdf.text(element, "name").filter(|name| !name.is_empty());
            // Geoms with the name of another one have none.
            geom.extend(name.filter(|name| self.names.insert(name)).map(|name| ("name", name.to_owned())));
            geom.extend(shape);
            geom.extend(pose(self.urdf, element)?);
            if is_visual {
                let settings = [("contype", "0"), ("conaffinity", "0"), ("group", "1"), ("density", "0")];
                geom.extend(settings.map(|(attribute, value)| (attribute, value.to_owned())));
            }
            // A negative one stands for no colour.
            let rgba = rgba.filter(|rgba| rgba[0] >= 0.0);
            geom.extend(rgba.map(|rgba| ("rgba", rgba.text().into_owned())));
            geoms.push(geom);
        }
        Ok(geoms)
    }

    /// Returns the colour of a visual element.
    fn colour(&self, visual: Index) -> Result<Option<[f64; 4]>> {
        let urdf = self.urdf;
        let Some(material) = urdf.child(visual, "material")? else { return Ok(None) };
        let named = || urdf.text(material, "name").and_then(|name| self.colours.get(name)).copied();
        let Some(colour) = urdf.child(material, "color")?.or_else(named) else { return Ok(None) };
        urdf.required_numbers(colour, "rgba").map(Some)
    }

    /// Returns the type and the size of a geom, or `None` for a mesh that is left out.
    fn shape(
        &mut self,
        link: &Link<'t>,
        element: Index,
        is_visual: bool,
        warnings: &mut Vec<UrdfWarning>,
    ) -> Result<Option<Attributes>> {
        let urdf = self.urdf;
        let geometry = urdf.required(element, "geometry")?;
        let of_type =
            |word: &str, size: &[f64]| Ok(Some(vec![("type", word.to_owned()), ("size", size.text().into_owned())]));
        if let Some(shape) = urdf.child(geometry, "box")? {
            return of_type("box", &urdf.required_numbers::<3>(shape, "size")?.map(|length| length / 2.0));
        }
        for word in ["cylinder", "sphere", "capsule"] {
            let Some(shape) = urdf.child(geometry, word)? else { continue };
            let [radius] = urdf.required_numbers(shape, "radius")?;
            if word == "sphere" {
                return of_type(word, &[radius]);
            }
            let [length] = urdf.required_numbers(shape, "length")?;
            return of_type(word, &[radius, length / 2.0]);
        }
        let Some(mesh) = urdf.child(geometry, "mesh")? else {
            let geometry = urdf.describe(geometry);
            return Err(urdf.error(format!("{geometry} has no <box>, <cylinder>, <sphere>, <capsule> or <mesh>")));
        };
        let name = urdf.required_text(mesh, "filename")?;
        let scale = urdf.numbers(mesh, "scale")?.unwrap_or([1.0; 3]);
        let is_on_disk = self.files.directory.is_some();
        let file = match self.files.find(name) {
            Found::Missing(_) if is_visual && is_on_disk => Err("the file does not exist".to_owned()),
            // The compiler reports a missing one, if it is not in memory then.
            Found::File(file) | Found::Missing(file) => Ok(file),
            Found::Unknown(reason) if !is_visual => {
                let (name, link) = (abbreviated(name), urdf.describe(link.element));
                return Err(urdf.error(format!("the mesh '{name}' of {link} is not found: {reason}")));
            }
            Found::Unknown(reason) | Found::Unreadable(reason) => Err(reason),
        };
        match file {
            Ok(file) => {
                let name = self.meshes.name(file, scale);
                Ok(Some(vec![("type", "mesh".to_owned()), ("mesh", name)]))
            }
            Err(reason) => {
                warnings.push(UrdfWarning::Mesh { link: link.name.to_owned(), file: name.to_owned(), reason });
                Ok(None)
            }
        }
    }
}
