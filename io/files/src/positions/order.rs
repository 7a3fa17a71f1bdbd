//! Sorting of particles by id.

use super::StartFile;

/// Sorts the particles by their ids, if they have some; returns a note on their new numbers unless the ids
/// are consecutive from 0 or 1.
pub(super) fn sort(file: &mut StartFile) -> Result<Option<String>, String> {
    let Some(ids) = file.ids.take() else { return Ok(None) };
    let mut rows: Vec<usize> = (0..ids.len()).collect();
    rows.sort_by_key(|&row| ids[row]);
    if let Some(pair) = rows.windows(2).find(|pair| ids[pair[0]] == ids[pair[1]]) {
        return Err(format!("two of its particles have the id {}; each needs its own", ids[pair[0]]));
    }
    arranged(&mut file.positions, &rows);
    file.images.iter_mut().for_each(|list| arranged(list, &rows));
    file.radii.iter_mut().for_each(|list| arranged(list, &rows));
    file.orientations.iter_mut().for_each(|list| arranged(list, &rows));
    file.species.iter_mut().for_each(|kinds| arranged(kinds.numbers_mut(), &rows));
    let (Some(&first), Some(&last)) = (rows.first(), rows.last()) else { return Ok(None) };
    let (first, last, count) = (ids[first], ids[last], ids.len() as u64);
    let is_whole = first <= 1 && last - first == count - 1;
    Ok((!is_whole).then(|| {
        format!(
            "its ids, from {first} to {last}, leave some out; in their order particles are numbered 0 to {}",
            count - 1
        )
    }))
}

/// Puts a list into the order of `rows`.
fn arranged<T: Clone>(list: &mut [T], rows: &[usize]) {
    let sorted: Vec<T> = rows.iter().map(|&row| list[row].clone()).collect();
    list.clone_from_slice(&sorted);
}

#[cfg(test)]
mod tests {
    use super::super::species::SpeciesColumn;
    use super::*;
    use domain::{Quaternion, Vector};

    fn file(ids: &[u64]) -> StartFile {
        StartFile {
            positions: ids.iter().map(|&id| Vector::X * id as f64).collect(),
            radii: Some(ids.iter().map(|&id| 1.0 + id as f64).collect()),
            species: Some(SpeciesColumn::Indices(ids.iter().map(|&id| id as u32).collect())),
            images: Some(ids.iter().map(|&id| [id as i32; 3]).collect()),
            orientations: Some(ids.iter().map(|&id| Quaternion { w: id as f64, v: Vector::ZERO }).collect()),
            ids: Some(ids.to_vec()),
            ..StartFile::default()
        }
    }

    #[test]
    fn everything_follows_the_ids() {
        let mut sorted = file(&[3, 1, 2]);
        assert_eq!(sort(&mut sorted), Ok(None));
        assert_eq!(sorted.positions, [1.0, 2.0, 3.0].map(|x| Vector::X * x));
        assert_eq!((sorted.radii, sorted.images), (Some(vec![2.0, 3.0, 4.0]), Some(vec![[1; 3], [2; 3], [3; 3]])));
        assert_eq!(sorted.orientations.unwrap().iter().map(|q| q.w).collect::<Vec<_>>(), [1.0, 2.0, 3.0]);
        assert_eq!(sorted.species.unwrap().numbers_mut(), [1, 2, 3]);
    }

    #[test]
    fn ids_that_leave_some_out_are_said_and_twins_refused() {
        assert!(sort(&mut file(&[9, 4])).unwrap().unwrap().contains("from 4 to 9"));
        assert!(sort(&mut file(&[2, 3])).unwrap().is_some());
        assert!(sort(&mut file(&[1, 0, 2])).unwrap().is_none());
        assert!(sort(&mut file(&[5, 0, 5])).unwrap_err().contains("have the id 5"));
    }
}
