use super::*;
use crate::start;
use domain::{Particles, Vector};
use files::SCENES;
use scene::in_full;
use std::path::Path;

/// A scene that starts from a file in a folder.
fn scene(folder: &Path, name: &str, edges: &str, flow: &str, species: &[(&str, f64, u64)]) -> Result<Scene, String> {
    let section = |(name, radius, count): &(&str, f64, u64)| {
        format!("[[species]]\nname = '{name}'\nradius = {radius:?}\ncount = {count}\n")
    };
    let species = species.iter().map(section).collect::<Vec<_>>().concat();
    let text = format!(
        "[box]\n{edges}\n[fluid]\nviscosity = 1.0\n{species}[hydrodynamics]\ntolerance = 1e-2\n\
         lubrication = false\n{flow}\n[time]\nstep = 0.01\nsteps = 1\n[particles]\ninitial = 'file'\npath = '{name}'\n"
    );
    SCENES.parse(&text, &folder.join("scene.toml").display().to_string(), &[]).map_err(|e| e.to_string())
}

/// A start in a box of 20 with species of the given names, radii and counts, and spheres from a file: positions and
/// radii in the order of species, and the notes.
fn started(name: &str, text: &str, species: &[(&str, f64, u64)]) -> Result<(Vec<[f64; 4]>, String), String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), text).unwrap();
    let scene = scene(folder.path(), name, "edges = [20.0, 20.0, 20.0]", "", species)?;
    let (scene, notes) = with_start_file(scene, &Comm::alone()).map_err(|e| e.to_string())?;
    let simulation = start(&scene, &Comm::alone(), &mut |_| ()).map_err(|e| in_full(&e))?;
    let Particles { positions, species, .. } = simulation.frame().particles;
    let row = |(x, &kind): (&Vector, &u32)| [x.x, x.y, x.z, f64::from(kind)];
    Ok((positions.iter().zip(&species).map(row).collect(), notes.join("\n")))
}

const TWO: [(&str, f64, u64); 2] = [("A", 1.0, 1), ("B", 2.0, 1)];

#[test]
fn species_are_those_of_the_names_whatever_the_order_of_rows() {
    let expected = [[2.0, 2.0, 2.0, 1.0], [12.0, 2.0, 2.0, 0.0]];
    let lattice = "Lattice=\"20 0 0 0 20 0 0 0 20\" Properties=";
    for (name, text) in [
        ("a.csv", "x,y,z,species\n2,2,2,B\n12,2,2,A\n".to_owned()),
        ("a.csv", "x,y,z,type\n2,2,2,2\n12,2,2,1\n".to_owned()),
        ("a.csv", "x,y,z,species\n2,2,2,1\n12,2,2,0\n".to_owned()),
        ("a.csv", "x,y,z,radius\n2,2,2,2.00001\n12,2,2,1\n".to_owned()),
        ("a.csv", "x,y,z,diameter\n2,2,2,4\n12,2,2,2\n".to_owned()),
        ("a.csv", "x,y,z,id,species\n12,2,2,2,A\n2,2,2,1,B\n".to_owned()),
        ("a.xyz", format!("2\n{lattice}species:S:1:pos:R:3\nB 2 2 2\nA 12 2 2\n")),
        ("a.xyz", format!("2\n{lattice}pos:R:3:type:I:1\n2 2 2 2\n12 2 2 1\n")),
        ("a.xyz", format!("2\n{lattice}id:I:1:species:S:1:pos:R:3\n9 A 12 2 2\n3 B 2 2 2\n")),
        ("a.xyz", "2\nplain\nB 2 2 2\nA 12 2 2\n".to_owned()),
        ("a.xyz", "2\nplain\n2 2 2 2\n1 12 2 2\n".to_owned()),
        ("dump.lammps", dump("pp pp pp\n0 20\n0 20\n0 20", "id type x y z\n2 1 12 2 2\n1 2 2 2 2")),
        ("dump.lammps", dump("pp pp pp\n-10 10\n-10 10\n-10 10", "id type xs ys zs\n2 1 0.6 0.1 0.1\n1 2 0.1 0.1 0.1")),
        ("dump.lammps", dump("pp pp pp\n0 20\n0 20\n0 20", "id element x y z\n1 B 2 2 2\n2 A 12 2 2")),
    ] {
        let (rows, said) = started(name, &text, &TWO).unwrap_or_else(|e| panic!("{e}: {text}"));
        assert!(
            rows.iter().flatten().zip(expected.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-12),
            "{rows:?} {text}"
        );
        assert!(said.starts_with("2 particles of "), "{said}");
    }
}

fn dump(bounds: &str, atoms: &str) -> String {
    let count = atoms.lines().count() - 1;
    format!("ITEM: TIMESTEP\n50\nITEM: NUMBER OF ATOMS\n{count}\nITEM: BOX BOUNDS {bounds}\nITEM: ATOMS {atoms}\n")
}

#[test]
fn what_contradicts_the_species_of_a_scene_is_refused() {
    let message = |name: &str, text: &str| started(name, text, &TWO).unwrap_err();
    let both = "species A, C, but those of the scene are A, B";
    assert!(message("a.csv", "x,y,z,species\n2,2,2,A\n12,2,2,C\n").contains(both));
    assert!(message("a.xyz", "2\nProperties=species:S:1:pos:R:3\nA 2 2 2\nC 12 2 2\n").contains(both));
    assert!(message("a.xyz", "2\nplain\nA 2 2 2\nC 12 2 2\n").contains(both));
    let radius = "particle 1 has the radius 1, but the radius of species \"B\" is 2 in the scene";
    assert!(message("a.csv", "x,y,z,species,radius\n2,2,2,A,1\n12,2,2,B,1\n").contains(radius));
    assert!(
        message("a.csv", "x,y,z,radius\n2,2,2,1\n12,2,2,3\n")
            .contains("radius 3, but the radii of the scene's species")
    );
    assert!(message("a.csv", "x,y,z,species\n2,2,2,A\n12,2,2,A\n").contains("has 2 spheres of species \"A\""));
    assert!(message("a.csv", "x,y,z,id\n2,2,2,7\n12,2,2,7\n").contains("have the id 7"));
    assert!(message("a.csv", "x,y,z\n2,2,2\n").contains("has 1 positions, but the scene counts 2"));
    assert!(
        started("a.csv", "x,y,z,radius\n2,2,2,1.5\n", &[("A", 1.0, 1)]).unwrap_err().contains("has the radius 1.5")
    );
}

#[test]
fn rows_without_species_go_by_order_and_that_is_said() {
    let (rows, said) = started("a.csv", "x,y,z\n2,2,2\n12,2,2\n", &TWO).unwrap();
    assert_eq!(rows, [[2.0, 2.0, 2.0, 0.0], [12.0, 2.0, 2.0, 1.0]]);
    assert!(said.contains("it has no species; rows are of those of the scene by their order"), "{said}");
    let (_, said) = started("a.xyz", "2\n\nX 2 2 2\nX 12 2 2\n", &TWO).unwrap();
    assert!(said.contains("its names X are not those of the scene"), "{said}");
}

#[test]
fn the_box_of_a_file_is_that_of_the_scene_or_refused_with_both() {
    let of = |vectors: &str, edges: &str, flow: &str| {
        let folder = tempfile::tempdir().unwrap();
        let text = format!("1\nLattice=\"{vectors}\" Properties=pos:R:3\n1 2 3\n");
        std::fs::write(folder.path().join("a.xyz"), text).unwrap();
        let scene = scene(folder.path(), "a.xyz", edges, flow, &[("A", 1.0, 1)])?;
        let (scene, _) = with_start_file(scene, &Comm::alone()).map_err(|e| e.to_string())?;
        let simulation = start(&scene, &Comm::alone(), &mut |_| ()).map_err(|e| in_full(&e))?;
        let cell = simulation.frame().cell;
        Ok::<_, String>((cell.edges(), cell.strain()))
    };
    let (shear, ten) = ("[flow]\nkind = 'shear'\nrate = 1.0", Vector::splat(10.0));
    let tilted = "10 0 0 2.5 10 0 0 0 10";
    assert_eq!(of("10 0 0 0 10 0 0 0 10", "edges = [10, 10, 10]", "").unwrap(), (ten, 0.0));
    assert_eq!(of(tilted, "edges = [10, 10, 10]", shear).unwrap(), (ten, 0.25));
    assert_eq!(of(tilted, "edges = [10, 10, 10]", "").unwrap(), (ten, 0.25));
    assert_eq!(of(tilted, "", shear).unwrap(), (ten, 0.25), "the scene leaves the box out");
    assert_eq!(of(tilted, "edges = [10, 10, 10]\nstrain = 1.25", "").unwrap(), (ten, 0.25));
    let message = of("20 0 0 0 20 0 0 0 20", "edges = [10, 10, 10]", "").unwrap_err();
    assert!(message.contains("its box is 20 x 20 x 20, but that of the scene is 10 x 10 x 10"), "{message}");
    let message = of(tilted, "edges = [10, 10, 10]\nstrain = 0.3", "").unwrap_err();
    assert!(message.contains("its box has a strain of 0.25, but box.strain of the scene is 0.3"), "{message}");
    let straight = format!("{shear}\nlees_edwards = false");
    let message = of(tilted, "edges = [10, 10, 10]", &straight).unwrap_err();
    assert!(message.contains("box.strain is 0.25, but a box with a strain stays as it is"), "{message}");
    let walls = "edges = [10, 10, 10]\nboundaries = ['periodic', 'periodic', 'walls']";
    assert!(of(tilted, walls, "").unwrap_err().contains("10 x 10 x 10 with a strain of 0.25, but that of the scene"));
    assert!(of("10 0 0 0 10 0 1 0 10", "edges = [10, 10, 10]", "").unwrap_err().contains("(1, 0, 10)"));
}
