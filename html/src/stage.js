// The scene of three.js: the geoms of all tracks, lights and sky.

import { AmbientLight, BackSide, BoxGeometry, DirectionalLight, Mesh, Object3D, PCFShadowMap } from 'three';
import { Scene, ShaderMaterial, SpotLight, Vector3, WebGLRenderer } from 'three';
import { Deformable } from './deformable.js';
import { Shapes } from './geometry.js';
import { Ghosts } from './ghosts.js';
import { useEngineLighting } from './shading.js';
import { loadTextures, material, textured } from './surface.js';

const SHADOWS = 4;
/** Number of tracks from which ghosts have fewer triangles. */
const MANY = 8;

export class Stage {
  static async create(canvas, { description, binary }, tracks) {
    const stage = new Stage();
    stage.look = description.look;
    stage.tracks = tracks;
    useEngineLighting(specularRatio(stage.look.lights));
    stage.renderer = new WebGLRenderer({ canvas, antialias: true });
    // Colours are not converted.
    stage.renderer.outputColorSpace = 'srgb-linear';
    stage.renderer.shadowMap.enabled = true;
    stage.renderer.shadowMap.type = PCFShadowMap;
    stage.scene = new Scene();
    const textures = await loadTextures(binary, stage.look);
    stage.textures = textures;
    const shapes = new Shapes(binary, stage.look);
    stage.addGeoms(shapes, description.frames);
    stage.addDeformables(shapes);
    stage.addLights(description.extent);
    stage.addSky();
    return stage;
  }

  /** Frames of each place, and the geoms in them: the first has meshes, the others are ghosts. */
  addGeoms(shapes, count) {
    this.places = this.tracks.map(() => new Object3D());
    this.frames = this.places.map((place) => {
      this.scene.add(place);
      return Array.from({ length: count }, () => {
        const frame = new Object3D();
        place.add(frame);
        return frame;
      });
    });
    this.ghosts = new Ghosts(this.scene, this.frames.slice(1));
    const areMany = this.tracks.length > MANY;
    this.meshes = [];
    const fixed = Array.from({ length: count }, (_, frame) => this.tracks.every((t) => t.isFixed(frame, this.tracks[0])));
    for (const geom of this.look.geoms) {
      const texture = geom.texture === null ? null : this.textures.get(String(geom.texture));
      const geometryOf = (isCoarse) => {
        const shape = shapes.get(geom, isCoarse);
        return texture && !texture.isCubeTexture ? textured(shape, geom.map) : shape;
      };
      const geometry = geometryOf(false);
      const mesh = new Mesh(geometry, material(geom, texture, 1));
      mesh.position.fromArray(geom.pos);
      mesh.quaternion.set(geom.quat[1], geom.quat[2], geom.quat[3], geom.quat[0]);
      mesh.castShadow = geom.shape !== 'plane';
      mesh.receiveShadow = true;
      mesh.userData = { geom };
      this.frames[0][geom.frame].add(mesh);
      this.meshes.push(mesh);
      this.ghosts.add(geom, areMany ? geometryOf(true) : geometry, texture, fixed[geom.frame]);
    }
  }

  /** The shapes of each track that has them. */
  addDeformables(shapes) {
    this.deformables = (this.look.deformables ?? []).flatMap((look, index) => {
      const faces = look.faces && shapes.indices(look.faces);
      return this.tracks.flatMap((track, at) => {
        if (!track.deformables[index]) return [];
        const deformable = new Deformable(look, faces, track, index, this.ghosts.opacity);
        this.scene.add(deformable.object);
        return { deformable, at };
      });
    });
  }

  /** Selects the track in the first place, and how the others are drawn. */
  arrange(chosen, layout) {
    const others = this.tracks.map((_, index) => index).filter((index) => index !== chosen);
    this.order = [chosen, ...others];
    this.layout = layout;
    this.ghosts.setOpaque(layout.isSideBySide);
    this.places.forEach((place, index) => place.position.set(...layout.offset(index), 0));
    for (const { deformable, at } of this.deformables) {
      const place = this.order.indexOf(at);
      deformable.object.visible = place === 0 || !layout.isSingle;
      deformable.object.position.copy(this.places[place].position);
      deformable.setOpaque(place === 0 || layout.isSideBySide);
    }
  }

  addLights(extent) {
    this.extent = extent;
    this.lights = [];
    const ambient = new AmbientLight(0);
    this.scene.add(ambient);
    let shadows = 0;
    for (const light of this.look.lights) {
      const angle = (Math.min(light.cutoff, 179) * Math.PI) / 180;
      const object = light.directional
        ? new DirectionalLight(0, 1)
        : new SpotLight(0, 1, 0, angle, 0, light.exponent);
      object.color.setRGB(...light.diffuse);
      const [r, g, b] = light.ambient;
      ambient.color.r += r;
      ambient.color.g += g;
      ambient.color.b += b;
      if (light.castshadow && shadows < SHADOWS) {
        shadows += 1;
        object.castShadow = true;
        object.shadow.mapSize.set(2048, 2048);
        object.shadow.normalBias = 0.005 * extent;
        const camera = object.shadow.camera;
        Object.assign(camera, { near: 0.02 * extent, far: 20 * extent });
        if (light.directional) Object.assign(camera, { left: -extent, right: extent, top: extent, bottom: -extent });
        camera.updateProjectionMatrix();
      }
      this.scene.add(object, object.target);
      this.lights.push({ light, object });
    }
  }

  addSky() {
    const texture = this.look.sky === null ? null : this.textures.get(String(this.look.sky));
    if (!texture?.isCubeTexture) return;
    // The z-axis of the world is the y-axis of the texture.
    this.sky = new Mesh(
      new BoxGeometry(1, 1, 1),
      new ShaderMaterial({
        uniforms: { sky: { value: texture } },
        vertexShader: `varying vec3 vDirection;
          void main() {
            vDirection = vec3( position.x, position.z, - position.y );
            gl_Position = projectionMatrix * mat4( mat3( viewMatrix ) ) * vec4( position, 1.0 );
            gl_Position.z = 0.0; // between the near and the far plane
          }`,
        fragmentShader: `varying vec3 vDirection; uniform samplerCube sky;
          void main() { gl_FragColor = vec4( texture( sky, vDirection ).rgb, 1.0 ); }`,
        side: BackSide,
        depthTest: false,
        depthWrite: false,
      }),
    );
    this.sky.frustumCulled = false;
    // Before all others. The depth of a surface around the camera is not precise.
    this.sky.renderOrder = -1;
    this.scene.add(this.sky);
  }

  /** `count` is the number of tracks that are present. */
  setTime(time, count) {
    const present = this.layout.isSingle ? 1 : count;
    for (let place = 0; place < present; place++) this.tracks[this.order[place]].pose(time, this.frames[place]);
    this.scene.updateMatrixWorld();
    this.ghosts.update(present - 1);
    for (const { deformable } of this.deformables) if (deformable.object.visible) deformable.update(time);
  }

  /** Draws the scene; `center` is the centre of the region with shadows of directional lights. */
  draw(camera, center) {
    this.scene.updateMatrixWorld();
    camera.updateMatrixWorld();
    for (const { light, object } of this.lights) {
      const frame = light.frame === null ? camera : this.frames[0][light.frame];
      const position = new Vector3(...light.pos).applyMatrix4(frame.matrixWorld);
      const direction = new Vector3(...light.dir).transformDirection(frame.matrixWorld);
      if (light.directional) position.copy(center).addScaledVector(direction, -10 * this.extent);
      object.position.copy(position);
      object.target.position.copy(position).add(direction);
    }
    this.renderer.render(this.scene, camera);
  }
}

function specularRatio(lights) {
  const sum = (name) => lights.reduce((total, light) => total + light[name][0] + light[name][1] + light[name][2], 0);
  const diffuse = sum('diffuse');
  return diffuse > 0 ? sum('specular') / diffuse : 0;
}
