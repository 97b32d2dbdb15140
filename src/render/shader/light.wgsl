// A light. `frame/uniform.rs` has the same.
struct Light {
    // Its place; for a directional one the direction towards it.
    place: vec4f,
    // The axis of its cone, and how much it is focused.
    axis: vec4f,
    // Constant, linear and quadratic attenuation; the cosine of its cone.
    attenuation: vec4f,
    ambient: vec4f,
    diffuse: vec4f,
    specular: vec4f,
}

// From the world to the texels of a shadow map and their depths, the last texel, and the farthest depth.
struct Shadow {
    texels: mat4x4f,
    last: vec4f,
}

// A point of a surface.
struct Point {
    world: vec3f,
    normal: vec3f,
    // The direction towards the eye.
    eye: vec3f,
    rgb: vec3f,
    // Emission, specularity and shininess.
    material: vec3f,
}
