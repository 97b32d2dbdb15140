// A line: a rectangle of a few pixels' width. The corners of its shape are at 0 or 1 along it, and at -1 or 1 across.

struct Between {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) rgba: vec4f,
    @location(1) depth: f32,
    @location(2) side: f32,
    @location(3) @interpolate(flat) id: u32,
}

@vertex
fn vertex(corner: Corner, instance: Instance) -> Between {
    var out: Between;
    let start = view.clip * vec4f(placed(instance, vec3f(0.0)), 1.0);
    let end = view.clip * vec4f(placed(instance, vec3f(0.0, 0.0, 1.0)), 1.0);
    // What is before the near side is cut off here: behind the eye there are no directions on the picture.
    let room = vec2f(start.z, end.z);
    let cut = select(vec2f(0.0, 1.0), vec2f(room.x / (room.x - room.y)), room < vec2f(0.0));
    let is_hidden = room.x < 0.0 && room.y < 0.0;
    let a = mix(start, end, cut.x);
    let b = mix(start, end, cut.y);
    let along = (b.xy / max(b.w, 1e-20) - a.xy / max(a.w, 1e-20)) * view.pixels.xy;
    let across = vec2f(-along.y, along.x) * inverseSqrt(max(dot(along, along), 1e-20));
    let width = 3.0 * view.pixels.z;
    let place = mix(a, b, corner.position.x);
    let shift = across * corner.position.y * width / view.pixels.xy * place.w;
    out.position = select(vec4f(place.xy + shift, place.zw), vec4f(0.0, 0.0, -1.0, 1.0), is_hidden);
    let world = placed(instance, vec3f(0.0, 0.0, mix(cut.x, cut.y, corner.position.x)));
    out.rgba = vec4f(instance.rgba.rgb * view.eye.w, instance.rgba.a);
    out.depth = dot(view.depth, vec4f(world, 1.0));
    out.side = dot(view.plane, vec4f(world, 1.0));
    out.id = instance.id;
    return out;
}

//#if IDS
@fragment
fn fragment(in: Between) -> @location(0) vec2u {
    return vec2u(in.id, bitcast<u32>(in.depth));
}
//#end
//#if COLOR
@fragment
fn fragment(in: Between) -> @location(0) vec4f {
//#if CLIP
    if in.side < 0.0 {
        discard;
    }
//#end
    var color = in.rgba.rgb;
//#if FOG
    color = fogged(color, in.depth);
//#end
    return vec4f(color, in.rgba.a);
}
//#end
