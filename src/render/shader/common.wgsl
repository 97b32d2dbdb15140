// Declarations shared by all shaders.

//#if HAS_LIGHTS
// Light. `view/uniform.rs` declares the same structure.
struct Light {
    // Position; for a directional light the direction towards it.
    position: vec4f,
    // Axis of the cone; spot exponent.
    axis: vec4f,
    // Constant, linear and quadratic attenuation; cosine of the cutoff angle.
    attenuation: vec4f,
    ambient: vec4f,
    diffuse: vec4f,
    specular: vec4f,
}

// Shadow map. `view/uniform.rs` declares the same structure.
struct Shadow {
    // Projection from world space to texels and depths.
    texels: mat4x4f,
    // Coordinates of the first and of the last texel.
    bounds: vec4f,
    // Farthest depth.
    farthest: vec4f,
}

// Point of a surface.
struct SurfacePoint {
    world: vec3f,
    normal: vec3f,
    to_camera: vec3f,
    rgb: vec3f,
    // Emission, specularity and shininess.
    material: vec3f,
}

// Returns the unit vector in this direction. normalize divides each element, and has no value for
// zero.
fn direction(vector: vec3f) -> vec3f {
    return vector * inverseSqrt(max(dot(vector, vector), 1e-30));
}

// Returns a cosine to the power of a number from 0 to 128, by the square of the cosine. It is
// within 0.1 %, and takes half as long as pow on a processor: both polynomials are minimax
// approximations, and infinite, subnormal and negative numbers are not treated.
fn power_of_square(square: f32, exponent: f32) -> f32 {
    let bits = bitcast<i32>(square);
    let mantissa = bitcast<f32>((bits & 0x7fffff) | 0x3f800000) - 1.0;
    let square_mantissa = mantissa * mantissa;
    let polynomial = (1.44196565 - 0.70966328 * mantissa)
        + square_mantissa * ((0.41759749 - 0.19627202 * mantissa) + square_mantissa * 0.04638648);
    let logarithm = f32((bits >> 23u) - 127) + mantissa * polynomial;
    let power = max(0.5 * exponent * logarithm, -126.0);
    let whole = floor(power);
    let part = power - whole;
    let significand = (0.99992517 + 0.69583372 * part) + part * part * (0.22606737 + 0.07802402 * part);
    return bitcast<f32>(bitcast<i32>(significand) + (i32(whole) << 23u));
}
//#end

// Place of an image in a texture of several images. `view/uniform.rs` declares the same structure.
struct Place {
    // Scale and offset along x and y from the clip coordinates of the image to those of the texture.
    tile: vec4f,
    // Smallest x and y, and largest x and y, that are drawn, in clip coordinates of the image.
    edges: vec4f,
}

// Per-view uniforms. `view/uniform.rs` declares the same structure.
struct View {
    clip: mat4x4f,
    // Position of the camera; factor on all colours.
    camera: vec4f,
    // Product with a point (x, y, z, 1) is its depth, m.
    depth: vec4f,
    // Ambient light of the scene.
    ambient: vec4f,
    fog_color: vec4f,
    // Visibility in fog: slope and offset of a linear function of the depth.
    fog: vec4f,
    // Clipping plane. Shaders with clipping discard fragments on its negative side.
    plane: vec4f,
    // Width and height of the image, pixels; line width, pixels; distance of the near plane, m.
    pixels: vec4f,
    // Colour of the haze; distance of the skybox.
    sky: vec4f,
    place: Place,
//#if LIGHTS
    lights: array<Light, LIGHT_COUNT>,
//#end
//#if SHADOWS
    shadows: array<Shadow, SHADOW_COUNT>,
//#end
//#if PADDED
    unread: array<vec4f, UNREAD_COUNT>,
//#end
}

//#if SINGLE
@group(0) @binding(0) var<uniform> view: View;
//#end
//#if MERGED
// The views of all images. In the code, `view` is replaced by the element for the image.
@group(0) @binding(0) var<storage, read> views: array<View>;
var<private> view_index: u32;

// Returns the distances of a point from the edges of its image, in clip coordinates of the image.
fn edge_distances(point: vec4f) -> array<f32, 4> {
    let edges = view.place.edges * point.w;
    return array<f32, 4>(point.x - edges.x, point.y - edges.y, edges.z - point.x, edges.w - point.y);
}

// Returns the clip coordinates in the texture of all images.
fn placed(point: vec4f) -> vec4f {
    let tile = view.place.tile;
    return vec4f(point.xy * tile.xy + point.w * tile.zw, point.zw);
}
//#end

//#if FOG
fn apply_fog(color: vec3f, depth: f32) -> vec3f {
    return mix(view.fog_color.rgb, color, clamp(view.fog.x * depth + view.fog.y, 0.0, 1.0));
}
//#end

//#if INSTANCED
// Vertex, in the local frame of the shape.
struct Vertex {
    @location(0) position: vec3f,
//#if LIT
    @location(1) normal: vec3f,
//#end
//#if TEXTURED
    @location(2) texcoord: vec2f,
//#end
//#if QUAD_EDGES
    // Parity of the vertex: -1 or 1.
    @location(11) parity: f32,
//#end
}

// Instance. `draw_list/instance.rs` declares the same structure.
struct Instance {
    // Rows of the transformation from the local frame to world space.
    @location(3) x: vec4f,
    @location(4) y: vec4f,
    @location(5) z: vec4f,
//#if INSTANCE_COLOR
    @location(6) rgba: vec4f,
//#end
//#if MATERIAL
    // Emission, specularity and shininess; the width of a line in units of the line width.
    @location(7) material: vec3f,
//#end
//#if LIT
    // Reciprocals of the squared lengths of the columns of the transformation.
    @location(10) normal_scale: vec3f,
//#end
//#if TEXTURED
    // Texture coordinates: scale; 1 for the coordinates of the vertex, 0 for its local position.
    @location(8) texgen: vec4f,
    // Offset of the texture coordinates.
    @location(12) texture_offset: vec3f,
//#end
//#if INSTANCE_ID
    @location(9) id: u32,
//#end
//#if MERGED
    @location(13) view: u32,
//#end
}

fn to_world(instance: Instance, position: vec3f) -> vec3f {
    let point = vec4f(position, 1.0);
    return vec3f(dot(instance.x, point), dot(instance.y, point), dot(instance.z, point));
}
//#end
