//! The second line of a frame in extended XYZ.

use super::columns;
use super::columns::{ColumnNumbers, Labels};
use crate::positions::FileBox;
use domain::Vector;
use scene::document::excerpt;

/// Keys and values of a line such as `Lattice="9 0 0 0 9 0 0 0 9" Properties=species:S:1:pos:R:3 Time=0.5`.
pub(super) struct XyzHeader(Vec<(String, String)>);

/// Columns of a frame, and the number of cells per line.
pub(super) struct Properties {
    pub(super) columns: ColumnNumbers,
    pub(super) width: usize,
}

impl XyzHeader {
    /// Parses a line. Keys are not case-sensitive. Words without a value are ignored.
    pub(super) fn of(line: &str) -> Result<Self, String> {
        let (mut keys, mut rest) = (Vec::new(), line.trim());
        while let Some(end) = rest.find(|c: char| c == '=' || c.is_whitespace()) {
            let (key, after) = rest.split_at(end);
            let after = after.trim_start();
            let Some(value) = after.strip_prefix('=') else {
                rest = after;
                continue;
            };
            let (value, after) = value_of(value.trim_start())?;
            keys.push((key.trim_matches('"').to_lowercase(), value.to_owned()));
            rest = after.trim_start();
        }
        Ok(Self(keys))
    }

    fn get(&self, key: &str) -> Option<&str> {
        self.0.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str())
    }

    /// Number under the first of these keys that the line has.
    pub(super) fn number<T: std::str::FromStr>(&self, keys: &[&str]) -> Option<T> {
        keys.iter().find_map(|key| self.get(key)?.parse().ok())
    }

    /// The columns; plain XYZ has a name and three coordinates.
    pub(super) fn properties(&self) -> Result<Properties, String> {
        let Some(list) = self.get("properties") else {
            let species = Some((0, Labels::Symbols));
            let columns =
                ColumnNumbers { position: [1, 2, 3], images: None, radius: None, species, id: None, orientation: None };
            return Ok(Properties { columns, width: 4 });
        };
        let wrong = || format!("its Properties {} are not name:type:columns", excerpt(list));
        let parts: Vec<&str> = list.split(':').collect();
        if !parts.len().is_multiple_of(3) {
            return Err(wrong());
        }
        let mut names = Vec::new();
        for property in parts.chunks_exact(3) {
            let width = property[2].parse::<u16>().ok().filter(|&width| width > 0).ok_or_else(wrong)?;
            names.extend(column_names(property[0], width)?);
        }
        let kind = parts.chunks_exact(3).find(|property| property[0].eq_ignore_ascii_case("species"));
        let labels = if kind.is_some_and(|property| property[1] == "S") { Labels::Names } else { Labels::Indices };
        let columns = columns::named(&names, ["pos 0", "pos 1", "pos 2"], labels);
        Ok(Properties {
            columns: columns.map_err(|_| "its Properties have no pos:R:3, or a property twice")?,
            width: names.len(),
        })
    }

    /// The box, if the frame has one.
    pub(super) fn cell(&self) -> Result<Option<FileBox>, String> {
        let Some(text) = self.get("lattice") else { return Ok(None) };
        let wrong =
            |key: &str, found: &str, needed: &str| format!("its {key} is {}; it needs {needed}", excerpt(found));
        let numbers = list(text).filter(|numbers| numbers.len() == 9);
        let numbers = numbers.ok_or_else(|| wrong("Lattice", text, "9 numbers, three for each edge"))?;
        let vectors = [0, 3, 6].map(|first| Vector::from_slice(&numbers[first..]));
        let origin = self.get("origin").or(self.get("cell_origin"));
        let origin = origin.map_or(Ok(Vector::ZERO), |text| {
            let numbers = list(text).filter(|numbers| numbers.len() == 3);
            numbers.map(|n| Vector::from_slice(&n)).ok_or_else(|| wrong("Origin", text, "3 numbers"))
        })?;
        let periodic = self
            .get("pbc")
            .map_or(Ok([true; 3]), |text| axes(text).ok_or_else(|| wrong("pbc", text, "T or F for each edge")))?;
        FileBox { origin, periodic, ..FileBox::lattice(vectors) }.checked().map(Some)
    }
}

/// A value, perhaps in quotes or brackets, and the rest of the line.
fn value_of(text: &str) -> Result<(&str, &str), String> {
    let close = match text.chars().next() {
        Some(quote @ ('"' | '\'')) => quote,
        Some('{') => '}',
        Some('[') => ']',
        _ => return Ok(text.split_at(text.find(char::is_whitespace).unwrap_or(text.len()))),
    };
    // Rows of a matrix may have their own brackets.
    let inner = &text[1..];
    let end = match close {
        ']' if inner.trim_start().starts_with('[') => inner.find("]]").map(|place| place + 1),
        _ => inner.find(close),
    };
    let end = end.ok_or_else(|| format!("its second line has {close} missing"))?;
    Ok((&inner[..end], &inner[end + 1..]))
}

/// Numbers separated by blanks or commas.
fn list(text: &str) -> Option<Vec<f64>> {
    let parts = text.split(|c: char| c.is_whitespace() || ",[]".contains(c)).filter(|part| !part.is_empty());
    parts.map(|part| part.parse().ok()).collect()
}

/// Boolean values for the three axes.
fn axes(text: &str) -> Option<[bool; 3]> {
    let parts = text.split(|c: char| c.is_whitespace() || ",[]".contains(c)).filter(|part| !part.is_empty());
    let axis = |part: &str| match part.to_lowercase().as_str() {
        "t" | "true" | "1" => Some(true),
        "f" | "false" | "0" => Some(false),
        _ => None,
    };
    parts.map(axis).collect::<Option<Vec<bool>>>()?.try_into().ok()
}

/// Names of a property's columns: properties that are used must have one number, except positions and images.
fn column_names(name: &str, width: u16) -> Result<Vec<String>, String> {
    let name = name.to_lowercase();
    let expected = match name.as_str() {
        "radius" | "diameter" | "species" | "type" | "id" => 1,
        "pos" => 3,
        "orientation" if width == 4 => 4,
        _ => return Ok((0..width).map(|column| format!("other {name} {column}")).collect()),
    };
    if width != expected {
        return Err(format!("its Properties have {name} with {width} columns; it needs {expected}"));
    }
    Ok(if width == 1 { vec![name] } else { (0..width).map(|column| format!("{name} {column}")).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_may_be_in_quotes_or_brackets() {
        let header =
            XyzHeader::of("comment Lattice='1 0 0 0 2 0 0 0 3' a={b c} Time = 0.5 d=[[1, 2], [3, 4]] Step=7").unwrap();
        assert_eq!(header.get("a"), Some("b c"));
        assert_eq!(header.get("d"), Some("[1, 2], [3, 4]"));
        assert_eq!((header.number(&["time"]), header.number::<i64>(&["other", "step"])), (Some(0.5), Some(7)));
        assert_eq!(header.cell().unwrap().unwrap().edges(), Vector::new(1.0, 2.0, 3.0));
        assert!(XyzHeader::of("Lattice=\"1 2").is_err());
        assert!(XyzHeader::of("two words").unwrap().cell().unwrap().is_none());
    }

    #[test]
    fn boxes_that_mean_nothing_are_refused() {
        let message = |line: &str| XyzHeader::of(line).unwrap().cell().unwrap_err();
        assert!(message("Lattice=\"1 0 0 0 2 0 0 0\"").contains("it needs 9 numbers"));
        assert!(message("Lattice=\"1 0 0 0 a 0 0 0 3\"").contains("it needs 9 numbers"));
        assert!(message("Lattice=\"1 0 0 0 0 0 0 0 3\"").contains("its box"));
        assert!(message("Lattice=\"1 0 0 0 1 0 0 0 1\" pbc=\"T T\"").contains("T or F"));
        assert!(message("Lattice=\"1 0 0 0 1 0 0 0 1\" Origin=\"1 2\"").contains("Origin"));
    }
}
