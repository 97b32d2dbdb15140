//! A skin against a mesh of the same shape.
#![forbid(unsafe_code)]

use std::f64::consts::{PI, TAU};

use mujoco_safe::render::RendererOptions;
use mujoco_safe::scene::RenderFlags;

use crate::difference::Difference;
use crate::stage::Stage;

const SIZE: [usize; 2] = [160, 120];
const PIXELS: f64 = 160.0 * 120.0;
/// Vertices on each circle of latitude.
const SLICES: usize = 24;
/// Circles of latitude between the poles.
const CIRCLES: usize = 15;

/// Returns the attributes `vertex` and `face` of an ellipsoid, whose longest axis is x.
fn ellipsoid() -> String {
    let (south, north) = (SLICES * CIRCLES, SLICES * CIRCLES + 1);
    let on_sphere = (0..CIRCLES).flat_map(|circle| {
        let latitude = PI * ((circle + 1) as f64 / (CIRCLES + 1) as f64 - 0.5);
        (0..SLICES).map(move |slice| {
            let (sin, cos) = (TAU * slice as f64 / SLICES as f64).sin_cos();
            [latitude.cos() * cos, latitude.cos() * sin, latitude.sin()]
        })
    });
    let vertices = on_sphere.chain([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]);
    let at = |circle: usize, slice: usize| circle * SLICES + slice % SLICES;
    let faces = (0..SLICES).flat_map(|slice| {
        let cells = (1..CIRCLES).flat_map(move |circle| {
            let [a, b] = [at(circle - 1, slice), at(circle - 1, slice + 1)];
            let [c, d] = [at(circle, slice), at(circle, slice + 1)];
            [[a, b, c], [b, d, c]]
        });
        cells.chain([
            [south, at(0, slice + 1), at(0, slice)],
            [north, at(CIRCLES - 1, slice), at(CIRCLES - 1, slice + 1)],
        ])
    });
    let vertices: Vec<String> =
        vertices.map(|[x, y, z]| format!("{:.5} {:.5} {:.5}", 0.5 * x, 0.3 * y, 0.3 * z)).collect();
    let faces: Vec<String> = faces.map(|[a, b, c]| format!("{a} {b} {c}")).collect();
    format!("vertex='{}' face='{}'", vertices.join(" "), faces.join(" "))
}

/// Returns a stage with a body over a mirror, and with its shadow.
fn stage(asset: &str, geom: &str) -> Stage {
    let xml = format!(
        "<mujoco>
           <statistic extent='2' center='0 0 .5'/>
           <asset>{asset}<material name='glossy' reflectance='.5' rgba='.3 .3 .3 1'/></asset>
           <worldbody>
             <light pos='1 -1 3' dir='-.3 .3 -1'/>
             <geom type='plane' size='2 2 .1' material='glossy'/>
             <body name='body' pos='.1 0 .6' euler='20 30 40'><freejoint/>{geom}</body>
           </worldbody></mujoco>"
    );
    Stage::with(&xml, SIZE, RendererOptions::default())
}

#[test]
fn a_skin_its_mirror_image_and_its_shadow_look_like_those_of_a_mesh() {
    let shape = ellipsoid();
    let mut mesh =
        stage(&format!("<mesh name='shape' {shape}/>"), "<geom type='mesh' mesh='shape' rgba='.8 .5 .2 1'/>");
    let vertices = SLICES * CIRCLES + 2;
    let [ids, weights] =
        [|id: usize| format!("{id} "), |_| "1 ".to_owned()].map(|text| (0..vertices).map(text).collect::<String>());
    let bone = format!("<bone body='body' bindpos='0 0 0' bindquat='1 0 0 0' vertid='{ids}' vertweight='{weights}'/>");
    let mut skin =
        stage(&format!("<skin name='skin' rgba='.8 .5 .2 1' {shape}>{bone}</skin>"), "<geom size='.1' group='4'/>");
    let mut covered = 0;
    // Height of the look-at point, distance, azimuth and elevation. In the last view the camera is
    // above the ellipsoid, half of which is behind it.
    let views = [
        (0.4, 3.0, 0.0, -20.0),
        (0.4, 3.0, 70.0, -60.0),
        (0.4, 3.0, 140.0, -5.0),
        (0.4, 2.0, 220.0, -35.0),
        (0.4, 2.0, 300.0, -10.0),
        (1.0, 0.1, 0.0, -30.0),
    ];
    for (height, distance, azimuth, elevation) in views {
        // Without culling, the bodies cast shadows on themselves, with a pattern that depends on
        // rounding.
        for flags in [RenderFlags::SHADOW | RenderFlags::CULL_FACE, RenderFlags::empty()] {
            let images = [&mut mesh, &mut skin].map(|stage| {
                stage.look([0.1, 0.0, height], distance, azimuth, elevation);
                stage.scene.set_render_flags(RenderFlags::REFLECTION | flags);
                let depth = stage.renderer.depth(&stage.scene).unwrap();
                (stage.rgb(), depth)
            });
            let [(of_mesh, mesh_depth), (of_skin, skin_depth)] = &images;
            // Rounding moves single pixels at edges, and where the light grazes a body whose front
            // faces cast shadows, too.
            let limit = if cfg!(engine_since = "3.3.0") && flags.contains(RenderFlags::SHADOW) { 30.0 } else { 5.0 };
            let different = (Difference::of(of_mesh, of_skin).outliers * PIXELS).round();
            let depths = mesh_depth.as_slice().iter().zip(skin_depth.as_slice());
            let far = depths.filter(|(mesh, skin)| (*mesh - *skin).abs() > 1e-3).count();
            assert!(different < limit && far < 5, "azimuth {azimuth}, {flags:?}: {different} colours, {far} depths");
            covered += of_skin.as_bytes().as_chunks::<3>().0.iter().filter(|[red, _, blue]| red / 2 > *blue).count();
        }
    }
    assert!(covered > 5000, "the ellipsoid covers {covered} pixels");
}
