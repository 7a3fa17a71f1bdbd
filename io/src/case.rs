//! A single configuration given by the user, and its answer: JSON, or HDF5 with the same names.

use crate::{CaseBoundary, CaseBox, CaseBoxError, FileError, atomic_file, atomic_hdf5, claimed_size};
use domain::{Number, PeriodicBox, Turn};
use hdf5::types::{TypeDescriptor, VarLenAscii, VarLenUnicode};
use hdf5::{Container, File, Group};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use std::path::Path;

/// Particles in a box, what acts on them, and what is asked for. Lists of `N` have an entry for each particle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Edges of the box, or its lattice vectors; only spheres in open fluid need none.
    #[serde(rename = "box", default, skip_serializing_if = "Option::is_none")]
    pub cell: Option<CaseBox>,
    /// What the box is along each axis.
    #[serde(default = "periodic")]
    pub boundaries: [CaseBoundary; 3],
    /// Lees-Edwards strain of the box.
    #[serde(default)]
    pub strain: f64,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// Centres of the particles, `N` of them.
    pub positions: Vec<[f64; 3]>,
    /// Their radii.
    pub radii: OneOrAll,
    /// Forces; zero if absent.
    #[serde(default)]
    pub forces: Vec<[f64; 3]>,
    /// Torques; zero if absent.
    #[serde(default)]
    pub torques: Vec<[f64; 3]>,
    /// Stresslets (xx, xy, xz, yy, yz) of particles that are not rigid; zero if absent.
    #[serde(default)]
    pub stresslets: Vec<[f64; 5]>,
    /// Whether the stresslets are to be found that keep the particles rigid.
    #[serde(default = "yes")]
    pub rigid: bool,
    /// `"monopole"` or `"dipole"`.
    #[serde(default)]
    pub multipoles: Terms,
    /// Whether near pairs of rigid particles feel lubrication.
    #[serde(default)]
    pub lubrication: bool,
    /// The gap where lubrication ends over the larger radius of the two; the program's default if absent.
    #[serde(default)]
    pub lubrication_cutoff: Option<f64>,
    /// The background flow.
    #[serde(default)]
    pub background: Background,
    /// Random motions whose covariance is the mobility, besides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<Noise>,
}

/// Random motions that are asked for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// How many.
    pub draws: u64,
    /// Where random numbers start.
    pub seed: u64,
    /// Whether random parts of the drift are wanted besides, of rigid particles.
    #[serde(default)]
    pub drift: bool,
}

/// Random motions of one draw come as this many numbers of a particle, at most, and so does the drift.
pub const NOISE_NUMBERS: usize = 11;

/// A number for all particles, or one for each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum OneOrAll {
    /// The same for all.
    One(f64),
    /// Each its own.
    All(Vec<f64>),
}

/// Terms of the multipole expansion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Terms {
    /// Forces alone.
    Monopole,
    /// Forces, torques and stresslets.
    #[default]
    Dipole,
}

/// A linear flow.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Background {
    /// `G[i][j] = du_i / dx_j`.
    #[serde(default)]
    pub velocity_gradient: [[f64; 3]; 3],
    /// `dp / dx_i`, which drives a flow between walls.
    #[serde(default)]
    pub pressure_gradient: [f64; 3],
}

/// Draws of a case at most.
const MOST_DRAWS: u64 = 1_000_000;

fn yes() -> bool {
    true
}

fn periodic() -> [CaseBoundary; 3] {
    [CaseBoundary::Periodic; 3]
}

/// The answer to a [`Case`]; fields that were not computed are absent.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Answer {
    /// Velocities relative to the background flow at the centres.
    pub velocities: Vec<[f64; 3]>,
    /// Angular velocities relative to the background flow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angular_velocities: Option<Vec<[f64; 3]>>,
    /// Rates of strain of the disturbance flow (xx, xy, xz, yy, yz).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strain_rates: Option<Vec<[f64; 5]>>,
    /// Stresslets (xx, xy, xz, yy, yz); with lubrication, the whole hydrodynamic ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stresslets: Option<Vec<[f64; 5]>>,
    /// With lubrication, the part of the stresslets that the far field sees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stresslets_far: Option<Vec<[f64; 5]>>,
    /// Random velocities, one list for each draw.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_velocities: Option<Vec<Vec<[f64; 3]>>>,
    /// Random angular velocities.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_angular_velocities: Option<Vec<Vec<[f64; 3]>>>,
    /// Random rates of strain (xx, xy, xz, yy, yz), of particles that are not rigid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_strain_rates: Option<Vec<Vec<[f64; 5]>>>,
    /// Random parts of the drift at a thermal energy of 1, velocities, one list for each draw.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drift_velocities: Option<Vec<Vec<[f64; 3]>>>,
    /// Angular velocities.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drift_angular_velocities: Option<Vec<Vec<[f64; 3]>>>,
    /// Stresslets (xx, xy, xz, yy, yz) that go with it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drift_stresslets: Option<Vec<Vec<[f64; 5]>>>,
    /// Iterations for the stresslets and for lubrication.
    pub iterations: usize,
    /// Their relative residual.
    pub residual: f64,
    /// Seconds that the evaluation took.
    pub seconds: f64,
    /// How it was evaluated.
    pub plan: String,
}

impl Case {
    /// Reads a case and checks it. Files whose name ends in `.h5` or `.hdf5` are HDF5, all others JSON.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        if !is_hdf5(path) {
            let text = std::fs::read_to_string(path).map_err(|e| FileError::read(path, &e))?;
            return Self::parse(&text, path);
        }
        let contents = File::open(path).and_then(|file| contents(&file, true));
        Self::checked(serde_json::from_value(contents.map_err(|e| FileError::read(path, &e))?), path)
    }

    /// Checks a case in JSON; `name` is what messages call it.
    pub fn parse(text: &str, name: &Path) -> Result<Self, FileError> {
        Self::checked(serde_json::from_str(text), name)
    }

    fn checked(case: serde_json::Result<Self>, name: &Path) -> Result<Self, FileError> {
        let case = case.map_err(|e| FileError::read(name, &e))?;
        case.check().map_err(|reason| FileError::read(name, &reason))?;
        Ok(case)
    }

    /// The case as JSON, for other ranks.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).expect("finite numbers and text can be written as JSON")
    }

    /// A case as another rank sent it.
    ///
    /// # Panics
    /// If the text is not from [`Case::to_json`].
    pub fn from_json(text: &str) -> Self {
        serde_json::from_str(text).expect("a case that was checked on the first rank")
    }

    /// The radius of each particle.
    pub fn radii(&self) -> Vec<f64> {
        match &self.radii {
            OneOrAll::One(radius) => vec![*radius; self.positions.len()],
            OneOrAll::All(radii) => radii.clone(),
        }
    }

    /// The box with its special axis last, and the turn to its axes.
    pub fn bounded_box(&self) -> Result<(PeriodicBox, Turn), CaseBoxError> {
        CaseBox::bounded(self.cell, self.strain, self.boundaries, (&self.positions, &self.radii()))
    }

    fn check(&self) -> Result<(), String> {
        if self.cell.is_none() || self.boundaries != periodic() {
            self.bounded_box().map_err(|error| error.to_string())?;
        }
        let count = self.positions.len();
        let fits = |key: &str, found: usize, may_be_absent: bool| {
            if found == count || (may_be_absent && found == 0) {
                return Ok(());
            }
            Err(format!("{key} has {found} entries, but there are {count} positions; it needs one for each"))
        };
        fits("radii", self.radii().len(), false)?;
        fits("forces", self.forces.len(), true)?;
        fits("torques", self.torques.len(), true)?;
        fits("stresslets", self.stresslets.len(), true)?;
        let finite = |key: &str, mut numbers: Box<dyn Iterator<Item = f64> + '_>| {
            let wrong = numbers.find(|n| !n.is_finite());
            wrong.map_or(Ok(()), |n| Err(format!("{key} contains {n}; every number needs to be finite")))
        };
        finite("positions", Box::new(self.positions.iter().flatten().copied()))?;
        finite("forces", Box::new(self.forces.iter().flatten().copied()))?;
        finite("torques", Box::new(self.torques.iter().flatten().copied()))?;
        finite("stresslets", Box::new(self.stresslets.iter().flatten().copied()))?;
        finite("background.velocity_gradient", Box::new(self.background.velocity_gradient.into_iter().flatten()))?;
        finite("background.pressure_gradient", Box::new(self.background.pressure_gradient.into_iter()))?;
        if !(self.viscosity.is_finite() && self.viscosity > 0.0) {
            return Err(format!("viscosity is {}; it needs to be positive and finite", Number(self.viscosity)));
        }
        let given = |list: &[[f64; 5]]| list.iter().flatten().any(|&s| s != 0.0);
        if self.rigid && self.multipoles == Terms::Dipole && given(&self.stresslets) {
            return Err("stresslets are given, but rigid particles have their own; set rigid to false".to_owned());
        }
        if self.lubrication && !(self.rigid && self.multipoles == Terms::Dipole) {
            return Err("lubrication is true, but that is for rigid particles with dipoles; set rigid to true and \
                        multipoles to \"dipole\", or lubrication to false"
                .to_owned());
        }
        if let Some(cutoff) = self.lubrication_cutoff.filter(|c| !(self.lubrication && *c > 1e-3 && *c <= 8.0)) {
            return Err(format!(
                "lubrication_cutoff is {}; it needs 0.001 < lubrication_cutoff <= 8, in radii of a pair's larger sphere, and \
                 lubrication true",
                Number(cutoff)
            ));
        }
        if self.noise.is_some_and(|noise| noise.draws == 0 || noise.draws > MOST_DRAWS) {
            return Err(format!("noise.draws needs to be 1 to {MOST_DRAWS}"));
        }
        let is_rigid = self.rigid && self.multipoles == Terms::Dipole;
        if self.noise.is_some_and(|noise| noise.drift) && !is_rigid {
            return Err("noise.drift is true, but only rigid particles drift; set rigid to true and multipoles to \"dipole\", or \
                        noise.drift to false"
                .to_owned());
        }
        if self.multipoles == Terms::Monopole {
            let twisted = self.torques.iter().flatten().any(|&t| t != 0.0);
            if twisted || given(&self.stresslets) {
                return Err(
                    "torques or stresslets are given, but multipoles is \"monopole\"; use \"dipole\"".to_owned()
                );
            }
        }
        Ok(())
    }
}

impl Answer {
    /// Writes the answer to a file, HDF5 if its name ends in `.h5` or `.hdf5`, else JSON.
    pub fn write(&self, path: &Path) -> Result<(), FileError> {
        if is_hdf5(path) {
            return atomic_hdf5::write(path, |file| self.fill(file));
        }
        atomic_file::replace(path, self.to_json().as_bytes())
    }

    /// The answer as JSON.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string(self).expect("numbers and text can be written as JSON");
        text.push('\n');
        text
    }

    fn fill(&self, file: &File) -> hdf5::Result<()> {
        let table = |name: &str, width: usize, values: Vec<f64>| -> hdf5::Result<()> {
            let rows = values.len() / width;
            let values = ndarray::Array2::from_shape_vec((rows, width), values).expect("whole rows");
            file.new_dataset_builder().with_data(&values).create(name).map(|_| ())
        };
        table("velocities", 3, self.velocities.concat())?;
        if let Some(list) = &self.angular_velocities {
            table("angular_velocities", 3, list.concat())?;
        }
        if let Some(list) = &self.strain_rates {
            table("strain_rates", 5, list.concat())?;
        }
        if let Some(list) = &self.stresslets {
            table("stresslets", 5, list.concat())?;
        }
        if let Some(list) = &self.stresslets_far {
            table("stresslets_far", 5, list.concat())?;
        }
        draws(file, "noise_velocities", self.noise_velocities.as_deref())?;
        draws(file, "noise_angular_velocities", self.noise_angular_velocities.as_deref())?;
        draws(file, "noise_strain_rates", self.noise_strain_rates.as_deref())?;
        draws(file, "drift_velocities", self.drift_velocities.as_deref())?;
        draws(file, "drift_angular_velocities", self.drift_angular_velocities.as_deref())?;
        draws(file, "drift_stresslets", self.drift_stresslets.as_deref())?;
        file.new_dataset::<u64>().create("iterations")?.write_scalar(&(self.iterations as u64))?;
        file.new_dataset::<f64>().create("residual")?.write_scalar(&self.residual)?;
        file.new_dataset::<f64>().create("seconds")?.write_scalar(&self.seconds)?;
        let plan: VarLenUnicode = self.plan.parse().map_err(|_| "the plan has a zero byte")?;
        file.new_dataset::<VarLenUnicode>().create("plan")?.write_scalar(&plan)
    }
}

/// Lists of draws, `(draws, N, W)`.
fn draws<const W: usize>(file: &File, name: &str, lists: Option<&[Vec<[f64; W]>]>) -> hdf5::Result<()> {
    let Some(lists) = lists else { return Ok(()) };
    let shape = (lists.len(), lists.first().map_or(0, Vec::len), W);
    let values = ndarray::Array3::from_shape_vec(shape, lists.concat().concat()).expect("lists of one length");
    file.new_dataset_builder().with_data(&values).create(name).map(|_| ())
}

fn is_hdf5(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "h5" || e == "hdf5")
}

/// The datasets and attributes of a group as a JSON object, with its groups, and their content if `counts`: a case has
/// only one level of groups, and links may form cycles.
fn contents(group: &Group, counts: bool) -> hdf5::Result<Value> {
    let mut object = Map::new();
    for name in group.attr_names()? {
        object.insert(name.clone(), value(&name, &*group.attr(&name)?)?);
    }
    for name in group.member_names()? {
        let value = match group.dataset(&name) {
            Ok(dataset) => value(&name, &dataset)?,
            Err(_) if counts => contents(&group.group(&name)?, false)?,
            Err(_) => json!({}),
        };
        object.insert(name, value);
    }
    Ok(Value::Object(object))
}

fn value(name: &str, container: &Container) -> hdf5::Result<Value> {
    claimed_size::check(container)?;
    match container.dtype()?.to_descriptor()? {
        TypeDescriptor::Boolean => return Ok(json!(container.read_scalar::<bool>()?)),
        TypeDescriptor::VarLenUnicode if container.ndim() == 1 => {
            let words = container.read_raw::<VarLenUnicode>()?;
            return Ok(json!(words.iter().map(VarLenUnicode::as_str).collect::<Vec<_>>()));
        }
        TypeDescriptor::VarLenUnicode => return Ok(json!(container.read_scalar::<VarLenUnicode>()?.as_str())),
        TypeDescriptor::VarLenAscii => return Ok(json!(container.read_scalar::<VarLenAscii>()?.as_str())),
        _ => {}
    }
    let numbers = container.read_dyn::<f64>()?;
    if let Some(wrong) = numbers.iter().find(|number| !number.is_finite()) {
        // JSON has no such numbers; without this they would count as absent.
        return Err(format!("{name} contains {wrong}; every number needs to be finite").into());
    }
    Ok(nested(&numbers.view()))
}

fn nested(numbers: &ndarray::ArrayViewD<f64>) -> Value {
    if numbers.ndim() == 0 {
        return json!(numbers.first());
    }
    Value::Array(numbers.outer_iter().map(|inner| nested(&inner)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Case, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("case.json");
        std::fs::write(&path, text).unwrap();
        Case::read(&path).map_err(|e| e.to_string().replace(&path.display().to_string(), "case.json"))
    }

    fn hdf5_case(write: impl FnOnce(&File)) -> Result<Case, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("case.h5");
        let file = File::create(&path).unwrap();
        file.new_dataset_builder().with_data(&[4.0, 5.0, 6.0]).create("box").unwrap();
        file.new_dataset_builder().with_data(&ndarray::array![[1.0, 2.0, 3.0]]).create("positions").unwrap();
        for (name, number) in [("viscosity", 2.0), ("radii", 0.5)] {
            file.new_dataset::<f64>().create(name).unwrap().write_scalar(&number).unwrap();
        }
        write(&file);
        drop(file);
        Case::read(&path).map_err(|e| e.to_string().replace(&path.display().to_string(), "case.h5"))
    }

    #[test]
    fn numbers_in_hdf5_that_are_none_are_refused_by_name() {
        for wrong in [f64::NAN, f64::INFINITY] {
            let error = hdf5_case(|file| {
                file.new_dataset::<f64>().create("lubrication_cutoff").unwrap().write_scalar(&wrong).unwrap();
            });
            let expected =
                format!("can't read case.h5: lubrication_cutoff contains {wrong}; every number needs to be finite");
            assert_eq!(error.unwrap_err(), expected);
        }
    }

    #[test]
    fn links_that_lead_back_end() {
        for name in ["loop", "background"] {
            let error = hdf5_case(|file| file.link_hard("/", name).unwrap()).unwrap_err();
            assert!(error.contains("unknown field"), "{error}");
        }
    }

    #[test]
    fn what_is_absent_is_zero_and_rigid() {
        let case =
            read(r#"{"box": [4, 5, 6], "viscosity": 1, "positions": [[1, 2, 3], [3, 2, 1]], "radii": 0.5}"#).unwrap();
        assert_eq!((case.radii(), case.rigid, case.multipoles), (vec![0.5, 0.5], true, Terms::Dipole));
        assert_eq!((case.strain, case.background.velocity_gradient), (0.0, [[0.0; 3]; 3]));
    }

    #[test]
    fn mistakes_are_named() {
        let with = |more: &str| {
            read(&format!(r#"{{"box": [4, 5, 6], "viscosity": 1, "positions": [[1, 2, 3]], "radii": [0.5]{more}}}"#))
        };
        let message = |more: &str| with(more).unwrap_err();
        assert_eq!(
            message(r#", "forces": [[1, 2, 3], [1, 2, 3]]"#),
            "can't read case.json: forces has 2 entries, but there are 1 positions; it needs one for each"
        );
        assert!(message(r#", "force": []"#).contains("unknown field `force`, expected one of"));
        assert!(message(r#", "stresslets": [[1, 0, 0, 0, 0]]"#).contains("set rigid to false"));
        assert!(message(r#", "multipoles": "monopole", "torques": [[1, 0, 0]]"#).contains("use \"dipole\""));
        assert!(message(r#", "lubrication": true, "rigid": false"#).contains("set rigid to true"));
        assert!(message(r#", "lubrication": true, "lubrication_cutoff": 9.0"#).contains("<= 8"));
        assert!(message(r#", "noise": {"draws": 0, "seed": 1}"#).contains("noise.draws needs to be 1 to"));
        assert!(message(r#", "noise": {"draws": 2}"#).contains("missing field `seed`"));
        let drift = r#", "rigid": false, "noise": {"draws": 2, "seed": 1, "drift": true}"#;
        assert!(message(drift).contains("noise.drift is true, but only rigid particles drift"));
        assert!(message(r#", "multipoles": "quadrupole""#).contains("unknown variant"));
        assert!(read(r#"{"viscosity": 1}"#).unwrap_err().contains("missing field `positions`"));
        assert!(
            read(r#"{"box": [1, 2]}"#).unwrap_err().contains("box needs to be three edges, or three lattice vectors")
        );
    }

    #[test]
    fn boxes_may_have_walls_or_be_open() {
        let with = |more: &str| {
            read(&format!(r#"{{"viscosity": 1, "positions": [[1, 2, 3], [3, 2, 8]], "radii": 0.5{more}}}"#))
        };
        let case = with(r#", "box": [4, 5, 9], "boundaries": ["periodic", "walls", "periodic"]"#).unwrap();
        let (cell, turn) = case.bounded_box().unwrap();
        assert_eq!((cell.edges().to_array(), turn), ([4.0, 9.0, 5.0], Turn::to_last(1)));
        let open = with(r#", "boundaries": ["open", "open", "open"]"#).unwrap();
        assert_eq!(open.bounded_box().unwrap().0.edges(), domain::Vector::new(3.25, 1.25, 6.25));
        let error = |more: &str| with(more).unwrap_err();
        assert!(error(r#", "boundaries": ["walls", "periodic", "periodic"]"#).contains("missing field `box`"));
        assert!(error(r#", "box": [4, 5, 9], "boundaries": ["walls", "open", "periodic"]"#).contains("possible are"));
        assert!(error(r#", "box": [4, 5, 9], "boundaries": ["wand", "open", "periodic"]"#).contains("unknown variant"));
        assert!(
            error(r#", "box": [4, 5, 9], "strain": 0.1, "boundaries": ["periodic", "periodic", "wall"]"#)
                .contains("not sheared")
        );
    }

    #[test]
    fn boundaries_in_hdf5_are_words() {
        let case = hdf5_case(|file| {
            let words: Vec<VarLenUnicode> =
                ["periodic", "periodic", "walls"].iter().map(|word| word.parse().unwrap()).collect();
            file.new_dataset_builder().with_data(&words).create("boundaries").unwrap();
        });
        assert_eq!(case.unwrap().boundaries[2], CaseBoundary::Walls);
    }

    #[test]
    fn hdf5_has_the_same_names() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("case.h5");
        let file = File::create(&path).unwrap();
        let table =
            |name: &str, rows: ndarray::Array2<f64>| file.new_dataset_builder().with_data(&rows).create(name).unwrap();
        file.new_dataset_builder().with_data(&[4.0, 5.0, 6.0]).create("box").unwrap();
        table("positions", ndarray::array![[1.0, 2.0, 3.0], [3.0, 2.0, 1.0]]);
        table("forces", ndarray::array![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
        file.new_dataset::<f64>().create("viscosity").unwrap().write_scalar(&2.0).unwrap();
        file.new_dataset::<f64>().create("radii").unwrap().write_scalar(&0.5).unwrap();
        file.new_dataset::<bool>().create("rigid").unwrap().write_scalar(&false).unwrap();
        let group = file.create_group("background").unwrap();
        let gradient = ndarray::array![[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]];
        group.new_dataset_builder().with_data(&gradient).create("velocity_gradient").unwrap();
        drop(file);
        let case = Case::read(&path).unwrap();
        assert_eq!((case.cell, case.viscosity, case.rigid), (Some(CaseBox::Edges([4.0, 5.0, 6.0])), 2.0, false));
        assert_eq!(case.forces, vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
        assert!((case.background.velocity_gradient[0][1] - 1.0).abs() < 1e-15);
        let noise_velocities = Some(vec![vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]; 4]);
        let plan = "a plan".to_owned();
        let answer = Answer { velocities: vec![[1.0, 2.0, 3.0]; 2], noise_velocities, plan, ..Answer::default() };
        let path = folder.path().join("answer.h5");
        answer.write(&path).unwrap();
        let found = File::open(&path).unwrap().dataset("velocities").unwrap().read_raw::<f64>().unwrap();
        assert_eq!(found, [1.0, 2.0, 3.0, 1.0, 2.0, 3.0]);
        let drawn = File::open(&path).unwrap().dataset("noise_velocities").unwrap();
        assert_eq!((drawn.shape(), drawn.read_raw::<f64>().unwrap()[4]), (vec![4, 2, 3], 5.0));
    }
}
