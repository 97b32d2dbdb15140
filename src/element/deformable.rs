//! Views of flexes and of instances of plugins. Their fields are those of newer engines:
//! [`newer`](super::newer).

use super::View;
use crate::data::Data;
use crate::kind;
use crate::model::Model;

fields!(Flex on Model {
});

fields!(Flex on Data {
});

fields!(Plugin on Model {
});

fields!(Plugin on Data {
});
