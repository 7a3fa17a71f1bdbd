//! Messages and progress of long computations.

/// Receives messages and progress while a scene is computed, and can stop the computation.
pub trait Listener: Sync {
    /// Called with a message for the user.
    fn line(&self, text: &str);

    /// Called now and then with the completed fraction of the work.
    fn part(&self, _part: f64) {}

    /// Called when a result has been stored and need not be computed again.
    fn stored(&self) {}

    /// Whether to continue. Called often; the work stops when it first returns false.
    fn goes_on(&self) -> bool {
        true
    }
}
