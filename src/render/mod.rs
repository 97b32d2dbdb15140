//! Pictures of a [`Scene`](crate::scene::Scene), drawn by wgpu: no window, no display, no OpenGL context.
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
//! scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all())?;
//!
//! let mut renderer = Renderer::new(data.model(), 640, 480)?;
//! renderer.rgb(&scene)?.save_png("colours.png")?;
//! let metres = renderer.depth(&scene)?.metres(320, 240);
//! let seen = renderer.segmentation(&scene)?.pixel(320, 240).map(|segment| segment.object);
//! println!("in the middle, {metres} m away: {seen:?}");
//! # Ok::<(), mujoco_safe::render::RenderError>(())
//! ```
//!
//! # How a picture is made
//!
//! 1. The geoms of the scene become shapes in places, a capsule for one the side of a cylinder and two halves of a sphere. What is the
//!    same shape with the same texture is drawn at once. What is out of sight, what a mirror does not show and what casts no shadow is
//!    found out by spheres around the geoms.
//! 2. For each light that casts shadows everything whose shadow may be seen is drawn to its shadow map, backs only, so that nothing is in
//!    its own shadow. Of a map only the part is kept that something is drawn to.
//! 3. In one pass, in this order: the mirror images of everything, if a plane or a box reflects; that plane or box, added to them; what
//!    is solid; the sky and the haze at the horizon, unless the floor hides them; what is transparent, from front to back and from back
//!    to front; labels.
//! 4. The samples of each pixel are mixed, and the picture is copied to memory that programs can read.
//!
//! Depths and numbers of geoms are pictures of their own, with one sample for each pixel. Round shapes have as many corners there as the
//! precision of the depth needs, whatever the model asks for.
//!
//! # What differs from the engine's own renderer
//!
//! Pictures are the same but for roundings and for the samples at edges. On purpose it is otherwise here:
//!
//! - All lights are computed in one pass, each in as many operations as its kind needs: the engine draws everything once more for each
//!   light that casts shadows. The programs are written while the program runs, for the lights that there are.
//! - Up to 100 lights shine, and up to 8 of them cast shadows. In OpenGL there are 8 in all.
//! - Round shapes of a few pixels have fewer corners.
//! - A pixel has as many samples as the adapter can give it, and not more than the model asks for.
//! - Depth is in metres, and infinite where nothing is; the engine gives a number from 0 to 1 that depends on the frustum.
//! - A geom with a number that nothing can be drawn with, an infinite position for one, is left out.
//! - Both eyes of a stereo camera are averaged, as the engine does unless a window for two eyes is asked for.
//! - In a wire frame the rectangles of planes and boxes have diagonals.
//!
//! # Drivers
//!
//! Vulkan, Metal or Direct3D 12 draws; OpenGL is used only if none of them finds an adapter. Lines that a driver prints to standard
//! error while it is opened are logged at level `debug` (with glibc).
//!
//! | file | what is in it |
//! |---|---|
//! | `gpu/` | the graphics adapter |
//! | `renderer/`, `options.rs` | [`Renderer`], [`RendererOptions`] |
//! | `picture/` | [`Picture`], [`DepthPicture`], [`SegmentationPicture`]: arrays of pixels, and files of them |
//! | `frame/` | from where a picture is drawn, and in which light |
//! | `list/` | what is drawn: the geoms of a scene as shapes in places, in order |
//! | `pass/` | how it is drawn: shadows, mirror images, sky, transparent things, numbers |
//! | `shader/` | the programs of the graphics card |
//! | `content/` | what of the model the graphics card keeps |
//! | `bound.rs` | how far geoms reach |
//! | `shape/` | vertices of the basic shapes, and of the model's meshes, hulls, height fields and skins |
//! | `text/` | letters, and where they are in a text |
//! | `texture/` | the images of the model's textures, in all sizes |

#![forbid(unsafe_code)]

mod bound;
mod content;
mod error;
mod frame;
mod gpu;
mod list;
mod options;
mod pass;
mod picture;
mod read_back;
mod renderer;
mod settings;
mod shader;
mod shape;
mod text;
mod texture;

pub use self::error::RenderError;
pub use self::gpu::{Gpu, GpuKind, GpuOptions, GpuPreference, own_device};
pub use self::options::{Lighting, RendererOptions};
pub use self::picture::{DepthPicture, Picture, Segment, SegmentationPicture};
pub use self::renderer::Renderer;

#[cfg(test)]
mod leak_tests;
