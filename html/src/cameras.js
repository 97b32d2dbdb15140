// The free camera and those of the model.

import { OrthographicCamera, PerspectiveCamera, Vector3 } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

export class Cameras {
  constructor(canvas, look, frames, redraw) {
    this.frames = frames;
    this.list = [
      { name: 'Free camera', view: look.free.view },
      ...look.cameras.map((camera, index) => ({ ...camera, name: camera.name ?? `camera ${index}` })),
    ];
    for (const entry of this.list) {
      entry.camera = entry.view.orthographic ? new OrthographicCamera() : new PerspectiveCamera();
      entry.camera.up.set(0, 0, 1);
    }
    const { camera, view } = this.list[0];
    camera.fov = (2 * Math.atan2(view.frustum_top, view.frustum_near) * 180) / Math.PI;
    camera.position.fromArray(look.free.pos);
    this.controls = new OrbitControls(camera, canvas);
    this.controls.target.fromArray(look.lookat);
    this.controls.addEventListener('change', redraw);
    this.distance = this.controls.getDistance();
    this.middle = new Vector3();
    this.controls.update();
    this.select(0);
  }

  select(index) {
    this.selected = index;
    this.controls.enabled = index === 0;
  }

  get target() {
    return this.controls.target;
  }

  /** Moves the free camera with a body. */
  move(from, to) {
    const step = new Vector3().subVectors(to, from);
    this.controls.target.add(step);
    this.controls.object.position.add(step);
  }

  /** Moves the free camera so that its picture includes a grid with this middle. */
  include([x, y]) {
    const { target, object } = this.controls;
    const away = new Vector3().subVectors(object.position, target);
    const middle = new Vector3(x, y, 0);
    const distance = (point) => this.distance + 1.8 * point.length();
    target.add(middle).sub(this.middle);
    object.position.copy(target).addScaledVector(away, distance(middle) / distance(this.middle));
    this.middle = middle;
    this.controls.update();
  }

  /** Returns the selected camera, placed for an image of this ratio of width to height. */
  get(aspect) {
    const { camera, view, frame, pos, quat } = this.list[this.selected];
    if (frame !== undefined) {
      const object = this.frames[frame];
      camera.quaternion.set(quat[1], quat[2], quat[3], quat[0]).premultiply(object.quaternion);
      camera.position.fromArray(pos).applyQuaternion(object.quaternion).add(object.position);
    }
    const { frustum_center: center, frustum_width: width, frustum_near: near, frustum_far: far } = view;
    // An image that is higher than wide shows at least what a square would.
    const zoom = width > 0 || aspect >= 1 ? 1 : 1 / aspect;
    const [bottom, top] = [zoom * view.frustum_bottom, zoom * view.frustum_top];
    const half = width > 0 ? width : (aspect * (top - bottom)) / 2;
    const edges = { left: center - half, right: center + half, top, bottom, near, far };
    Object.assign(camera, { near, far });
    if (camera.isOrthographicCamera) {
      Object.assign(camera, edges).updateProjectionMatrix();
    } else {
      camera.projectionMatrix.makePerspective(edges.left, edges.right, top, bottom, near, far);
      camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
    }
    return camera;
  }
}
