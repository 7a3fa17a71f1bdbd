//! Extended XYZ: for each frame the number of particles, a line of keys, and one line per particle.

use crate::trajectory_reader::TimedFrame;
use domain::{Column, Particles, PeriodicBox, Vector};
use simulation::Frame;
use std::io::{Result, Write};

pub(super) fn write(out: &mut impl Write, frames: &mut dyn Iterator<Item = TimedFrame>) -> Result<()> {
    for snapshot in frames {
        frame(out, &snapshot)?;
    }
    out.flush()
}

/// Writes numbers in the shortest form that reads back exactly.
fn frame(out: &mut impl Write, TimedFrame { step, time, frame }: &TimedFrame) -> Result<()> {
    let Frame { particles, cell, periodic } = frame;
    let lattice = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|steps| cell.lattice(steps).to_array());
    let lattice = lattice.as_flattened().iter().map(|number| format!("{number:?}")).collect::<Vec<_>>().join(" ");
    let [x, y, z] = periodic.map(|yes| if yes { 'T' } else { 'F' });
    writeln!(out, "{}", particles.len())?;
    write!(out, "Lattice=\"{lattice}\" {}Properties={} ", origin(cell), properties(particles))?;
    writeln!(out, "pbc=\"{x} {y} {z}\" Time={time:?} Step={step}")?;
    (0..particles.len()).try_for_each(|row| line(out, particles, row))
}

/// Origin of the box, if that is not at zero, in the form that OVITO reads.
fn origin(cell: &PeriodicBox) -> String {
    let Vector { x, y, z } = cell.origin();
    if cell.origin() == Vector::ZERO { String::new() } else { format!("Origin=\"{x:?} {y:?} {z:?}\" ") }
}

/// Columns of a frame. OVITO knows velocities as `velo`.
fn properties(particles: &Particles) -> String {
    let name = |column: &Column| if column.name == "velocity" { "velo" } else { &column.name }.to_owned();
    let columns = particles.columns.iter().map(|column| format!(":{}:R:{}", name(column), column.width));
    "species:I:1:pos:R:3:radius:R:1:id:I:1".to_owned() + &columns.collect::<String>()
}

fn line(out: &mut impl Write, particles: &Particles, row: usize) -> Result<()> {
    let [x, y, z] = particles.positions[row].to_array();
    write!(out, "{} {x:?} {y:?} {z:?} {:?} ", particles.species[row], particles.radii[row])?;
    write!(out, "{}", particles.ids[row])?;
    let columns = particles.columns.iter();
    let mut numbers = columns.flat_map(|column| numbers(column, row));
    numbers.try_for_each(|number| write!(out, " {number:?}"))?;
    writeln!(out)
}

/// Numbers of a particle: orientations as `x, y, z, w`, as OVITO reads them, and not rotated if there is none.
fn numbers(column: &Column, row: usize) -> Vec<f64> {
    let numbers = &column.values[row * column.width..][..column.width];
    match (column.name.as_str(), numbers) {
        ("orientation", [0.0, 0.0, 0.0, 0.0]) => vec![0.0, 0.0, 0.0, 1.0],
        ("orientation", &[w, x, y, z]) => vec![x, y, z, w],
        _ => numbers.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orientations_have_the_scalar_last() {
        let mut particles = Particles::default();
        particles.push(4, Vector::ZERO, 1.0, 0);
        particles.push(5, Vector::ZERO, 1.0, 0);
        particles.column("orientation", 4).values[..4].copy_from_slice(&[0.5, 0.1, 0.2, 0.3]);
        assert!(properties(&particles).ends_with(":orientation:R:4"));
        let line = |row: usize| {
            let mut out = Vec::new();
            super::line(&mut out, &particles, row).unwrap();
            String::from_utf8(out).unwrap()
        };
        assert!(line(0).ends_with(" 0.1 0.2 0.3 0.5\n") && line(1).ends_with(" 0.0 0.0 0.0 1.0\n"), "{}", line(0));
    }

    #[test]
    fn a_box_that_follows_particles_says_where_it_begins() {
        let cell = PeriodicBox::new(Vector::splat(2.0)).unwrap();
        let moved = cell.with_extent(Vector::new(-4.0, 0.0, 0.5), Vector::splat(2.0)).unwrap();
        let line = |cell: PeriodicBox| {
            let frame = Frame { particles: Particles::default(), cell, periodic: [false; 3] };
            let mut out = Vec::new();
            super::frame(&mut out, &TimedFrame { step: 3, time: 0.5, frame }).unwrap();
            String::from_utf8(out).unwrap().lines().nth(1).unwrap().to_owned()
        };
        assert!(line(moved).contains("2.0\" Origin=\"-4.0 0.0 0.5\" Properties="), "{}", line(moved));
        assert!(line(cell).contains("2.0\" Properties=") && line(cell).contains("pbc=\"F F F\""));
    }
}
