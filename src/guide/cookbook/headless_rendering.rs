//! Headless rendering: images without a window or a display.
//!
#![doc = include_str!("../../render/picture.html")]
//!
//! With the feature `renderer`, a server or a container draws images. It needs a graphics driver,
//! for example the one in software: `apt-get install libvulkan1 mesa-vulkan-drivers`.
//!
#![cfg_attr(feature = "renderer", doc = "```no_run")]
#![cfg_attr(not(feature = "renderer"), doc = "```ignore")]
//! use mujoco_safe::render::Renderer;
//! use mujoco_safe::scene::Camera;
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! data.reset_to_key("squat")?;
//! data.forward()?; // the poses
//! let mut renderer = Renderer::new(data.model(), 640, 480)?; // width, height
//! renderer.snapshot(&mut data, "side")?.rgb()?.save_png("side.png")?; // the model's camera
//! let mut camera = Camera { azimuth: 120.0, ..Camera::free(data.model()) };
//! let image = renderer.snapshot(&mut data, &mut camera)?.rgb()?;
//! println!("{:?}", image.pixel(320, 240)); // red, green, blue
//! # Ok::<(), mujoco_safe::render::RenderError>(())
//! ```
//!
//! [`pictures`](crate::guide::pictures) continues with depth, segmentation, cameras and the
//! contents of a scene.
