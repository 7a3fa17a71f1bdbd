//! A failure that is known to all ranks.

/// An error of one rank, as all ranks return it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// Lowest rank that failed.
    pub rank: usize,
    /// Number of ranks.
    pub ranks: usize,
    /// That rank's message.
    pub message: String,
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.ranks > 1 && self.rank > 0 {
            write!(f, "{} (on rank {} of {})", self.message, self.rank, self.ranks)
        } else {
            f.write_str(&self.message)
        }
    }
}

impl std::error::Error for Failure {}
