// Tendons, skins and flexes: shapes whose vertices move.

import { BufferAttribute, BufferGeometry, CylinderGeometry, DoubleSide } from 'three';
import { InstancedBufferAttribute, InstancedMesh, Mesh, Object3D, Vector3 } from 'three';
import { material } from './surface.js';

const UP = new Vector3(0, 1, 0);

export class Deformable {
  /** `faces`: corners of triangles; without them the vertices end segments. `opacity`: of ghosts. */
  constructor(look, faces, track, index, opacity) {
    Object.assign(this, { track, index });
    this.surfaces = [opacity, 1].map((factor) => material(look, null, factor));
    if (faces) {
      for (const surface of this.surfaces) surface.side = DoubleSide;
      this.geometry = new BufferGeometry().setIndex(new BufferAttribute(faces, 1));
      // A first picture without normals would make the surface flat for ever.
      const count = faces.reduce((most, index) => Math.max(most, index + 1), 0);
      for (const name of ['position', 'normal']) {
        this.geometry.setAttribute(name, new BufferAttribute(new Float32Array(3 * count), 3));
      }
      this.object = new Mesh(this.geometry, this.surfaces[1]);
    } else {
      this.place = new Object3D();
      this.object = new InstancedMesh(new CylinderGeometry(look.radius, look.radius, 1, 12), this.surfaces[1], 1);
    }
    this.object.frustumCulled = false;
  }

  setOpaque(isOpaque) {
    this.object.material = this.surfaces[isOpaque ? 1 : 0];
    this.object.castShadow = this.object.receiveShadow = isOpaque;
  }

  update(time) {
    const vertices = this.track.vertices(this.index, time);
    if (this.geometry) this.updateSurface(vertices);
    else this.updateSegments(vertices);
  }

  updateSurface(vertices) {
    const { position } = this.geometry.attributes;
    position.array.set(vertices.subarray(0, position.array.length));
    position.needsUpdate = true;
    this.geometry.computeVertexNormals();
  }

  updateSegments(vertices) {
    const count = vertices.length / 6;
    if (this.object.instanceMatrix.count < count) {
      this.object.dispose();
      this.object.instanceMatrix = new InstancedBufferAttribute(new Float32Array(16 * count), 16);
    }
    this.object.count = count;
    const [from, to] = [new Vector3(), new Vector3()];
    for (let segment = 0; segment < count; segment++) {
      from.fromArray(vertices, 6 * segment);
      to.fromArray(vertices, 6 * segment + 3);
      this.place.position.addVectors(from, to).multiplyScalar(0.5);
      this.place.scale.set(1, from.distanceTo(to), 1);
      this.place.quaternion.setFromUnitVectors(UP, to.sub(from).normalize());
      this.place.updateMatrix();
      this.object.setMatrixAt(segment, this.place.matrix);
    }
    this.object.instanceMatrix.needsUpdate = true;
  }
}
