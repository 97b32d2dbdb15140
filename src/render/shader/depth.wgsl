// Depth of surfaces only, for shadow maps and for the stencil mark of the mirror.

struct Varyings {
    @builtin(position) position: vec4f,
}

@vertex
fn vs_main(vertex: Vertex, instance: Instance) -> Varyings {
    var out: Varyings;
    out.position = view.clip * vec4f(to_world(instance, vertex.position), 1.0);
    return out;
}
//#if COLOR

@fragment
fn fs_main() -> @location(0) vec4f {
    return vec4f(0.0);
}
//#end
