// Surface of a geom, with all lights in one pass.

struct Varyings {
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
//#if UNLIT
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
//#if QUAD_EDGES
    // Parity of the vertices: -1 or 1 everywhere on a diagonal, and only at the ends of an edge.
    @location(14) parity: f32,
//#end
//#varyings
//#end
}

//#if TEXTURE_2D
@group(1) @binding(0) var color_texture: texture_2d<f32>;
@group(1) @binding(1) var color_sampler: sampler;
//#end
//#if TEXTURE_CUBE
@group(1) @binding(0) var color_texture: texture_cube<f32>;
@group(1) @binding(1) var color_sampler: sampler;
//#end

@vertex
fn vs_main(vertex: Vertex, instance: Instance) -> Varyings {
    var out: Varyings;
    let world = to_world(instance, vertex.position);
    out.position = view.clip * vec4f(world, 1.0);
//#if IDS
    out.id = instance.id;
    out.depth = dot(view.depth, vec4f(world, 1.0));
//#end
//#if COLOR
//#if LIT
    // Normal matrix, the inverse transpose: the columns of the matrix, each divided by its squared
    // length. The columns are orthogonal.
    let local = vertex.normal * instance.normal_scale;
    let scaled = vec3f(dot(instance.x.xyz, local), dot(instance.y.xyz, local), dot(instance.z.xyz, local));
    let normal = direction(scaled);
    let rgba = vec4f(instance.rgba.rgb * view.camera.w, instance.rgba.a);
//#end
//#if VERTEX_LIGHT
    let point = SurfacePoint(world, normal, direction(view.camera.xyz - world), rgba.rgb, instance.material);
    out.base = vec4f(unshadowed_light(point), rgba.a);
//#vertex_light
//#end
//#if PIXEL_LIGHT
    out.world = world;
    out.normal = normal;
    out.rgba = rgba;
    out.material = instance.material;
//#end
//#if UNLIT
    out.rgba = instance.rgba;
//#end
//#if TEXTURED
    // 2D and cube textures share this code, so that drivers can reuse the compiled shader.
    let source = select(vertex.position, vec3f(vertex.texcoord, 0.0), instance.texgen.w > 0.5);
    out.texcoord = source * instance.texgen.xyz + instance.texture_offset;
//#end
//#if FOG
    out.depth = dot(view.depth, vec4f(world, 1.0));
//#end
//#if CLIP
    out.side = dot(view.plane, vec4f(world, 1.0));
//#end
//#if QUAD_EDGES
    out.parity = vertex.parity;
//#end
//#vertex_shadow
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
    // Textures are sampled first, in uniform control flow.
//#if TEXTURE_2D
    let texel = textureSample(color_texture, color_sampler, in.texcoord.xy);
//#end
//#if TEXTURE_CUBE
    let texel = textureSample(color_texture, color_sampler, in.texcoord);
//#end
//#if CLIP
    if in.side < 0.0 {
        discard;
    }
//#end
//#if QUAD_EDGES
    // Beyond the end of an edge the interpolation gives a larger parity.
    if abs(abs(in.parity) - 1.0) < 1e-4 {
        discard;
    }
//#end
//#if PIXEL_LIGHT
    let normal = direction(in.normal);
    let point = SurfacePoint(in.world, normal, direction(view.camera.xyz - in.world), in.rgba.rgb, in.material);
    var color = unshadowed_light(point);
    let alpha = in.rgba.a;
//#end
//#if VERTEX_LIGHT
    var color = in.base.rgb;
    let alpha = in.base.a;
//#end
//#if UNLIT
    var color = in.rgba.rgb;
    let alpha = in.rgba.a;
//#end
//#fragment_shadow
//#if TEXTURED
    color *= texel.rgb;
//#end
//#if FOG
    color = apply_fog(color, in.depth);
//#end
//#if BLENDED
//#if TEXTURE_2D
    return vec4f(color, alpha * texel.a);
//#end
//#if NO_TEXTURE_2D
    return vec4f(color, alpha);
//#end
//#end
//#if OPAQUE
    // Nothing reads the opacity, and its interpolation takes time.
    return vec4f(color, 1.0);
//#end
}
//#end
