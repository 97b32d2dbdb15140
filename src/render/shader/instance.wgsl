// A corner of a shape, in the shape's own frame.
struct Corner {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) texcoord: vec2f,
}

// A shape in its place. `list/instance.rs` has the same.
struct Instance {
    // The rows of the matrix that places it.
    @location(3) x: vec4f,
    @location(4) y: vec4f,
    @location(5) z: vec4f,
    @location(6) rgba: vec4f,
    // Emission, specularity and shininess.
    @location(7) material: vec4f,
    // By what positions are multiplied to get texture coordinates.
    @location(8) texgen: vec4f,
    @location(9) id: u32,
}

fn placed(instance: Instance, position: vec3f) -> vec3f {
    let point = vec4f(position, 1.0);
    return vec3f(dot(instance.x, point), dot(instance.y, point), dot(instance.z, point));
}
