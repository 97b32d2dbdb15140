// Only the place of a shape: for shadow maps, and to mark where a mirror is.

@vertex
fn vertex(corner: Corner, instance: Instance) -> @builtin(position) vec4f {
    return view.clip * vec4f(placed(instance, corner.position), 1.0);
}
//#if COLOR

@fragment
fn fragment() -> @location(0) vec4f {
    return vec4f(0.0);
}
//#end
