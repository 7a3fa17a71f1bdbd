//! Check of the claimed size of HDF5 datasets against the size of the file.

use hdf5::{Container, Dataset, Group, H5Type};

/// Largest compression ratio of a filter (deflate: 1032).
const TIGHTEST: f64 = 1100.0;
/// Bytes that a dataset may have without storage in the file: if nothing was written, all values are the fill value.
const UNWRITTEN: f64 = 1048576.0;

/// Refuses a dataset that needs far more memory than its storage in the file allows: a few bytes can
/// claim a shape of petabytes.
pub(crate) fn check(values: &Container) -> hdf5::Result<()> {
    let (shape, stored) = (values.shape(), values.storage_size());
    let claimed = shape.iter().map(|&n| n as f64).product::<f64>() * values.dtype()?.size() as f64;
    if claimed <= UNWRITTEN + TIGHTEST * stored as f64 {
        return Ok(());
    }
    Err(format!("{} has the shape {shape:?}, but {stored} bytes in the file", values.name()).into())
}

/// Opens a dataset and checks its size.
pub(crate) fn dataset(group: &Group, name: &str) -> hdf5::Result<Dataset> {
    let dataset = group.dataset(name)?;
    check(&dataset)?;
    Ok(dataset)
}

/// Reads all numbers of a dataset and checks its size.
pub(crate) fn read<T: H5Type>(group: &Group, name: &str) -> hdf5::Result<Vec<T>> {
    dataset(group, name)?.read_raw()
}

#[cfg(test)]
mod tests {
    use super::*;
    use hdf5::File;

    #[test]
    fn shapes_are_believed_up_to_what_the_file_holds() {
        let folder = tempfile::tempdir().unwrap();
        let file = File::create(folder.path().join("a.h5")).unwrap();
        file.new_dataset::<f64>().chunk([1024]).shape([1 << 50]).create("vast").unwrap();
        file.new_dataset::<f64>().chunk([1 << 10, 8]).shape([1 << 30, 1 << 29]).create("beyond").unwrap();
        file.new_dataset::<f64>().shape([100]).create("unwritten").unwrap();
        let zeros = vec![0.0; 1 << 20];
        file.new_dataset_builder().deflate(9).chunk([1 << 18]).with_data(&zeros).create("tight").unwrap();
        let message = read::<f64>(&file, "vast").unwrap_err().to_string();
        assert!(message.contains("/vast has the shape [1125899906842624], but 0 bytes in the file"), "{message}");
        assert!(read::<f64>(&file, "beyond").is_err());
        assert_eq!(read::<f64>(&file, "unwritten").unwrap(), [0.0; 100]);
        assert_eq!(read::<f64>(&file, "tight").unwrap(), zeros);
    }
}
