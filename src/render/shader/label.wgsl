// Text: rectangles that show glyphs of the atlas.

@group(1) @binding(0) var atlas: texture_2d<f32>;
@group(1) @binding(1) var atlas_sampler: sampler;

struct Varyings {
    @builtin(position) position: vec4f,
    @location(0) texel: vec2f,
    @location(1) @interpolate(flat) rgba: vec4f,
    @location(2) @interpolate(flat) channel: vec2f,
}

@vertex
fn vs_main(
    @builtin(vertex_index) index: u32,
    @location(0) rect: vec4f,
    @location(1) texels: vec4f,
    @location(2) rgba: vec4f,
    @location(3) channel: vec2f,
) -> Varyings {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u));
    let pixel = mix(rect.xy, rect.zw, corner);
    var out: Varyings;
    out.position = vec4f(2.0 * pixel.x / view.pixels.x - 1.0, 1.0 - 2.0 * pixel.y / view.pixels.y, 0.0, 1.0);
    out.texel = mix(texels.xy, texels.zw, corner);
    out.rgba = rgba;
    out.channel = channel;
    return out;
}

@fragment
fn fs_main(in: Varyings) -> @location(0) vec4f {
    let coverage = dot(textureSample(atlas, atlas_sampler, in.texel / vec2f(textureDimensions(atlas))).rg, in.channel);
    return vec4f(in.rgba.rgb, in.rgba.a * coverage);
}
