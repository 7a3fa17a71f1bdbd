//! Valid input, from which hostile input is made.

use crate::program::Program;
use crate::{hdf5_file, tree};
use anyhow::{Context, ensure};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use toml::Value;

/// Scenes of every kind; together they have all keys.
pub const SCENES: [(&str, &str); 14] = [
    ("suspension", include_str!("../scenes/suspension.toml")),
    ("plain", include_str!("../scenes/plain.toml")),
    ("direct", include_str!("../scenes/direct.toml")),
    ("positions", include_str!("../scenes/positions.toml")),
    ("disks", include_str!("../scenes/disks.toml")),
    ("poiseuille", include_str!("../scenes/poiseuille.toml")),
    ("sweep", include_str!("../scenes/sweep.toml")),
    ("cell", include_str!("../scenes/cell.toml")),
    ("stepped-cell", include_str!("../scenes/stepped-cell.toml")),
    ("continuum", include_str!("../scenes/continuum.toml")),
    ("bodies", include_str!("../scenes/bodies.toml")),
    ("filaments", include_str!("../scenes/filaments.toml")),
    ("squirmers", include_str!("../scenes/squirmers.toml")),
    ("fields", include_str!("../scenes/fields.toml")),
];

/// Cases of `mobility`.
pub const CASES: [&str; 3] = [
    r#"{"box": [9.0, 10.0, 11.0], "viscosity": 1.0, "positions": [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]],
        "radii": [0.5, 1.0, 0.7], "forces": [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 0.5, 0.0]],
        "torques": [[0.1, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.2]], "strain": 0.25,
        "background": {"velocity_gradient": [[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]}}"#,
    r#"{"box": [12.0, 12.0, 12.0], "viscosity": 2.0, "positions": [[5.0, 6.0, 6.0], [7.1, 6.0, 6.0]], "radii": 1.0,
        "forces": [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]], "rigid": true, "multipoles": "dipole", "lubrication": true,
        "lubrication_cutoff": 0.5}"#,
    r#"{"box": [8.0, 8.0, 8.0], "viscosity": 1.0, "positions": [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "radii": 1.0,
        "rigid": false, "stresslets": [[1.0, 0.0, 0.0, -1.0, 0.5], [0.0, 0.0, 0.0, 0.0, 0.0]]}"#,
];

/// Positions of spheres, as a table.
pub const CSV: &str = "x,y,z,radius,species\n1,2,3,1,0\n4,5,6,1,0\n7,8,9,1.5,1\n1,6,2,1,0\n";

/// The same positions in extended XYZ.
pub const XYZ: &str = "4\nLattice=\"10 0 0 0 10 0 0 0 10\" Properties=species:I:1:pos:R:3:radius:R:1\n\
    0 1 2 3 1\n0 4 5 6 1\n1 7 8 9 1.5\n0 1 6 2 1\n";

/// A scene with spheres from a file.
pub const PLACED: &str = "[box]\nedges = [10.0, 10.0, 10.0]\n[fluid]\nviscosity = 1.0\n[[species]]\nname = 'a'\n\
    radius = 1.0\nforce = [0.0, 0.0, -1.0]\n[[species]]\nname = 'b'\nradius = 1.5\n[hydrodynamics]\ntolerance = 1e-2\n\
    [time]\nstep = 0.01\nsteps = 1\n[particles]\ninitial = 'file'\n";

/// Valid input on the disk, and its keys.
pub struct InputPool {
    /// Folder with results of every scene by name, and cases in HDF5.
    pub folder: PathBuf,
    /// Scenes as trees, by name.
    pub scenes: Vec<(&'static str, Value)>,
    /// Cases as trees.
    pub cases: Vec<Value>,
    /// All their keys.
    pub keys: &'static [String],
}

impl InputPool {
    /// Computes the results with the program itself.
    pub fn make(folder: &Path, program: &Program) -> anyhow::Result<Self> {
        let program = program.with_patience(10);
        let scenes: Vec<(&str, Value)> =
            SCENES.iter().map(|(name, text)| Ok((*name, toml::from_str(text)?))).collect::<anyhow::Result<_>>()?;
        let cases: Vec<Value> = CASES.iter().map(|text| serde_json::from_str(text)).collect::<Result<_, _>>()?;
        for (name, text) in SCENES {
            std::fs::write(folder.join(format!("{name}.toml")), text)?;
            let arguments = ["run", &format!("{name}.toml"), "--out", name].map(OsString::from);
            let ended = program.run(folder, &arguments)?;
            ensure!(ended.status.success(), "the scene {name} does not run: {}", ended.stderr);
        }
        for (number, case) in cases.iter().enumerate() {
            let path = folder.join(format!("case-{number}.h5"));
            hdf5_file::write_tree(&path, case).with_context(|| format!("can't write {}", path.display()))?;
        }
        let placed: Value = toml::from_str(&format!("{PLACED}path = 'start.csv'"))?;
        let trees = scenes.iter().map(|(_, tree)| tree).chain(&cases).chain([&placed]);
        let mut keys: Vec<String> = trees.flat_map(tree::keys).collect();
        keys.sort();
        keys.dedup();
        Ok(Self { folder: folder.to_owned(), scenes, cases, keys: keys.leak() })
    }
    /// Keys that scenes have in a section, including the section.
    pub fn siblings(&self, section: &str) -> Vec<String> {
        let paths = self.scenes.iter().flat_map(|(_, tree)| tree::paths(tree));
        let is_in = |path: &String| path.rsplit_once('.').map_or("", |(parent, _)| parent) == section;
        let mut siblings: Vec<String> = paths.filter(is_in).collect();
        siblings.sort();
        siblings.dedup();
        siblings
    }
}
