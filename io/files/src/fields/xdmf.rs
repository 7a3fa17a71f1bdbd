//! The XDMF file that describes fields for visualisation programs. Paths are relative to it; axes
//! are in the order z, y, x.

use super::lattice::{self, PointLattice};
use super::repeated::GROUP;
use crate::self_contained;
use std::path::Path;

/// Description of a field for the XDMF file.
pub(super) struct XdmfFrame {
    /// Whether its file has the velocity with repeated planes.
    pub(super) has_velocity: bool,
    /// Whether it has the positions of those points.
    pub(super) has_position: bool,
    /// Lees-Edwards strain of the box.
    pub(super) strain: f64,
    name: String,
    time: f64,
    edges: [f64; 3],
    points: [usize; 3],
    /// Grid of the points, if the box is not periodic along all axes.
    lattice: Option<PointLattice>,
}

/// Mesh type of a series, the same for all frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Meshes {
    Straight,
    Curved,
    /// Rectilinear meshes of any size, each the only part of a collection.
    Collected,
}

impl XdmfFrame {
    /// Reads a field's file.
    pub(super) fn read(path: &Path) -> hdf5::Result<Self> {
        let file = self_contained::open(path)?;
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
            lattice: lattice::read(&file)?,
        })
    }

    fn grid(&self, meshes: Meshes) -> String {
        let geometry = if meshes == Meshes::Curved { self.curved() } else { self.straight() };
        let (time, velocity) = (format!("<Time Value=\"{:?}\"/>\n", self.time), self.item("velocity"));
        let mesh = format!(
            "{geometry}<Attribute Name=\"velocity\" AttributeType=\"Vector\" Center=\"Node\">{velocity}</Attribute>\n"
        );
        match meshes {
            Meshes::Collected => {
                format!("<Grid Name=\"velocity\" {COLLECTION}>\n{time}<Grid Name=\"box\">\n{mesh}</Grid>\n</Grid>\n")
            }
            Meshes::Straight | Meshes::Curved => format!("<Grid Name=\"velocity\">\n{time}{mesh}</Grid>\n"),
        }
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
                "<DataItem Format=\"XML\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"3\">{z:?} {y:?} \
                 {x:?}</DataItem>"
            )
        };
        let of_box = || [[0.0; 3], [0, 1, 2].map(|axis| self.edges[axis] / self.points[axis] as f64)];
        let by_axis = |[x, y, z]: [f64; 3]| [z, y, x];
        let lattice = self.lattice.map(|lattice| [lattice.origin, lattice.spacing].map(by_axis));
        let (counts, [origin, spacing]) = (self.counts(), lattice.unwrap_or_else(of_box).map(numbers));
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
        let [x, y, z] = self.lattice.map_or([true; 3], |lattice| lattice.periodic);
        let repeats = [z, y, x];
        [0, 1, 2].map(|axis| (self.points[axis] + usize::from(repeats[axis])).to_string()).join(" ")
    }
}

/// The whole file. For fully periodic boxes it has the frames on the same grid as the last one, and in a comment the
/// names of the others; for other boxes it has all frames.
pub(super) fn series(frames: Vec<XdmfFrame>, curved: bool) -> String {
    let last = frames.last().map(|frame| (frame.points, frame.lattice.is_some()));
    let is_like_last = |frame: &XdmfFrame| {
        last.is_some_and(|(points, is_bounded)| {
            frame.lattice.is_some() == is_bounded && (is_bounded || frame.points == points)
        })
    };
    let (alike, others): (Vec<_>, Vec<_>) = frames.into_iter().partition(is_like_last);
    let are_equal = alike.windows(2).all(|pair| pair[0].points == pair[1].points);
    let meshes = match (curved, are_equal) {
        (true, _) => Meshes::Curved,
        (false, true) => Meshes::Straight,
        (false, false) => Meshes::Collected,
    };
    let left_out = others.iter().map(|frame| format!("<!-- left out, of another grid: {} -->\n", frame.name));
    let grids: String = alike.iter().map(|frame| frame.grid(meshes)).chain(left_out).collect();
    format!(
        "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n<Grid Name=\"velocity\" GridType=\"Collection\" \
         CollectionType=\"Temporal\">\n{grids}{END}"
    )
}

const END: &str = "</Grid>\n</Domain>\n</Xdmf>\n";
const COLLECTION: &str = "GridType=\"Collection\" CollectionType=\"Spatial\"";

/// Whether the frames of a file are curvilinear meshes.
pub(super) fn is_curved(series: &str) -> bool {
    series.contains("3DSMesh")
}

/// The file with one more frame, if it has `before` frames of the same grid and mesh type; otherwise `None`.
pub(super) fn longer(series: &str, before: usize, frame: &XdmfFrame) -> Option<String> {
    let has = series.matches("<Time ").count() + series.matches("<!-- left out").count();
    let meshes = match (is_curved(series), series.contains(COLLECTION)) {
        (true, _) => Meshes::Curved,
        (false, true) => Meshes::Collected,
        (false, false) => Meshes::Straight,
    };
    let fits = match meshes {
        Meshes::Collected => frame.lattice.is_some(),
        Meshes::Straight | Meshes::Curved => series.contains(&format!("Dimensions=\"{}\"/>", frame.counts())),
    };
    let is_of_its_kind = meshes == Meshes::Curved || frame.strain == 0.0;
    let stays = has == before && fits && is_of_its_kind && !series.contains(&frame.name);
    let frames = series.strip_suffix(END).filter(|_| stays)?;
    Some(format!("{frames}{}{END}", frame.grid(meshes)))
}
