// The sky, which is the inside of a cylinder around the head with a picture for each direction, and the haze: a ring above the horizon of
// an infinite plane, which hides where the plane ends.

@group(1) @binding(0) var image: texture_cube<f32>;
@group(1) @binding(1) var image_sampler: sampler;

struct Between {
    @builtin(position) position: vec4f,
    @location(0) direction: vec3f,
    @location(1) color: vec4f,
    @location(2) @interpolate(flat) is_haze: f32,
//#if FOG
    @location(3) depth: f32,
//#end
}

// A corner of the sky is seen from the head; one of the haze is in the world's frame.
@vertex
fn vertex(@location(0) corner: vec4f, @location(1) color: vec4f) -> Between {
    var out: Between;
    let world = select(view.eye.xyz + corner.xyz * view.sky.w, corner.xyz, corner.w > 0.5);
    out.position = view.clip * vec4f(world, 1.0);
    // What is up in the world is y in the picture.
    out.direction = vec3f(corner.x, corner.z, -corner.y);
    out.color = color;
    out.is_haze = corner.w;
//#if FOG
    out.depth = dot(view.depth, vec4f(world, 1.0));
//#end
    return out;
}

@fragment
fn fragment(in: Between) -> @location(0) vec4f {
    let texel = textureSample(image, image_sampler, in.direction).rgb;
    var color = select(texel, in.color.rgb, in.is_haze > 0.5);
//#if FOG
    color = fogged(color, in.depth);
//#end
    return vec4f(color, in.color.a);
}
