// Skybox, optionally with haze. The skybox is the inside of a cylinder around the camera with a
// cube texture. The haze is a ring above the horizon of an infinite plane, which hides the edge of
// the plane.

@group(1) @binding(0) var color_texture: texture_cube<f32>;
@group(1) @binding(1) var color_sampler: sampler;

struct Varyings {
    @builtin(position) position: vec4f,
    @location(0) direction: vec3f,
//#if HAZE
    @location(1) color: vec4f,
    @location(2) @interpolate(flat) is_haze: f32,
//#end
//#if FOG
    @location(3) depth: f32,
//#end
}

// Vertices of the skybox are relative to the camera, vertices of the haze in world space. The w
// component of the vertex is 1 for the haze.
@vertex
fn vs_main(@builtin(instance_index) image: u32, @location(0) vertex: vec4f, @location(1) color: vec4f) -> Varyings {
    var out: Varyings;
    let world = select(view.camera.xyz + vertex.xyz * view.sky.w, vertex.xyz, vertex.w > 0.5);
    out.position = view.clip * vec4f(world, 1.0);
    // The z-axis of the world is the y-axis of the cube texture.
    out.direction = vec3f(vertex.x, vertex.z, -vertex.y);
//#if HAZE
    out.color = color;
    out.is_haze = vertex.w;
//#end
//#if FOG
    out.depth = dot(view.depth, vec4f(world, 1.0));
//#end
    return out;
}

@fragment
fn fs_main(in: Varyings) -> @location(0) vec4f {
    var color = textureSample(color_texture, color_sampler, in.direction).rgb;
    var alpha = 1.0;
//#if HAZE
    color = select(color, in.color.rgb, in.is_haze > 0.5);
    alpha = in.color.a;
//#end
//#if FOG
    color = apply_fog(color, in.depth);
//#end
    return vec4f(color, alpha);
}
