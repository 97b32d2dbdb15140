//! Custom numeric and text fields of a model.
//!
//! ```
//! use mujoco_safe::Model;
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <custom>
//!            <numeric name="gains" data="10 2.5"/><text name="author" data="me"/>
//!          </custom>
//!        </mujoco>"#,
//! )?;
//! assert_eq!(model.numeric("gains")?.data(), [10.0, 2.5]);
//! assert_eq!(model.text("author")?.data(), "me");
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
