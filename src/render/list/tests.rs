//! Lists of scenes.
