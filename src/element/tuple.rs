//! Tuples: custom lists of elements, each with a number.

use std::ops::Range;

use super::{Objects, View, ViewMut, range};
use crate::id::kind;
use crate::model::{Model, ModelMut};

fields!(Tuple on Model {
    /// Where its elements are in `tuple_objprm`.
    #[doc(alias = "adr")]
    #[doc(alias = "size")]
    data_range: {Range<usize>} = |tuple| range(tuple.owner.tuple_adr(), tuple.owner.tuple_size(), tuple.index());
    /// Its elements, in order.
    ///
    /// ```
    /// use mujoco_safe::{Model, element::Object};
    ///
    /// let model = Model::from_xml_str(
    ///     "<mujoco><worldbody><body name='arm'/></worldbody>
    ///        <custom><tuple name='parts'><element objtype='body' objname='arm' prm='0.5'/></tuple></custom></mujoco>",
    /// )?;
    /// let parts = model.tuple("parts")?;
    /// let arm = model.body("arm")?.id();
    /// assert!(parts.objects().eq([Object::Body(arm)]));
    /// assert_eq!(parts.objprm(), [0.5]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "objtype")]
    #[doc(alias = "objid")]
    objects: {Objects<'a>} = |tuple| {
        let range = tuple.data_range();
        Objects::new(&tuple.owner.tuple_objtype()[range.clone()], &tuple.owner.tuple_objid()[range], tuple.owner.lineage())
    };
    /// The number that goes with each element.
    objprm: [f64] = tuple_objprm at data_range, objprm_mut in tuple_objprm_mut;
});
