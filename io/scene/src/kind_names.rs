//! Names of the kinds of scenes.

/// Names of the kinds.
pub(crate) const KINDS: [&str; 4] = ["suspension", "granular-disks", "shear-cell", "shear-cell-continuum"];
