// Depth of surfaces only, for shadow maps and for the stencil mark of the mirror.

@vertex
fn vs_main(vertex: Vertex, instance: Instance) -> @builtin(position) vec4f {
    return view.clip * vec4f(to_world(instance, vertex.position), 1.0);
}
//#if COLOR

@fragment
fn fs_main() -> @location(0) vec4f {
    return vec4f(0.0);
}
//#end
