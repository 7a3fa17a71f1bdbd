//! Bonds and traps at the start of a run.

use super::beam_ends;
use super::traps::{TRAP_NUMBERS, TRAPS};
use crate::columns::{BEAM_ENDS, BOND_NUMBERS, BONDS, ORIENTATION};
use crate::model::{Centres, Model, check_ids};
use domain::{DomainView, Failure, Number, Particles, PeriodicBox, Vector};

/// Columns of bonds and traps of all particles.
struct Columns {
    ids: Vec<u64>,
    bonds: Vec<f64>,
    beam_ends: Vec<f64>,
    traps: Vec<f64>,
}

/// Fills the columns of bonds and traps from the initial positions. Refuses unknown ids, and bonds as long as half of
/// the box. Collective.
pub fn tie(
    particles: &mut Particles,
    model: &Model,
    DomainView { cell, partition }: DomainView,
) -> Result<(), Failure> {
    if model.bonds.is_empty() && model.traps.is_empty() {
        return Ok(());
    }
    let comm = partition.comm();
    let all = particles.gathered_with(partition, |name| name == ORIENTATION);
    let columns = if comm.is_first() { of_all(&all, model, cell) } else { Ok(Columns::none()) };
    let mut columns = comm.agree(columns)?;
    comm.broadcast(&mut columns.ids);
    for (name, values, width) in [
        (BONDS, &mut columns.bonds, model.bond_numbers()),
        (BEAM_ENDS, &mut columns.beam_ends, model.beam_end_numbers()),
        (TRAPS, &mut columns.traps, TRAP_NUMBERS),
    ] {
        comm.broadcast(values);
        if values.is_empty() {
            continue;
        }
        let rows: Vec<usize> = particles
            .ids
            .iter()
            .map(|id| columns.ids.binary_search(id).expect("every particle was gathered"))
            .collect();
        let column = particles.column(name, width);
        for (own, row) in column.values.chunks_exact_mut(width).zip(rows) {
            own.copy_from_slice(&values[width * row..][..width]);
        }
    }
    Ok(())
}

/// Refuses particles of a saved state whose columns do not match the bonds and traps of the model.
pub fn check(particles: &Particles, model: &Model) -> Result<(), String> {
    let wanted = [
        (BONDS, model.bond_numbers(), "bonds"),
        (BEAM_ENDS, model.beam_end_numbers(), "bonds"),
        (TRAPS, if model.traps.is_empty() { 0 } else { TRAP_NUMBERS }, "traps"),
    ];
    for (name, width, key) in wanted {
        let found = particles.columns.iter().find(|column| column.name == name).map_or(0, |column| column.width);
        if found != width {
            return Err(format!("the state has other {key} than the scene; start a new run to change [[{key}]]"));
        }
    }
    Ok(())
}

impl Columns {
    fn none() -> Self {
        Self { ids: Vec::new(), bonds: Vec::new(), beam_ends: Vec::new(), traps: Vec::new() }
    }
}

fn of_all(all: &Particles, model: &Model, cell: &PeriodicBox) -> Result<Columns, String> {
    let count = all.len() as u64;
    check_ids(&model.bonds, count).map_err(|e| e.to_string())?;
    let bonds = bonds(all, model, cell)?;
    let beam_ends = beam_ends::of_all(all, &bonds, model, cell)?;
    let traps = if model.traps.is_empty() { Vec::new() } else { traps(all, model, cell)? };
    Ok(Columns { ids: all.ids.clone(), bonds, beam_ends, traps })
}

fn bonds(all: &Particles, model: &Model, cell: &PeriodicBox) -> Result<Vec<f64>, String> {
    let width = model.bond_numbers();
    let mut values = vec![0.0; width * all.len()];
    let half = 0.5 * model.shortest_vector();
    for (kind, bonds) in model.bonds.iter().enumerate() {
        for (row, &[first, second]) in bonds.pairs.iter().enumerate() {
            let [i, j] = [first, second].map(|id| id as usize);
            let distance = cell.nearest_image(all.positions[j] - all.positions[i]).length();
            if distance >= half {
                return Err(format!(
                    "bonds[{kind}].pairs[{row}] bonds spheres {first} and {second}, which are {:.4} apart at the \
                     start; a bond needs to be shorter than half of the box's shortest edge, {half:.4}",
                    Number(distance)
                ));
            }
            let length = bonds.length.unwrap_or(distance);
            for (own, other) in [(i, second), (j, first)] {
                let mut slots = values[width * own..][..width].as_chunks_mut::<BOND_NUMBERS>().0.iter_mut();
                let slot = slots.find(|slot| slot[0] == 0.0).expect("as many slots as a sphere has bonds");
                *slot = [(other + 1) as f64, length, (kind + 1) as f64];
            }
        }
    }
    Ok(values)
}

/// The trap of each particle, at the image of the centre that is nearest to the particle.
fn traps(all: &Particles, model: &Model, cell: &PeriodicBox) -> Result<Vec<f64>, String> {
    let mut values = vec![0.0; TRAP_NUMBERS * all.len()];
    for (kind, traps) in model.traps.iter().enumerate() {
        traps.check_ids(kind, all.len() as u64).map_err(|e| e.to_string())?;
        for (row, numbers) in values.as_chunks_mut::<TRAP_NUMBERS>().0.iter_mut().enumerate() {
            let Some(place) = traps.place_of(all.ids[row], all.species[row]) else { continue };
            if numbers[3] != 0.0 {
                return Err(format!(
                    "traps[{kind}] hold sphere {}, as others do already; it can be in one trap",
                    all.ids[row]
                ));
            }
            let start = all.positions[row] + cell.lattice(all.steps[row]);
            let to_centre = |centre: Vector| cell.nearest_image(centre - start);
            let centre = match &traps.centres {
                Centres::AtStart => start,
                Centres::One(centre) => start + to_centre(*centre),
                Centres::Each(list) => start + to_centre(list[place]),
            };
            numbers[..3].copy_from_slice(&centre.to_array());
            numbers[3] = (kind + 1) as f64;
        }
    }
    Ok(values)
}
