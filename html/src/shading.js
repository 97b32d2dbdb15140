// Lighting of the engine in place of that of three.js: without gamma, without factors of pi, and
// with the specular highlights and spot lights of OpenGL.

import { ColorManagement, ShaderChunk } from 'three';

ColorManagement.enabled = false;

function replace(chunk, from, to) {
  if (!ShaderChunk[chunk].includes(from)) throw new Error(`three.js has no '${from}' in ${chunk}`);
  ShaderChunk[chunk] = ShaderChunk[chunk].replaceAll(from, to);
}

/** `specular` is the ratio of the specular to the diffuse colours of the lights. */
export function useEngineLighting(specular) {
  const lambert = 'irradiance * BRDF_Lambert( material.diffuseColor )';
  replace('lights_phong_pars_fragment', lambert, 'irradiance * material.diffuseColor');
  replace(
    'lights_phong_pars_fragment',
    'irradiance * BRDF_BlinnPhong( directLight.direction, geometryViewDir, geometryNormal, material.specularColor, material.specularShininess ) * material.specularStrength',
    `( dotNL > 0.0 ? 1.0 : 0.0 ) * directLight.color * material.specularColor * ${specular.toFixed(4)}
      * pow( saturate( dot( geometryNormal, normalize( directLight.direction + geometryViewDir ) ) ), material.specularShininess )`,
  );
  // A texture is a factor on the light of all kinds, after the limit to the range of colours.
  ShaderChunk.map_pars_fragment = `vec4 engineTexel = vec4( 1.0 );\n${ShaderChunk.map_pars_fragment}`;
  replace('map_fragment', 'diffuseColor *= sampledDiffuseColor;', 'engineTexel = sampledDiffuseColor;');
  replace(
    'opaque_fragment',
    'gl_FragColor = vec4( outgoingLight, diffuseColor.a );',
    'gl_FragColor = vec4( min( outgoingLight, 1.0 ), diffuseColor.a ) * engineTexel;',
  );
  // The decay of a spot light is the exponent of its cone.
  replace(
    'lights_pars_begin',
    'getSpotAttenuation( spotLight.coneCos, spotLight.penumbraCos, angleCos )',
    '( angleCos < spotLight.coneCos ? 0.0 : pow( max( angleCos, 0.0 ), spotLight.decay ) )',
  );
  replace('lights_pars_begin', 'getDistanceAttenuation( lightDistance, spotLight.distance, spotLight.decay )', '1.0');
}
