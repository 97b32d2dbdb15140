//! Nodes: frames, geoms, cameras and lights.

use gltf_json::camera::{Camera, Orthographic, Perspective, Type};
use gltf_json::scene::UnitQuaternion;
use gltf_json::validation::Checked::Valid;
use gltf_json::{Extras, Index, Node, Root};

use crate::error::{Error, Result};
use crate::math::{mat2quat, normalize4};
use crate::replay::{FreeCamera, Frustum, Pose};

/// Returns a node in a pose.
///
/// # Errors
///
/// [`Error::Invalid`] for numbers that are not finite in single precision.
pub(super) fn node(name: String, pose: Pose) -> Result<Node> {
    let translation = Some(translation(pose.pos)?).filter(|at| *at != [0.0; 3]);
    let rotation = Some(rotation(pose.quat)?).filter(|quat| *quat != [0.0, 0.0, 0.0, 1.0]).map(UnitQuaternion);
    Ok(Node { name: Some(name), translation, rotation, ..Node::default() })
}

/// Adds a node as a child of another.
pub(super) fn add_child(root: &mut Root, parent: Index<Node>, node: Node) -> Index<Node> {
    let index = root.push(node);
    root.nodes[parent.value()].children.get_or_insert_default().push(index);
    index
}

/// Converts a position, m.
pub(super) fn translation(pos: [f64; 3]) -> Result<[f32; 3]> {
    let single = pos.map(|number| number as f32);
    if single.iter().all(|number| number.is_finite()) {
        return Ok(single);
    }
    Err(Error::out_of_range("a position to save as glTF", format!("{pos:?}"), "finite in single precision"))
}

/// Converts a quaternion to `[x, y, z, w]`, of length 1.
pub(super) fn rotation(mut quat: [f64; 4]) -> Result<[f32; 4]> {
    normalize4(&mut quat);
    if quat.iter().all(|number| number.is_finite()) {
        return Ok([1, 2, 3, 0].map(|part| quat[part] as f32));
    }
    Err(Error::out_of_range("an orientation to save as glTF", format!("{quat:?}"), "finite"))
}

/// Converts a frustum. `None` for one that glTF does not have. The second result is `false` if the
/// frustum is not symmetric, which the camera then is.
pub(super) fn camera(name: Option<String>, frustum: &Frustum) -> Option<(Camera, bool)> {
    let &Frustum { center, width, bottom, top, near, far, orthographic } = frustum;
    let half = 0.5 * (top - bottom);
    let all = [center, width, half, near, far];
    if !(all.iter().all(|number| number.is_finite()) && half > 0.0 && near > 0.0 && far > near) {
        return None;
    }
    let aspect = (width > 0.0).then_some(width / half);
    let mut camera = Camera {
        name,
        orthographic: None,
        perspective: None,
        type_: Valid(Type::Perspective),
        extensions: None,
        extras: Extras::default(),
    };
    if orthographic {
        camera.type_ = Valid(Type::Orthographic);
        let xmag = half * aspect.unwrap_or(1.0);
        camera.orthographic = Some(Orthographic {
            xmag,
            ymag: half,
            zfar: far,
            znear: near,
            extensions: None,
            extras: Extras::default(),
        });
    } else {
        camera.perspective = Some(Perspective {
            aspect_ratio: aspect,
            yfov: 2.0 * (half / near).atan(),
            zfar: Some(far),
            znear: near,
            extensions: None,
            extras: Extras::default(),
        });
    }
    let is_symmetric = center.abs() <= 1e-3 * half && (top + bottom).abs() <= 1e-3 * half;
    Some((camera, is_symmetric))
}

/// Returns the pose of the free camera, which looks along its negative z-axis.
pub(super) fn free_pose(free: &FreeCamera) -> Pose {
    let pos = free.pos.map(f64::from);
    let unit = |vector: [f64; 3]| {
        let length = vector.iter().map(|part| part * part).sum::<f64>().sqrt();
        if length > 0.0 { vector.map(|part| part / length) } else { [1.0, 0.0, 0.0] }
    };
    let z = unit(std::array::from_fn(|axis| pos[axis] - free.lookat[axis]));
    let x = unit([-z[1], z[0], 0.0]);
    let y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]];
    Pose { pos, quat: mat2quat(&[x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]]) }
}
