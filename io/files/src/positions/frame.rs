//! Selection of a frame of a file.

/// Number of a frame out of `count`, from 0: the last one by default; negative numbers count from the end.
pub(super) fn pick(asked: Option<i64>, count: usize) -> Result<usize, String> {
    if count == 0 {
        return Err("it has no frame".to_owned());
    }
    let asked = asked.unwrap_or(-1);
    let from_start = if asked < 0 { asked.saturating_add(count as i64) } else { asked };
    let found = usize::try_from(from_start).ok().filter(|&number| number < count);
    found.ok_or_else(|| match count {
        1 => format!("particles.frame is {asked}, but it has one frame; leave that key out"),
        _ => format!(
            "particles.frame is {asked}, but it has {count} frames: 0 to {}, or from the end -1 to -{count}",
            count - 1
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_count_from_the_start_or_from_the_end() {
        assert_eq!([None, Some(0), Some(2), Some(-1), Some(-3)].map(|asked| pick(asked, 3)), [2, 0, 2, 2, 0].map(Ok));
        for asked in [3, -4, i64::MAX, i64::MIN] {
            assert!(pick(Some(asked), 3).unwrap_err().contains("has 3 frames: 0 to 2"));
        }
        assert!(pick(Some(1), 1).unwrap_err().contains("has one frame"));
        assert!(pick(None, 0).is_err());
    }
}
