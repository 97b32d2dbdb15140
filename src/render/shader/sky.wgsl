// The sky: the inside of a cylinder around the head, with a picture for each direction.

@group(1) @binding(0) var image: texture_cube<f32>;
@group(1) @binding(1) var image_sampler: sampler;

struct Between {
    @builtin(position) position: vec4f,
    @location(0) direction: vec3f,
//#if FOG
    @location(1) depth: f32,
//#end
}

@vertex
fn vertex(@location(0) corner: vec3f) -> Between {
    var out: Between;
    let world = view.eye.xyz + corner * view.sky.w;
    out.position = view.clip * vec4f(world, 1.0);
    // What is up in the world is y in the picture.
    out.direction = vec3f(corner.x, corner.z, -corner.y);
//#if FOG
    out.depth = dot(view.depth, vec4f(world, 1.0));
//#end
    return out;
}

@fragment
fn fragment(in: Between) -> @location(0) vec4f {
    var color = textureSample(image, image_sampler, in.direction).rgb;
//#if FOG
    color = fogged(color, in.depth);
//#end
    return vec4f(color, 1.0);
}
