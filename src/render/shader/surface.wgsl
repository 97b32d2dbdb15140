// A surface: a shape in its place, in the light of all lights at once.

struct Between {
    @builtin(position) position: vec4f,
//#if IDS
    @location(0) @interpolate(flat) id: u32,
    @location(1) depth: f32,
//#end
//#if COLOR
//#if VERTEX_LIGHT
    @location(0) base: vec4f,
//#end
//#if PIXEL_LIGHT
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) @interpolate(flat) rgba: vec4f,
    @location(3) @interpolate(flat) material: vec3f,
//#end
//#if FLAT
    @location(0) @interpolate(flat) rgba: vec4f,
//#end
//#if TEXTURED
    @location(4) texcoord: vec3f,
//#end
//#if FOG
    @location(5) depth: f32,
//#end
//#if CLIP
    @location(6) side: f32,
//#end
//#between
//#end
}

//#if TEXTURE_FLAT
@group(1) @binding(0) var image: texture_2d<f32>;
@group(1) @binding(1) var image_sampler: sampler;
//#end
//#if TEXTURE_CUBE
@group(1) @binding(0) var image: texture_cube<f32>;
@group(1) @binding(1) var image_sampler: sampler;
//#end

@vertex
fn vertex(corner: Corner, instance: Instance) -> Between {
    var out: Between;
    let world = placed(instance, corner.position);
    out.position = view.clip * vec4f(world, 1.0);
//#if IDS
    out.id = instance.id;
    out.depth = dot(view.depth, vec4f(world, 1.0));
//#end
//#if COLOR
//#if LIT
    // The columns of the matrix, each divided by the square of its length: the inverse of its transpose.
    let across = vec3f(instance.x.x, instance.y.x, instance.z.x);
    let along = vec3f(instance.x.y, instance.y.y, instance.z.y);
    let upward = vec3f(instance.x.z, instance.y.z, instance.z.z);
    let tilted = across * (corner.normal.x / max(dot(across, across), 1e-30))
        + along * (corner.normal.y / max(dot(along, along), 1e-30))
        + upward * (corner.normal.z / max(dot(upward, upward), 1e-30));
    let normal = tilted * inverseSqrt(max(dot(tilted, tilted), 1e-30));
    let rgba = vec4f(instance.rgba.rgb * view.eye.w, instance.rgba.a);
//#end
//#if VERTEX_LIGHT
    let point = Point(world, normal, normalize(view.eye.xyz - world), rgba.rgb, instance.material.xyz);
    out.base = vec4f(unshadowed(point), rgba.a);
//#vertex_light
//#end
//#if PIXEL_LIGHT
    out.world = world;
    out.normal = normal;
    out.rgba = rgba;
    out.material = instance.material.xyz;
//#end
//#if FLAT
    out.rgba = instance.rgba;
//#end
//#if TEXTURED
    // For flat pictures as for those in all directions: what a driver makes of this for the one serves the other.
    let spread = corner.position * instance.texgen.xyz + vec3f(0.0, 0.0, instance.texgen.w);
    out.texcoord = select(spread, vec3f(corner.texcoord + 0.5, 0.0), instance.texgen.w < -3e38);
//#end
//#if FOG
    out.depth = dot(view.depth, vec4f(world, 1.0));
//#end
//#if CLIP
    out.side = dot(view.plane, vec4f(world, 1.0));
//#end
//#vertex_shadow
//#end
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
    // Before anything else, while all pixels do the same.
//#if TEXTURE_FLAT
    let texel = textureSample(image, image_sampler, in.texcoord.xy - 0.5).rgb;
//#end
//#if TEXTURE_CUBE
    let texel = textureSample(image, image_sampler, in.texcoord).rgb;
//#end
//#if CLIP
    if in.side < 0.0 {
        discard;
    }
//#end
//#if PIXEL_LIGHT
    let normal = in.normal * inverseSqrt(max(dot(in.normal, in.normal), 1e-30));
    let point = Point(in.world, normal, normalize(view.eye.xyz - in.world), in.rgba.rgb, in.material);
    var color = unshadowed(point);
    let alpha = in.rgba.a;
//#end
//#if VERTEX_LIGHT
    var color = in.base.rgb;
    let alpha = in.base.a;
//#end
//#if FLAT
    var color = in.rgba.rgb;
    let alpha = in.rgba.a;
//#end
//#fragment_shadow
//#if TEXTURED
    color *= texel;
//#end
//#if FOG
    color = fogged(color, in.depth);
//#end
    return vec4f(color, alpha);
}
//#end
