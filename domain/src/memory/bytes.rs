//! Forecasts of memory, in bytes.

/// Memory that a computation is forecast to keep, and its peak, which includes the memory kept. Forecasts may exceed
/// any real memory.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Bytes {
    /// Bytes still allocated at the end.
    pub kept: f64,
    /// Bytes allocated at the peak.
    pub most: f64,
}

/// Approximate peak of a list that grows by `push`, over its final size: it is copied whenever it is enlarged.
pub const GROWING: f64 = 1.5;

impl Bytes {
    /// Memory that is allocated and kept.
    pub fn keep(bytes: f64) -> Self {
        Self { kept: bytes, most: bytes }
    }

    /// Memory that is allocated and freed again.
    pub fn temporary(bytes: f64) -> Self {
        Self { kept: 0.0, most: bytes }
    }

    /// A list of `count` values that is kept.
    pub fn list<T>(count: f64) -> Self {
        Self::keep(count * size_of::<T>() as f64)
    }

    /// This computation followed by another, with the memory that the first keeps still allocated.
    #[must_use]
    pub fn then(self, next: Self) -> Self {
        Self { kept: self.kept + next.kept, most: self.most.max(self.kept + next.most) }
    }

    /// One of two computations: the larger values of both.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self { kept: self.kept.max(other.kept), most: self.most.max(other.most) }
    }

    /// The same computation if nothing of it is kept.
    #[must_use]
    pub fn freed(self) -> Self {
        Self::temporary(self.most)
    }
}

/// A number of bytes as readable text: `512 kB`, `1.25 GB`.
pub fn readable_bytes(bytes: f64) -> String {
    let units = ["B", "kB", "MB", "GB", "TB", "PB"];
    let mut value = bytes;
    for unit in units {
        if value < 999.5 {
            let digits = if unit == "B" || value >= 99.95 { 0 } else { 1 + usize::from(value < 9.995) };
            return format!("{value:.digits$} {unit}");
        }
        value /= 1e3;
    }
    format!("{:.1e} PB", 1e3 * value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_after_stands_on_what_was_kept() {
        let first = Bytes { kept: 2.0, most: 10.0 };
        assert_eq!(first.then(Bytes::temporary(3.0)), Bytes { kept: 2.0, most: 10.0 });
        assert_eq!(first.then(Bytes { kept: 1.0, most: 9.0 }), Bytes { kept: 3.0, most: 11.0 });
        assert_eq!(first.freed().then(Bytes::list::<u64>(2.0)), Bytes { kept: 16.0, most: 16.0 });
        assert_eq!(first.or(Bytes { kept: 5.0, most: 6.0 }), Bytes { kept: 5.0, most: 10.0 });
    }

    #[test]
    fn bytes_are_readable() {
        let pairs = [(0.0, "0 B"), (999.0, "999 B"), (1500.0, "1.50 kB"), (12.44e6, "12.4 MB"), (999.6e6, "1.00 GB")];
        for (bytes, text) in pairs {
            assert_eq!(readable_bytes(bytes), text);
        }
        assert_eq!(readable_bytes(7e18), "7.0e3 PB");
    }
}
