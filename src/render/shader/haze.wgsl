// Haze: a ring above the horizon of an infinite plane, which hides where the plane ends. Its corners are in the world's frame.

struct Between {
    @builtin(position) position: vec4f,
    @location(0) color: vec4f,
//#if FOG
    @location(1) depth: f32,
//#end
}

@vertex
fn vertex(@location(0) corner: vec3f, @location(1) color: vec4f) -> Between {
    var out: Between;
    out.position = view.clip * vec4f(corner, 1.0);
    out.color = color;
//#if FOG
    out.depth = dot(view.depth, vec4f(corner, 1.0));
//#end
    return out;
}

@fragment
fn fragment(in: Between) -> @location(0) vec4f {
    var color = in.color.rgb;
//#if FOG
    color = fogged(color, in.depth);
//#end
    return vec4f(color, in.color.a);
}
