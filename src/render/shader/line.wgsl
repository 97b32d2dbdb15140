// Line: a rectangle with a width of a few pixels. The x coordinate of a vertex is 0 or 1 along the
// line, the y coordinate -1 or 1 across it.

struct Varyings {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) rgba: vec4f,
    @location(1) depth: f32,
    @location(2) side: f32,
    @location(3) @interpolate(flat) id: u32,
//#if SHADOWS
    @location(4) world: vec3f,
//#end
}

@vertex
fn vs_main(vertex: Vertex, instance: Instance) -> Varyings {
    var out: Varyings;
    let start = view.clip * vec4f(to_world(instance, vec3f(0.0)), 1.0);
    let end = view.clip * vec4f(to_world(instance, vec3f(0.0, 0.0, 1.0)), 1.0);
    // Clip at the near plane here: points behind the camera have no direction on the screen. Lines
    // in that plane are visible in spite of rounding.
    let depths = 1.0001 * vec2f(start.w, end.w) - vec2f(start.z, end.z);
    let cut = select(vec2f(0.0, 1.0), vec2f(depths.x / (depths.x - depths.y)), depths < vec2f(0.0));
    let is_hidden = depths.x < 0.0 && depths.y < 0.0;
    let a = mix(start, end, cut.x);
    let b = mix(start, end, cut.y);
    let along = (b.xy / max(b.w, 1e-20) - a.xy / max(a.w, 1e-20)) * view.pixels.xy;
    var across = vec2f(-along.y, along.x) * inverseSqrt(max(dot(along, along), 1e-20));
    // OpenGL draws no line narrower than a pixel.
    var width = max(instance.material.x * view.pixels.z, 1.0);
//#if ALIASED
    // Without multisampling its lines have a whole number of pixels along x or y.
    across = select(vec2f(0.0, 1.0), vec2f(1.0, 0.0), abs(along.y) > abs(along.x));
    width = round(width);
//#end
    let centre = mix(a, b, vertex.position.x);
    let offset = across * vertex.position.y * width / view.pixels.xy * centre.w;
    out.position = select(vec4f(centre.xy + offset, min(centre.z, centre.w), centre.w), vec4f(0.0, 0.0, -1.0, 1.0), is_hidden);
    let world = to_world(instance, vec3f(0.0, 0.0, mix(cut.x, cut.y, vertex.position.x)));
    out.rgba = vec4f(instance.rgba.rgb * view.camera.w, instance.rgba.a);
    out.depth = dot(view.depth, vec4f(world, 1.0));
    out.side = dot(view.plane, vec4f(world, 1.0));
    out.id = instance.id;
//#if SHADOWS
    out.world = world;
//#end
    return out;
}

//#if IDS
@fragment
fn fs_main(in: Varyings) -> @location(0) vec2u {
    return vec2u(in.id, bitcast<u32>(in.depth));
}
//#end
//#if COLOR
@fragment
fn fs_main(in: Varyings) -> @location(0) vec4f {
//#if CLIP
    if in.side < 0.0 {
        discard;
    }
//#end
    var color = in.rgba.rgb;
//#fragment_shadow
//#if FOG
    color = apply_fog(color, in.depth);
//#end
    return vec4f(color, in.rgba.a);
}
//#end
