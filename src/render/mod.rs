//! Off-screen rendering of simulations with wgpu: no window, no display, no OpenGL context.
//!
#![doc = include_str!("picture.html")]
//!
//! *Colours, depth and segments from the camera of a rover: example `camera_sensor`.*
//!
//! ```no_run
//! use mujoco_safe::render::Renderer;
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! data.forward()?;
//! let mut renderer = Renderer::new(data.model(), 640, 480)?;
//! // The camera is a name, an id, or &mut Camera::free(data.model()).
//! let mut snapshot = renderer.snapshot(&mut data, "side")?;
//!
//! // Together these cost less than rgb(), depth() and segmentation() do.
//! let images = snapshot.images()?;
//! images.rgb.save_png("colours.png")?;
//! let seen = images.segmentation.pixel(320, 240).map(|segment| segment.object);
//! println!("centre pixel: {} m, {seen:?}", images.depth.metres(320, 240));
//! let camera = snapshot.pinhole_camera()?;
//! let cloud: Vec<[f64; 3]> = images.depth.points(&camera).map(|(_, point)| point).collect();
//! println!("{} points in the world frame", cloud.len());
//! # Ok::<(), mujoco_safe::render::RenderError>(())
//! ```
//!
//! A program that adds geoms, applies perturbations or restricts categories updates a
//! [`Scene`](crate::scene::Scene) itself, and draws it:
//!
//! ```no_run
//! use mujoco_safe::render::Renderer;
//! use mujoco_safe::scene::{Camera, Categories, Scene, SceneOptions};
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! data.forward()?;
//! let mut scene = Scene::new(data.model(), 1000)?;
//! let mut camera = Camera::free(data.model());
//! scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::DYNAMIC)?;
//! let mut renderer = Renderer::new(data.model(), 640, 480)?;
//! renderer.rgb(&scene)?.save_png("dynamic.png")?;
//! # Ok::<(), mujoco_safe::render::RenderError>(())
//! ```
//!
//! # Stages of a frame
//!
//! 1. The draw list converts the geoms of the scene to instances of unit shapes: a capsule is the
//!    side of a cylinder and two hemispheres. Instances with the same shape and the same texture
//!    form a batch, which is one draw call. Bounding spheres cull geoms that are outside of the
//!    view frustum, invisible in the mirror, or without a visible shadow.
//! 2. The shadow pass renders every caster of a visible shadow to the shadow map of each
//!    shadow-casting light. Front faces are culled to avoid self-shadowing. Only the region of a
//!    shadow map that contains casters is allocated.
//! 3. The main render pass draws, in this order: the mirror images of all geoms, if a plane or box
//!    is reflective; that reflector, blended additively over them; opaque geoms; the skybox and the
//!    haze at the horizon, unless the floor hides them; transparent geoms, front to back and then
//!    back to front; labels.
//! 4. MSAA is resolved, and the frame is copied to a staging buffer and read back.
//!
//! Depth and segmentation images have a separate pass without multisampling. In this pass the
//! tessellation of round shapes follows from the required depth precision instead of the model's
//! quality settings.
//!
//! # Differences from the engine's renderer
//!
//! Images are equal to the engine's up to rounding and the positions of MSAA samples at edges,
//! except for these deliberate differences:
//!
//! - A single pass computes all lights, and shaders are specialised at run time for the lights of
//!   the scene. The engine draws everything once more for each shadow-casting light.
//! - Up to 100 lights are active, and up to 8 of them cast shadows. OpenGL is limited to 8 lights,
//!   which [`max_lights`](RendererOptions::max_lights) imitates.
//! - Labels have another font, DejaVu Sans with a dark border, and fonts of the system for letters
//!   that it lacks; characters without a font are boxes. Letters that depend on their neighbours,
//!   as in Arabic, are drawn one by one from left to right. The engine draws each byte of a label
//!   as a character of its own font, also the bytes of letters beyond ASCII. In images of 320 × 240
//!   pixels with a dozen labels, 1 to 5 % of the pixels differ.
//! - Round shapes that cover few pixels have fewer vertices. So have meshes without texture
//!   coordinates: vertices that are less than a pixel apart are merged, except in wireframes, depth
//!   and segmentation images. In images of an arm of 215,000 small triangles at most 0.3 % of the
//!   pixels differ by more than 8 of 255 (bench `render`, argument `pictures`). In an image of
//!   2,357 spheres of 2 to 5 pixels they are 2.1 %.
//! - The powers in the lighting equation are within 0.1 %.
//! - Tiles of a large plane far from the lights and the camera have fewer triangles. The diffuse
//!   light of each source changes by at most one of 255 levels, and so does its highlight.
//! - A shadow map is rendered with half, a quarter, … of its width and height while a texel on the
//!   nearest visible surface is at most a quarter of a pixel wide. Small images thus take less
//!   time, and the edges of their shadows move by at most an eighth of a pixel on surfaces that
//!   face the light. On faces turned away from a light with ambient light, lit and shadowed pixels
//!   alternate as in the engine's images, but not the same pixels.
//! - A plane that hides everything behind it from a perspective camera casts no shadow from a light
//!   in front of it. In the engine's images a lit floor that is oblique to both axes of the map of
//!   a directional light has shadows of itself near the edges of the map. A floor that is not in
//!   the map, or is in a reduced map, does not have them: up to 2.8 % of the pixels.
//! - Mesa's llvmpipe, with which the engine draws on machines without a graphics card, computes the
//!   depth of a line half a pixel aside if there are several samples per pixel. A line along an
//!   edge of a solid is then hidden in part in the engine's images: up to 0.7 % of the pixels.
//! - With engines before 3.0.1 the depth buffer is more precise than the engine's: surfaces far
//!   away that almost coincide do not flicker.
//! - The sample count is the largest supported count that does not exceed the model's.
//! - Depth is in metres, and infinite for the background. The engine returns a value from 0 to 1
//!   that depends on the frustum.
//! - A geom with a value that cannot be rendered, such as an infinite position, is skipped.
//! - OpenGL rejects a shininess outside of 0 to 1, and the engine draws the geom with the shininess
//!   of the geom before it. Here the shininess is clamped.
//! - OpenGL rejects a spot exponent outside of 0 to 128 and negative attenuation. Here they have
//!   their initial values, as in the first image of the engine. In later images of the engine they
//!   have the values of the light that was drawn before with the same number.
//! - If all coefficients of attenuation are zero, OpenGL divides by zero. Here the light is as
//!   bright as possible.
//! - Round shapes have at least 3 slices and 2 stacks, and boxes and planes at least one quad
//!   (`numslices`, `numstacks`, `numquads`).
//! - The two eyes of a stereo camera are averaged, as in the engine without a stereo window.
//! - In wireframe mode the lines are the same as in the engine, and are one pixel wide on every
//!   adapter. Without shadows at most 0.2 % of the pixels differ by more than 8 of 255 (bench
//!   `render`, argument `pictures`). A light that casts shadows is brighter in the engine's images,
//!   which add it once for each of the polygons that share an edge: 4 to 9 % of the pixels differ
//!   in most scenes, and more if lines fill the image (23 % in the scene `skin` of the bench, 37 %
//!   in `terrain`). Diagonals are visible in round shapes with an odd number of slices.
//!
//! # Engine versions
//!
//! Images equal the images of the linked engine's renderer. With engines from 3.0, a camera has its
//! own width of the image (`focal`, `sensorsize`); from 3.0.1, decoration casts no shadows; from
//! 3.2, cameras can be orthographic, and a headlight remains where the last update of the scene has
//! put it; from 3.3, all faces cast shadows; from 3.3.3, textures in the sRGB colour space are
//! converted to linear colours; from 3.12, 2D textures follow the surface of spheres, boxes,
//! cylinders and capsules instead of a projection along z, and repeat on meshes, skins and flexes,
//! too; from 3.17, textures can be in files that the model refers to; from 4.0, geoms have
//! `castshadow`.
//!
//! Lines are not lit. If they are opaque, each light that casts shadows adds their colour once more
//! where it shines, as in the engine's images. Of opaque geoms with the same pose whose surfaces
//! coincide, the last one is visible, as in the engine's images; the engine then adds a light that
//! casts shadows once for each of them. With engines from 3.12, a skin without texture coordinates
//! has the colour in the corner of its 2D texture, and no cube texture; with shadows its colour in
//! the engine's images depends on what the engine drew before.
//!
//! As in the engine's OpenGL renderer, these have no effect, and a renderer that is created for a
//! model that uses them logs their names: point lights and image lights, `bulbradius`, `intensity`,
//! `range` and `softness` of lights, `metallic` and `roughness` of materials, and textures in other
//! roles than the base colour. (Engines from 3.5 and before 3.17 draw point and image lights, which
//! shine along the view.) Textures with one or two channels are white. A renderer also logs the
//! fields and constants of an engine that this crate does not know.
//!
//! In a comparison with the official bindings, at most 0.7 % of the pixels differed in 585 of 599
//! scenes with 320 × 240 pixels with 4.0.0, in 580 of 594 with 3.17.0, and in 575 of 589 with
//! 3.5.0, in colours, depths and segmentations. Of the others, scenes with labels (another font)
//! differ by up to 4.6 %; lines exactly on the near plane by 2.9 %; wireframes of a mirror, which
//! the engine adds once for each polygon that shares a line, by 7.9 %; 2,357 small spheres by 2.1
//! %; lit floors near the edges of shadow maps of directional lights, where the engine's have
//! shadows of themselves, by 2.8 %.
//!
//! # Drivers
//!
//! The backend is Vulkan, Metal or Direct3D 12; OpenGL is the fallback if none of them has an
//! adapter. Lines that a driver prints to standard error while the adapter is opened are logged at
//! level `debug` (with glibc).
//!
//! With a software rasteriser and glibc, opening the adapter makes `malloc` keep up to 64 MiB of
//! freed memory, which would otherwise be returned to the system and cleared again for every frame.
//! A program that sets `M_MMAP_THRESHOLD` or `M_TRIM_THRESHOLD` itself is not affected.

#![forbid(unsafe_code)]

mod assets;
mod bounding_volume;
mod draw_list;
mod error;
mod gpu;
mod image;
#[cfg(feature = "mcap")]
mod log;
mod pass;
mod renderer;
mod settings;
mod shader;
mod support;
mod view;

#[cfg(feature = "viewer")]
pub(crate) use self::assets::{FontFile, font_for};
pub use self::error::RenderError;
#[cfg(feature = "viewer")]
pub(crate) use self::gpu::DriverUse;
#[cfg(all(test, feature = "viewer"))]
pub(crate) use self::gpu::buffer::ReadBackBuffer;
pub use self::gpu::{Gpu, GpuKind, GpuOptions, GpuPreference, own_device};
pub use self::image::{DepthImage, RgbImage, Segment, SegmentationImage};
#[cfg(feature = "mcap")]
pub use self::log::LogImage;
#[cfg(feature = "viewer")]
pub(crate) use self::pass::{create_texture, screen_pipeline};
pub use self::renderer::{BatchCamera, Images, Snapshot};
pub use self::settings::{Lighting, RendererOptions};
use crate::macros::with_aliases;

with_aliases! {
    pub use self::renderer::{Renderer = "mjrContext" "GLContext"};
}
