//! GSD files with the schema of HOOMD-blue (Glotzer group, <https://gsd.readthedocs.io>): version 2.0 of the format,
//! version 1.4 of the schema.

mod centred;
mod file;

use crate::trajectory_reader::TimedFrame;
use centred::Centred;
use domain::{Column, Particles, PeriodicBox, Quaternion, Traceless, Vector};
use file::{Chunk, GsdFile};
use simulation::Frame;
use std::borrow::Cow;
use std::io::{Result, Seek, Write};

/// Writes frames of particles whose species have these names.
pub(super) fn write(
    out: &mut (impl Write + Seek),
    species: &[String],
    frames: &mut dyn Iterator<Item = TimedFrame>,
) -> Result<()> {
    let mut file = GsdFile::begin(out)?;
    for (number, snapshot) in frames.enumerate() {
        let mut chunks = clock_and_box(&snapshot);
        chunks.extend(moving(&snapshot.frame));
        // Data that a later frame lacks are those of the first frame.
        if number == 0 {
            chunks.extend(fixed(&snapshot.frame.particles, species));
        }
        file.frame(&chunks)?;
    }
    file.end()
}

fn clock_and_box(TimedFrame { step, time, frame }: &TimedFrame) -> Vec<Chunk> {
    let (edges, [xz, yz]) = (frame.cell.edges(), frame.cell.tilts());
    let lengths_and_tilts = [edges.x, edges.y, edges.z, frame.cell.strain(), xz, yz];
    vec![
        Chunk::u64s("configuration/step", &[*step]),
        Chunk::f32s("configuration/box", 1, &lengths_and_tilts),
        Chunk::u32s("particles/N", &[frame.particles.len() as u32]),
        Chunk::f64s("log/time", &[*time]),
    ]
}

/// Chunks that are the same for all frames.
fn fixed(particles: &Particles, species: &[String]) -> Vec<Chunk> {
    let diameters: Vec<f64> = particles.radii.iter().map(|radius| 2.0 * radius).collect();
    vec![
        Chunk::names("particles/types", species),
        Chunk::u32s("particles/typeid", &particles.species),
        Chunk::f32s("particles/diameter", 1, &diameters),
    ]
}

fn moving(Frame { particles, cell, .. }: &Frame) -> Vec<Chunk> {
    let Centred { positions, images } = Centred::new(cell, particles);
    let mut chunks =
        vec![Chunk::f32s("particles/position", 3, positions.as_flattened()), Chunk::i32s("particles/image", &images)];
    for column in &particles.columns {
        let is_known = ["velocity", "orientation"].contains(&column.name.as_str());
        let name = if is_known { "particles/" } else { "log/particles/" }.to_owned() + &column.name;
        chunks.push(Chunk::f32s(&name, column.width, &along_axes(cell, column)));
    }
    chunks
}

/// Vectors, traceless tensors and orientations along the axes of the box, which the format requires of its boxes.
/// Particles without orientation are not rotated.
fn along_axes<'a>(cell: &PeriodicBox, column: &'a Column) -> Cow<'a, [f64]> {
    if column.name == "orientation" {
        let along = cell.axes().map_or(Quaternion::IDENTITY, |axes| Quaternion::of_matrix(&axes.transpose()));
        let rotated = |q: &Quaternion| if q.is_some() { along * *q } else { Quaternion::IDENTITY };
        let orientations: &[Quaternion] = bytemuck::cast_slice(&column.values);
        return orientations.iter().flat_map(|q| rotated(q).to_array()).collect();
    }
    let Some(axes) = cell.axes() else { return Cow::Borrowed(&column.values) };
    let along = axes.transpose();
    let turned = |values: &[f64]| match *values {
        [x, y, z] => (along * Vector::new(x, y, z)).to_array().to_vec(),
        [a, b, c, d, e] => Traceless::part_of(&(along * Traceless([a, b, c, d, e]).tensor() * *axes)).0.to_vec(),
        _ => values.to_vec(),
    };
    column.values.chunks_exact(column.width).flat_map(turned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rotation by 90 degrees together with the box: x becomes y.
    #[test]
    fn columns_turn_with_the_box() {
        let cell = PeriodicBox::of_lattice([Vector::Y * 2.0, Vector::X * -3.0, Vector::Z * 4.0]).unwrap();
        let column =
            |values: &[f64]| Column { name: "some".into(), width: values.len(), values: values.to_vec().into() };
        assert_eq!(along_axes(&cell, &column(&[1.0, 2.0, 3.0]))[..], [2.0, -1.0, 3.0]);
        // xx, xy, xz, yy, yz
        assert_eq!(along_axes(&cell, &column(&[1.0, 2.0, 3.0, 4.0, 5.0]))[..], [4.0, -2.0, 5.0, 1.0, -3.0]);
        let body = Quaternion::exp(Vector::new(0.3, 0.1, -0.5));
        let values = [body, Quaternion::NONE].map(Quaternion::to_array).concat();
        let rotated =
            along_axes(&cell, &Column { name: "orientation".into(), width: 4, values: values.into() }).into_owned();
        let expected = Vector::new(body.axis().y, -body.axis().x, body.axis().z);
        let found = Quaternion::from_array([rotated[0], rotated[1], rotated[2], rotated[3]]);
        assert!((found.axis() - expected).length() < 1e-14 && rotated[4..] == [1.0, 0.0, 0.0, 0.0]);
    }
}
