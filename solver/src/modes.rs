//! Numbers for several modes at once.

/// Consecutive modes along x whose random numbers are drawn at once.
pub const MODES: usize = 16;

/// `C` complex numbers for each of some modes: real and imaginary parts.
pub type Complexes<const C: usize = 3> = [[[f64; MODES]; 2]; C];
