//! The XDMF file that names fields, for programs that draw them. Paths are relative to it; axes are in the order z, y,
//! x.

use super::repeated::GROUP;
use hdf5::File;
use std::path::Path;

/// What the XDMF file says of a field.
pub(super) struct Frame {
    /// Whether its file has the velocity with repeated planes.
    pub(super) has_velocity: bool,
    /// Whether it has the places of those points.
    pub(super) has_position: bool,
    /// The Lees-Edwards strain of the box.
    pub(super) strain: f64,
    name: String,
    time: f64,
    edges: [f64; 3],
    points: [usize; 3],
}

impl Frame {
    /// Reads a field's file.
    pub(super) fn read(path: &Path) -> hdf5::Result<Self> {
        let file = File::open(path)?;
        let (edges, shape) = (file.attr("edges")?.read_raw::<f64>()?, file.dataset("velocity")?.shape());
        let (&[x, y, z], &[nz, ny, nx, 3]) = (&edges[..], &shape[..]) else {
            return Err(format!("it has {} edges, and `velocity` is of the shape {shape:?}", edges.len()).into());
        };
        let has = |name: &str| file.link_exists(GROUP) && file.link_exists(&format!("{GROUP}/{name}"));
        Ok(Self {
            has_velocity: has("velocity"),
            has_position: has("position"),
            strain: file.attr("strain")?.read_scalar()?,
            name: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            time: file.attr("time")?.read_scalar()?,
            edges: [z, y, x],
            points: [nz, ny, nx],
        })
    }

    fn grid(&self, curved: bool) -> String {
        let (geometry, velocity) = (if curved { self.curved() } else { self.straight() }, self.item("velocity"));
        format!(
            "<Grid Name=\"velocity\">\n<Time Value=\"{:?}\"/>\n{geometry}<Attribute Name=\"velocity\" \
             AttributeType=\"Vector\" Center=\"Node\">{velocity}</Attribute>\n</Grid>\n",
            self.time
        )
    }

    fn curved(&self) -> String {
        let (counts, places) = (self.counts(), self.item("position"));
        format!(
            "<Topology TopologyType=\"3DSMesh\" Dimensions=\"{counts}\"/>\n\
             <Geometry GeometryType=\"XYZ\">{places}</Geometry>\n"
        )
    }

    fn straight(&self) -> String {
        let numbers = |[z, y, x]: [f64; 3]| {
            format!(
                "<DataItem Format=\"XML\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"3\">{z:?} {y:?} {x:?}</DataItem>"
            )
        };
        let spacing = numbers([0, 1, 2].map(|axis| self.edges[axis] / self.points[axis] as f64));
        let (counts, origin) = (self.counts(), numbers([0.0; 3]));
        format!(
            "<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"{counts}\"/>\n\
             <Geometry GeometryType=\"ORIGIN_DXDYDZ\">{origin}{spacing}</Geometry>\n"
        )
    }

    fn item(&self, dataset: &str) -> String {
        format!(
            "<DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"{} 3\">\
             fields/{}:/{GROUP}/{dataset}</DataItem>",
            self.counts(),
            self.name
        )
    }

    fn counts(&self) -> String {
        self.points.map(|n| (n + 1).to_string()).join(" ")
    }
}

/// The whole file: the frames of the same grid as the last one, and in a comment the names of the others.
pub(super) fn series(frames: Vec<Frame>, curved: bool) -> String {
    let points = frames.last().map(|frame| frame.points);
    let (alike, others): (Vec<_>, Vec<_>) = frames.into_iter().partition(|frame| Some(frame.points) == points);
    let left_out = others.iter().map(|frame| format!("<!-- left out, of another grid: {} -->\n", frame.name));
    let grids: String = alike.iter().map(|frame| frame.grid(curved)).chain(left_out).collect();
    format!(
        "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n<Grid Name=\"velocity\" GridType=\"Collection\" \
         CollectionType=\"Temporal\">\n{grids}{END}"
    )
}

const END: &str = "</Grid>\n</Domain>\n</Xdmf>\n";

/// Whether the frames of a file are curved meshes.
pub(super) fn is_curved(series: &str) -> bool {
    series.contains("3DSMesh")
}

/// A file with one more frame, if it has `before` of them and stays as it is: of the same grid and kind of mesh.
pub(super) fn longer(series: &str, before: usize, frame: &Frame) -> Option<String> {
    let has = series.matches("<Time ").count() + series.matches("<!-- left out").count();
    let is_of_its_grid = series.contains(&format!("Dimensions=\"{}\"/>", frame.counts()));
    let curved = is_curved(series);
    let stays = has == before && is_of_its_grid && (curved || frame.strain == 0.0) && !series.contains(&frame.name);
    let frames = series.strip_suffix(END).filter(|_| stays)?;
    Some(format!("{frames}{}{END}", frame.grid(curved)))
}
