//! Single edits, with values of `mj_recompile` and of models by hand.
