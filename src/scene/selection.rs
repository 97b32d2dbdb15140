//! Picking: the geom, flex or skin at a point of the window.

use mujoco_sys::guard;

use super::{Scene, SceneOptions};
use crate::data::{Data, Stage};
use crate::error::{Error, Result};
use crate::id::{BodyId, GeomId, Id, SkinId};

/// Result of picking a point of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selection {
    /// Body of the geom, or the body with the largest weight on the vertex of the flex or skin.
    pub body: BodyId,
    /// Geom, unless the ray hit a flex or a skin first.
    pub geom: Option<GeomId>,
    /// Skin, unless the ray hit a geom or a flex first.
    pub skin: Option<SkinId>,
    /// Index of the flex, unless the ray hit a geom or a skin first. Engines before 3.0 have none.
    pub flex: Option<usize>,
    /// Intersection point, or the nearest vertex of a flex or skin, m, world frame.
    pub point: [f64; 3],
}

impl Scene {
    /// Casts a ray from the camera of the last [`update`](Self::update) through a point of the
    /// window, and returns the first geom, flex or skin that it hits. `aspectratio` is the width of
    /// the window divided by its height. `relx` and `rely` are the coordinates of the point, 0 to
    /// 1, from the left and from the bottom.
    ///
    /// The ray hits the geoms, flexes and skins that `options` show, according to the groups of
    /// geoms, [`VisualFlags::STATIC`], [`VisualFlags::SKIN`] and the flags of flexes. It ignores
    /// decoration, tendons and sites, and hits planes and height fields in every group.
    ///
    /// [`VisualFlags::STATIC`]: super::VisualFlags::STATIC
    /// [`VisualFlags::SKIN`]: super::VisualFlags::SKIN
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] if positions have not been computed, [`Error::Engine`] before the
    /// first update (the data stays usable), [`Error::OtherModel`] for data of another model,
    /// [`Error::Invalid`] if a value is not finite, [`Error::Unsupported`] if the model has a
    /// height field with more rows than columns, as for [`Data::ray`].
    ///
    /// ```
    /// use mujoco_safe::scene::{Camera, Categories, Scene, SceneOptions};
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let mut scene = Scene::new(data.model(), 1000)?;
    /// let mut camera = Camera::free(data.model());
    /// camera.lookat = *data.body("torso")?.xpos();
    /// let options = SceneOptions::default();
    /// scene.update(&mut data, &options, None, &mut camera, Categories::all())?;
    /// let found = scene.select(&data, &options, 1.5, [0.5, 0.5])?.expect("the torso is at the centre");
    /// assert_eq!(data.body(found.body).name(), Some("torso"));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjv_select")]
    pub fn select(
        &self,
        data: &Data,
        options: &SceneOptions,
        aspectratio: f64,
        [relx, rely]: [f64; 2],
    ) -> Result<Option<Selection>> {
        let model = data.model();
        self.check_model(model, "the data to select from")?;
        data.check_computed("Scene::select", Stage::Position)?;
        if let Some(geom) = model.first_geom_unsafe_for_rays() {
            return Err(Error::Unsupported(format!(
                "cannot select with the height field of geom {geom}: MuJoCo 2.2.2 reads out of bounds if a height field has more \
                 rows than columns, or fewer than two of either; rotate the field by 90°"
            )));
        }
        let finite = [aspectratio, relx, rely].iter().all(|number| number.is_finite());
        if !(finite && self.viewpoint().is_finite()) {
            return Err(Error::not_finite(
                "the point to select",
                format!("aspect ratio {aspectratio}, at {:?} in the view of {:?}", [relx, rely], self.viewpoint()),
            ));
        }
        let (options, scene) = (options.raw(), self.as_ptr());
        let (mut point, mut geom, mut flex, mut skin, mut body) = ([0.0; 3], -1, -1, -1, -1);
        let (at, ids) = (point.as_mut_ptr(), [&raw mut geom, &raw mut flex, &raw mut skin, &raw mut body]);
        data.call("mjv_select", |m, d| {
            let opt = &raw const options;
            // SAFETY: the model, the data and the scene belong together, the positions were
            // computed, and the outputs are valid places for three numbers and four indices.
            unsafe { guard::mjv_select(m, d, opt, aspectratio, relx, rely, scene, at, ids[0], ids[1], ids[2], ids[3]) }
        })?;
        let index = |index: i32| usize::try_from(index).ok();
        // The engine returns no body for a vertex of a skin without bones.
        Ok(index(body).map(|body| Selection {
            body: Id::new(body, self.lineage),
            geom: index(geom).map(|geom| Id::new(geom, self.lineage)),
            skin: index(skin).map(|skin| Id::new(skin, self.lineage)),
            flex: index(flex),
            point,
        }))
    }
}
