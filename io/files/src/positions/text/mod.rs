//! Positions in text files.

mod columns;
mod csv;
mod csv_cells;
mod lammps;
mod lammps_box;
mod number;
mod xyz;
mod xyz_header;

pub(super) use csv::read as csv;
pub(super) use lammps::read as lammps;
pub(super) use xyz::read as xyz;

/// Decodes UTF-8, or UTF-16 with a byte order mark, with line ends of any system. The byte order mark is removed.
pub(super) fn decoded(bytes: Vec<u8>) -> Result<String, String> {
    let pairs =
        |of: fn([u8; 2]) -> u16| bytes[2..].chunks_exact(2).map(|pair| of([pair[0], pair[1]])).collect::<Vec<_>>();
    let text = match bytes.get(..2) {
        Some([0xff, 0xfe]) => String::from_utf16(&pairs(u16::from_le_bytes)).ok(),
        Some([0xfe, 0xff]) => String::from_utf16(&pairs(u16::from_be_bytes)).ok(),
        _ => String::from_utf8(bytes).ok(),
    };
    let text = text.ok_or("it is not text in UTF-8; save it in that encoding")?;
    let text = text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text);
    Ok(if text.contains('\r') { text.replace("\r\n", "\n").replace('\r', "\n") } else { text })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_of_other_systems_is_decoded() {
        assert_eq!(decoded(b"\xef\xbb\xbfx,y\r\n1,2\r3,4\n".to_vec()).unwrap(), "x,y\n1,2\n3,4\n");
        assert_eq!(decoded(vec![0xff, 0xfe, b'x', 0, b'\n', 0]).unwrap(), "x\n");
        assert_eq!(decoded(vec![0xfe, 0xff, 0, b'x']).unwrap(), "x");
        assert!(decoded(vec![b'x', 0xb5]).unwrap_err().contains("UTF-8"));
    }
}
