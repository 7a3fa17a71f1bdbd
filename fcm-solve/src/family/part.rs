//! Parts of a family, for job arrays.

use scene::Member;
use std::fmt::{Display, Formatter};
use std::str::FromStr;

/// Part `number` of `count` parts, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    number: usize,
    count: usize,
}

impl Part {
    /// The whole family as one part.
    pub const WHOLE: Self = Self { number: 1, count: 1 };

    /// Members of this part; members are dealt out to the parts in turn.
    pub fn of(self, members: &[Member]) -> Vec<&Member> {
        members.iter().skip(self.number - 1).step_by(self.count).collect()
    }

    /// Text behind the number of runs of a part; empty for the whole family.
    pub fn described(self, all: usize) -> String {
        if self == Self::WHOLE { String::new() } else { format!(" of {all} (part {self})") }
    }
}

impl Display for Part {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit()).then(|| text.parse().ok())?;
        let numbers =
            text.split_once('/').and_then(|(number_text, count)| Some((number(number_text)?, number(count)?)));
        match numbers {
            Some((number, count)) if (1..=count).contains(&number) => Ok(Self { number, count }),
            _ => Err("write it as K/N with 1 <= K <= N: 2/8 is the second of eight parts".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::SceneFile;

    #[test]
    fn parts_are_read_and_those_that_are_none_are_refused() {
        assert_eq!("2/8".parse(), Ok(Part { number: 2, count: 8 }));
        assert_eq!("1/1".parse(), Ok(Part::WHOLE));
        for text in ["", "2", "0/4", "5/4", "-1/4", "1/0", "a/b", "1/2/3", "+1/2", "1.0/2", "1/99999999999999999999999"]
        {
            assert!(text.parse::<Part>().is_err(), "{text}");
        }
    }

    #[test]
    fn every_member_is_in_one_part() {
        let text = include_str!("../../../scenes/settling.toml").to_owned() + "[ensemble]\nseeds = 7\n";
        let Ok(SceneFile::Family(family)) = SceneFile::parse(&text, "f.toml", &[]) else { panic!("a family") };
        let part = |number| Part { number, count: 3 }.of(family.members());
        assert_eq!([1, 2, 3].map(|number| part(number).len()), [3, 2, 2]);
        let mut all: Vec<_> = [1, 2, 3].into_iter().flat_map(part).map(scene::Member::folder).collect();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), 7);
    }
}
