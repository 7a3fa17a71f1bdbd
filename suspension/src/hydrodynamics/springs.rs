//! Short-range forces that change while particles move.

/// Central forces between near particles, taken not as they are but as they will be after some time: a pair that opens at
/// the rate `w` then pushes with a force that is less by `resistance w`, the force's decay with distance times that
/// time. So it resists to motions like lubrication, and however stiff it is, no motion overshoots.
pub struct Springs<'a> {
    /// Resistance, force over velocity, of two particles of some radii by the distance of their centres.
    pub resistance: &'a (dyn Fn(f64, [f64; 2]) -> f64 + Sync),
}
