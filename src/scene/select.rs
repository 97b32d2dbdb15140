//! What is seen at a place of the window.

use mujoco_sys::guard;

use super::{Scene, SceneOptions};
use crate::data::{Data, Stage};
use crate::error::{Error, Result};
use crate::id::{BodyId, GeomId, Id, SkinId};

/// What was found at a place of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selection {
    /// The body: that of the geom, or the one that moves the vertex of the skin most.
    pub body: BodyId,
    /// The geom, unless a skin was found.
    pub geom: Option<GeomId>,
    /// The skin, unless a geom was found.
    pub skin: Option<SkinId>,
    /// The point, m, world frame.
    pub point: [f64; 3],
}

impl Scene {
    /// What is seen at a place of the window: the first geom or skin on a ray from the camera of the last
    /// [`update`](Self::update). `aspectratio` is the width of the window divided by its height. `relx` and `rely` say where: 0 to
    /// 1, from the left and from below.
    ///
    /// Whatever of the geoms and skins the options show can be found: groups of geoms, what does not move, skins. Decoration,
    /// tendons and sites are not found; planes and height fields are in any group.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before poses were computed, [`Error::Engine`] before the first update (the data stays usable),
    /// [`Error::OtherModel`] for the data of another model, [`Error::Invalid`] for numbers that are not finite, [`Error::Unsupported`] if the model has a
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
    /// let found = scene.select(&data, &options, 1.5, [0.5, 0.5])?.expect("the torso");
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
                "selecting with the height field of geom {geom}: MuJoCo 2.2.2 reads beyond one with more rows than columns, or \
                 with less than two of either; turn the field by 90°"
            )));
        }
        let finite = [aspectratio, relx, rely].iter().all(|number| number.is_finite());
        if !(finite && self.viewpoint().is_finite()) {
            return Err(Error::invalid(
                "where to select",
                format!("aspect ratio {aspectratio}, at {:?} in the view of {:?}", [relx, rely], self.viewpoint()),
                "finite",
            ));
        }
        let (options, scene) = (options.raw(), self.as_ptr());
        let (mut point, mut geom, mut skin, mut body) = ([0.0; 3], -1, -1, -1);
        let (at, ids) = (point.as_mut_ptr(), (&raw mut geom, &raw mut skin, &raw mut body));
        data.call("mjv_select", |m, d| {
            let opt = &raw const options;
            // SAFETY: a model, a data and a scene that go together, poses that were computed, a place for three numbers and three
            // places for indices.
            unsafe { guard::mjv_select(m, d, opt, aspectratio, relx, rely, scene, at, ids.0, ids.1, ids.2) }
        })?;
        let index = |index: i32| usize::try_from(index).ok();
        // A vertex of a skin that no bone moves has no body.
        Ok(index(body).map(|body| Selection {
            body: Id::new(body, self.lineage),
            geom: index(geom).map(|geom| Id::new(geom, self.lineage)),
            skin: index(skin).map(|skin| Id::new(skin, self.lineage)),
            point,
        }))
    }
}
