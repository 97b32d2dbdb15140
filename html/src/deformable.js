// Tendons, skins and flexes: shapes whose vertices move.

import { BufferAttribute, BufferGeometry, CylinderGeometry, DoubleSide, InstancedMesh, Mesh, Object3D, Vector3 } from 'three';
import { material } from './surface.js';

const UP = new Vector3(0, 1, 0);

export class Deformable {
  /** `faces` has the indices of triangles; without them the vertices are the ends of segments. */
  constructor(look, faces, track, index, opacity) {
    this.track = track;
    this.channels = track.deformables[index];
    const surface = material(look, null, opacity);
    this.position = new Float32Array(this.channels.length);
    if (faces) {
      surface.side = DoubleSide;
      this.geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(this.position, 3));
      this.geometry.setIndex(new BufferAttribute(faces, 1));
      this.object = new Mesh(this.geometry, surface);
    } else {
      this.place = new Object3D();
      const segment = new CylinderGeometry(look.radius, look.radius, 1, 12);
      this.object = new InstancedMesh(segment, surface, this.position.length / 6);
    }
    this.object.frustumCulled = false;
    this.object.castShadow = this.object.receiveShadow = opacity === 1;
  }

  update(time) {
    const [i, j, f] = this.track.place(time);
    this.channels.forEach((values, at) => (this.position[at] = values[i] + f * (values[j] - values[i])));
    if (this.geometry) {
      this.geometry.attributes.position.needsUpdate = true;
      this.geometry.computeVertexNormals();
      return;
    }
    const [from, to] = [new Vector3(), new Vector3()];
    for (let segment = 0; segment < this.object.count; segment++) {
      from.fromArray(this.position, 6 * segment);
      to.fromArray(this.position, 6 * segment + 3);
      this.place.position.addVectors(from, to).multiplyScalar(0.5);
      this.place.scale.set(1, from.distanceTo(to), 1);
      this.place.quaternion.setFromUnitVectors(UP, to.sub(from).normalize());
      this.place.updateMatrix();
      this.object.setMatrixAt(segment, this.place.matrix);
    }
    this.object.instanceMatrix.needsUpdate = true;
  }
}
