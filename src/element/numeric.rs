//! Custom arrays of numbers.

use std::ops::Range;

use super::{View, ViewMut, range};
use crate::id::kind;
use crate::model::{Model, ModelMut};

fields!(Numeric on Model {
    /// Where its numbers are in `numeric_data`.
    #[doc(alias = "adr")]
    #[doc(alias = "size")]
    data_range: {Range<usize>} = |numeric| range(numeric.owner.numeric_adr(), numeric.owner.numeric_size(), numeric.index());
    /// Its numbers.
    data: [f64] = numeric_data at data_range, data_mut in numeric_data_mut;
});
