// Shapes of geoms, in metres, in their local frames.

import { BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, CylinderGeometry } from 'three';
import { PlaneGeometry, SphereGeometry, Vector3 } from 'three';
import { PREVIOUS, channels, scaled } from './data.js';

/** Smallest cosine between the normals of a smooth vertex and of its face, as in the engine. */
const SMOOTH = 0.8;

export class Shapes {
  constructor(binary, look) {
    this.binary = binary;
    this.look = look;
    this.known = new Map();
  }

  /** Returns the geometry of a geom, shared by all of the same shape. Coarse spheres have fewer triangles. */
  get({ shape, size, asset }, isCoarse = false) {
    const key = asset === null ? `${shape} ${size} ${isCoarse}` : `${shape} ${asset}`;
    if (!this.known.has(key)) this.known.set(key, this.create(shape, size, asset, isCoarse ? 0.3 : 1));
    return this.known.get(key);
  }

  create(shape, [x, y, z], asset, detail) {
    const upright = Math.PI / 2;
    const steps = (number) => Math.round(number * detail);
    switch (shape) {
      case 'plane': {
        const far = this.look.free.view.frustum_far;
        return new PlaneGeometry(2 * (x > 0 ? x : far), 2 * (y > 0 ? y : far));
      }
      case 'ellipsoid':
        return new SphereGeometry(1, steps(32), steps(20)).rotateX(upright).scale(x, y, z);
      case 'capsule':
        return new CapsuleGeometry(x, 2 * z, steps(10), steps(28)).rotateX(upright);
      case 'cylinder':
        return new CylinderGeometry(x, x, 2 * z, steps(40)).rotateX(upright);
      case 'box':
        return new BoxGeometry(2 * x, 2 * y, 2 * z);
      case 'mesh':
        return this.mesh(this.look.meshes[asset]);
      case 'heightfield':
        return this.heightField(this.look.height_fields[asset]);
      default:
        throw new Error(`unknown shape ${shape}`);
    }
  }

  /** Triangles with a normal for each corner: of the vertex where it is smooth, else of the face. */
  mesh({ positions, texcoords }) {
    const { count } = positions;
    const axes = this.vectors(positions);
    const corners = this.indices(positions.faces);
    const position = new Float32Array(3 * corners.length);
    corners.forEach((vertex, corner) => {
      for (let axis = 0; axis < 3; axis++) position[3 * corner + axis] = axes[axis][vertex];
    });
    const flat = faceNormals(position);
    const first = vertexNormals(corners, count, flat, null);
    const smooth = vertexNormals(corners, count, flat, first);
    const normal = new Float32Array(position.length);
    const [face, vertexNormal] = [new Vector3(), new Vector3()];
    corners.forEach((vertex, corner) => {
      face.fromArray(flat, 3 * Math.floor(corner / 3)).normalize();
      vertexNormal.fromArray(smooth, 3 * vertex);
      const isSmooth = texcoords || vertexNormal.dot(face) >= SMOOTH;
      (isSmooth && vertexNormal.lengthSq() > 0 ? vertexNormal : face).toArray(normal, 3 * corner);
    });
    const geometry = geometryOf(position);
    geometry.setAttribute('normal', new BufferAttribute(normal, 3));
    if (texcoords) {
      const [u, v] = this.vectors(texcoords);
      const indices = this.indices(texcoords.faces);
      const uv = new Float32Array(2 * corners.length);
      for (let i = 0; i < Math.min(indices.length, corners.length); i++) uv.set([u[indices[i]], v[indices[i]]], 2 * i);
      geometry.setAttribute('uv', new BufferAttribute(uv, 2));
    }
    return geometry;
  }

  vectors({ intervals, vectors, count }) {
    const components = channels(this.binary, vectors, intervals.length, count, PREVIOUS);
    return components.map((integers, axis) => scaled(integers, intervals[axis]));
  }

  indices(part) {
    let count = 0;
    for (let i = part[0]; i < part[0] + part[1]; i++) count += this.binary[i] < 128 ? 1 : 0;
    return Uint32Array.from(channels(this.binary, part, 1, count, PREVIOUS)[0]);
  }

  /** The surface, four sides down to the base, and the base. */
  heightField({ rows, columns, size, interval, elevations }) {
    const heights = scaled(channels(this.binary, elevations, 1, rows * columns, PREVIOUS)[0], interval);
    const along = (i, n, half) => half * ((2 * i) / (n - 1) - 1);
    const point = (row, column, z) => [along(column, columns, size[0]), along(row, rows, size[1]), z];
    const top = (row, column) => point(row, column, heights[row * columns + column] * size[2]);
    const base = (row, column) => point(row, column, -size[3]);
    const corners = [];
    const quad = (a, b, c, d) => corners.push(...a, ...b, ...c, ...a, ...c, ...d);
    for (let i = 0; i < rows - 1; i++) {
      for (let j = 0; j < columns - 1; j++) quad(top(i, j), top(i, j + 1), top(i + 1, j + 1), top(i + 1, j));
      quad(base(i, columns - 1), base(i + 1, columns - 1), top(i + 1, columns - 1), top(i, columns - 1));
      quad(base(i + 1, 0), base(i, 0), top(i, 0), top(i + 1, 0));
    }
    for (let j = 0; j < columns - 1; j++) {
      quad(base(0, j), base(0, j + 1), top(0, j + 1), top(0, j));
      quad(base(rows - 1, j + 1), base(rows - 1, j), top(rows - 1, j), top(rows - 1, j + 1));
    }
    quad(base(0, 0), base(rows - 1, 0), base(rows - 1, columns - 1), base(0, columns - 1));
    const geometry = geometryOf(Float32Array.from(corners));
    geometry.computeVertexNormals();
    return geometry;
  }
}

function geometryOf(position) {
  return new BufferGeometry().setAttribute('position', new BufferAttribute(position, 3));
}

/** Normals of triangles, with lengths of twice their areas. */
function faceNormals(position) {
  const normals = new Float32Array(position.length / 3);
  const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
  for (let i = 0; i < normals.length; i += 3) {
    a.fromArray(position, 3 * i);
    b.fromArray(position, 3 * i + 3).sub(a);
    c.fromArray(position, 3 * i + 6).sub(a);
    b.cross(c).toArray(normals, i);
  }
  return normals;
}

/** Mean normals of vertices, of the faces within the smooth angle to the normals `near`. */
function vertexNormals(corners, count, flat, near) {
  const normals = new Float32Array(3 * count);
  const [face, before] = [new Vector3(), new Vector3()];
  corners.forEach((vertex, corner) => {
    face.fromArray(flat, 3 * Math.floor(corner / 3));
    if (near && before.fromArray(near, 3 * vertex).dot(face) < SMOOTH * face.length()) return;
    normals[3 * vertex] += face.x;
    normals[3 * vertex + 1] += face.y;
    normals[3 * vertex + 2] += face.z;
  });
  for (let i = 0; i < normals.length; i += 3) face.fromArray(normals, i).normalize().toArray(normals, i);
  return normals;
}
