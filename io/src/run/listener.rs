//! Messages and progress of work that takes long.

/// Receives messages and progress of a scene that is carried out, and can stop it.
pub trait Listener: Sync {
    /// Called with a message for the user.
    fn line(&self, text: &str);

    /// Called now and then with the part of the work that is done.
    fn part(&self, _part: f64) {}

    /// Called when a result is stored that need not be computed again.
    fn stored(&self) {}

    /// Whether to continue. It is called often; the work stops when it first returns false.
    fn goes_on(&self) -> bool {
        true
    }
}
