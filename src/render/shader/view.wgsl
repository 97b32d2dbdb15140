// What is the same for all that is drawn in one view. `frame/uniform.rs` has the same.
struct View {
    clip: mat4x4f,
    // The head, and what colours are multiplied by.
    eye: vec4f,
    // The depth of a point, m, is this times it.
    depth: vec4f,
    // Light from everywhere.
    ambient: vec4f,
    fog_color: vec4f,
    // How much of a thing shows through the fog is the first times its depth plus the second.
    fog: vec4f,
    // Only what is on the positive side of this plane is drawn, where that is asked for.
    plane: vec4f,
    // Width and height of the picture, pixels; the width of lines, pixels; the near side of the frustum, m.
    pixels: vec4f,
    // Colour of haze, and the distance of the sky.
    sky: vec4f,
//#if LIGHTS
    lights: array<Light, LIGHT_COUNT>,
//#end
//#if SHADOWS
    shadows: array<Shadow, SHADOW_COUNT>,
//#end
}

@group(0) @binding(0) var<uniform> view: View;

//#if FOG
fn fogged(color: vec3f, depth: f32) -> vec3f {
    return mix(view.fog_color.rgb, color, clamp(view.fog.x * depth + view.fog.y, 0.0, 1.0));
}
//#end
