// A corner of a shape, in the shape's own frame.
struct Corner {
    @location(0) position: vec3f,
//#if LIT
    @location(1) normal: vec3f,
//#end
//#if TEXTURED
    @location(2) texcoord: vec2f,
//#end
}

// A shape in its place. `list/instance.rs` has the same.
struct Instance {
    // The rows of the matrix that places it.
    @location(3) x: vec4f,
    @location(4) y: vec4f,
    @location(5) z: vec4f,
//#if COLORED
    @location(6) rgba: vec4f,
//#end
//#if LIT
    // Emission, specularity and shininess.
    @location(7) material: vec4f,
//#end
//#if TEXTURED
    // By what positions are multiplied to get texture coordinates.
    @location(8) texgen: vec4f,
//#end
//#if NUMBERED
    @location(9) id: u32,
//#end
}

fn placed(instance: Instance, position: vec3f) -> vec3f {
    let point = vec4f(position, 1.0);
    return vec3f(dot(instance.x, point), dot(instance.y, point), dot(instance.z, point));
}
