//! Messages of work that takes long.

/// Receives messages of a scene that is carried out.
pub trait Listener: Sync {
    /// Called with a message for the user.
    fn line(&self, text: &str);
}
