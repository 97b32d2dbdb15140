// Textures and materials.

import { BufferAttribute, BufferGeometry, CubeTexture, DataTexture, LinearFilter } from 'three';
import { LinearMipmapLinearFilter, MeshPhongMaterial, RepeatWrapping, SRGBColorSpace, Texture } from 'three';

/** Decodes the textures of a look: a map from their indices. */
export async function loadTextures(binary, look) {
  const load = async ([index, texture]) => [index, texture && (await decode(binary, texture))];
  return new Map(await Promise.all(Object.entries(look.textures).map(load)));
}

async function decode(binary, { cube, srgb, png }) {
  const file = new Blob([binary.subarray(png[0], png[0] + png[1])], { type: 'image/png' });
  const options = { colorSpaceConversion: 'none', premultiplyAlpha: 'none' };
  const image = await createImageBitmap(file, options);
  let texture;
  if (cube) {
    const side = image.width;
    // From the file, because Firefox draws parts of an ImageBitmap black.
    const face = (i) => createImageBitmap(file, 0, image.height > side ? i * side : 0, side, side, options);
    texture = new CubeTexture(await Promise.all([0, 1, 2, 3, 4, 5].map(face)));
  } else {
    texture = new Texture(image);
    texture.wrapS = texture.wrapT = RepeatWrapping;
    if (srgb) texture.colorSpace = SRGBColorSpace;
  }
  texture.flipY = false;
  texture.generateMipmaps = true;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/** Returns the geometry with the texture coordinates of a geom, without a copy of the positions. */
export function textured(geometry, { explicit, scale, offset }) {
  const result = new BufferGeometry();
  for (const name of ['position', 'normal']) result.setAttribute(name, geometry.getAttribute(name));
  result.setIndex(geometry.index);
  const source = geometry.getAttribute(explicit && geometry.getAttribute('uv') ? 'uv' : 'position');
  const uv = new Float32Array(2 * source.count);
  for (let i = 0; i < source.count; i++) {
    uv[2 * i] = source.getX(i) * scale[0] + offset[0];
    uv[2 * i + 1] = source.getY(i) * scale[1] + offset[1];
  }
  return result.setAttribute('uv', new BufferAttribute(uv, 2));
}

// Geoms without a texture have this one, so that all are drawn by one program.
const WHITE = new DataTexture(new Uint8Array([255, 255, 255, 255]), 1, 1);
WHITE.needsUpdate = true;

/** `opacity` is a factor on that of the geom. */
export function material(geom, texture, opacity) {
  const [r, g, b, a] = geom.rgba;
  const result = new MeshPhongMaterial({
    shininess: Math.max(128 * geom.shininess, 1e-3),
    opacity: a * opacity,
    transparent: a * opacity < 1,
    depthWrite: opacity === 1,
  });
  result.color.setRGB(r, g, b);
  result.specular.setScalar(geom.specular);
  result.emissive.setRGB(r, g, b).multiplyScalar(geom.emission);
  if (texture?.isCubeTexture) useCube(result, texture, geom.map.scale);
  else result.map = texture ?? WHITE;
  return result;
}

/** Samples a cube texture in the direction of the local position. */
function useCube(result, texture, scale) {
  const factors = scale.map((factor) => factor.toExponential()).join(', ');
  result.onBeforeCompile = (shader) => {
    shader.uniforms.engineCube = { value: texture };
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', '#include <common>\nvarying vec3 vDirection;')
      .replace('#include <begin_vertex>', `#include <begin_vertex>\nvDirection = position * vec3( ${factors} );`);
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', '#include <common>\nvarying vec3 vDirection;\nuniform samplerCube engineCube;')
      .replace('#include <map_fragment>', 'engineTexel.rgb = texture( engineCube, vDirection ).rgb;');
  };
  result.customProgramCacheKey = () => factors;
}
