// Simulations besides the one that is drawn in full: each geom is drawn for all of them at once.

import { Color, InstancedMesh, Matrix4, Quaternion, Vector3 } from 'three';
import { material } from './surface.js';

const WHITE = new Color(1, 1, 1);
const SELECTED = new Color(2, 2, 2);
const NOWHERE = new Matrix4().makeScale(0, 0, 0);

export class Ghosts {
  /** `frames` are the frames of each ghost. */
  constructor(scene, frames) {
    // Many ghosts that overlap must not hide the simulation.
    const opacity = Math.min(0.3, 1.2 / Math.sqrt(frames.length));
    Object.assign(this, { scene, frames, opacity, meshes: [] });
  }

  /** `isFixed`: all simulations have the geom in the same place. */
  add(geom, geometry, texture, isFixed) {
    if (this.frames.length === 0) return;
    const [opaque, transparent] = [1, this.opacity].map((opacity) => material(geom, texture, opacity));
    const mesh = new InstancedMesh(geometry, transparent, this.frames.length);
    // The bounds would be those of the first time.
    mesh.frustumCulled = mesh.visible = false;
    const [w, x, y, z] = geom.quat;
    const local = new Matrix4().compose(new Vector3(...geom.pos), new Quaternion(x, y, z, w), new Vector3(1, 1, 1));
    mesh.userData = { geom, isFixed, local, opaque, transparent };
    this.scene.add(mesh);
    this.meshes.push(mesh);
  }

  /** Draws the ghosts opaque, with what does not move, or transparent. */
  setOpaque(isOpaque) {
    for (const mesh of this.meshes) {
      const { geom, isFixed, opaque, transparent } = mesh.userData;
      mesh.material = isOpaque ? opaque : transparent;
      // A plane is as large as the space between the simulations, or larger.
      mesh.userData.isShown = !isFixed || (isOpaque && geom.shape !== 'plane');
      mesh.castShadow = mesh.receiveShadow = isOpaque;
    }
  }

  /** Places the geoms of the first ghosts, whose frames have world matrices. */
  update(count) {
    for (const mesh of this.meshes) {
      const { geom, isShown, local } = mesh.userData;
      mesh.count = count;
      mesh.visible = isShown && count > 0;
      const matrix = new Matrix4();
      for (let ghost = 0; ghost < count; ghost++) {
        const { matrixWorld } = this.frames[ghost][geom.frame];
        mesh.setMatrixAt(ghost, Number.isNaN(matrixWorld.elements[12]) ? NOWHERE : matrix.multiplyMatrices(matrixWorld, local));
      }
      mesh.instanceMatrix.needsUpdate = true;
      mesh.boundingSphere = null;
    }
  }

  highlight(mesh, ghost, isSelected) {
    if (!mesh.instanceColor) for (let other = 0; other < this.frames.length; other++) mesh.setColorAt(other, WHITE);
    mesh.setColorAt(ghost, isSelected ? SELECTED : WHITE);
    mesh.instanceColor.needsUpdate = true;
  }
}
