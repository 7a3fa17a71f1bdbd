use super::*;
use crate::Grid;
use crate::fourier::tests::noise;
use domain::{Comm, PeriodicBox, Vector};
use num_complex::Complex;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

type Modes<T> = BTreeMap<[usize; 3], [Complex<T>; 3]>;

const TABLES: [[usize; 2]; 17] = [
    [1, 1],
    [1, 2],
    [2, 1],
    [1, 3],
    [3, 1],
    [2, 2],
    [4, 1],
    [1, 4],
    [7, 1],
    [1, 7],
    [2, 3],
    [3, 2],
    [1, 13],
    [13, 1],
    [4, 4],
    [8, 8],
    [1, 64],
];

fn noise_at([nx, ny, nz]: [usize; 3], component: usize, [x, y, z]: [usize; 3]) -> f64 {
    noise(((component * nz + z) * ny + y) * nx + x)
}

/// Writes the same noise on any number of ranks: values, and optionally halos.
fn fill<T: Real>(field: &mut Field<T, Physical>, with_halos: bool) {
    let points @ [nx, ..] = field.points();
    let halo = if with_halos { field.halo() } else { 0 };
    let [ys, zs] = field.rows();
    for component in 0..3 {
        for (y, z) in ys.clone().flat_map(|y| zs.clone().map(move |z| (y, z))) {
            for (x, value) in field.row_mut(component, y, z)[..nx + halo].iter_mut().enumerate() {
                *value = T::from_f64(noise_at(points, component, [x, y, z]));
            }
        }
    }
}

/// Coefficients that this rank has.
fn modes<T: Real>(field: &Field<T, Spectral>) -> Modes<T> {
    let mut modes = BTreeMap::new();
    field.for_each_mode(|mode, values| {
        assert!(modes.insert(mode, values).is_none(), "{mode:?} is there twice");
    });
    modes
}

/// Coefficients of the noise on a table of ranks, gathered, and the values after the backward transform.
fn on_ranks<T: Real>(points: [usize; 3], table: [usize; 2], halo: usize) -> (Modes<T>, BTreeMap<[usize; 2], Vec<T>>) {
    in_room(points, table, halo, ROOM)
}

/// The same in rounds with limited memory.
fn in_room<T: Real>(
    points: [usize; 3],
    table: [usize; 2],
    halo: usize,
    room: usize,
) -> (Modes<T>, BTreeMap<[usize; 2], Vec<T>>) {
    let shares = Comm::threads(table[0] * table[1], |comm| {
        let partition = Partition::with_table(&comm, [points[1], points[2]], table);
        let mut transform = Transform::<T>::planned(points, &partition, halo, room, AnyLength::new);
        let mut field = transform.field();
        fill(&mut field, true);
        let mut shown = BTreeMap::new();
        let push = |mut part: Vec<_>, mode, values| {
            part.push((mode, values));
            part
        };
        let parts = transform.fold_modes(&mut field.clone(), Vec::new, push);
        parts.concat().into_iter().for_each(|(mode, values)| assert!(shown.insert(mode, values).is_none()));
        let spectrum = transform.forward(field);
        let found = modes(&spectrum);
        assert!(found == shown, "modes are shown as they are kept");
        let field = transform.backward(spectrum);
        let [ys, zs] = field.rows();
        let lines = ys.flat_map(|y| zs.clone().map(move |z| [y, z]));
        let rows = lines.map(|[y, z]| ([y, z], (0..3).flat_map(|c| field.row(c, y, z).to_vec()).collect()));
        (found, rows.collect::<BTreeMap<_, Vec<T>>>())
    });
    let (mut all, mut rows) = (BTreeMap::new(), BTreeMap::new());
    for (found, back) in shares {
        for (mode, values) in found {
            assert!(all.insert(mode, values).is_none(), "two ranks own {mode:?}");
        }
        rows.extend(back);
    }
    (all, rows)
}

/// The defining sum of the transform, for noise with halos of two values.
fn slow(points: [usize; 3], halo: usize) -> Modes<f64> {
    let [nx, ny, nz] = points;
    let value = |component, [x, y, z]: [usize; 3]| {
        let beyond = if x < halo { noise_at(points, component, [x + nx, y, z]) } else { 0.0 };
        noise_at(points, component, [x, y, z]) + beyond
    };
    let all =
        |n: [usize; 3]| (0..n[2]).flat_map(move |z| (0..n[1]).flat_map(move |y| (0..n[0]).map(move |x| [x, y, z])));
    let count = nx * ny * nz;
    let roots: Vec<_> = (0..count).map(|i| Complex::from_polar(1.0, -TAU * (i as f64 / count as f64))).collect();
    let coefficient = |component: usize, mode: [usize; 3]| -> Complex<f64> {
        let turns = |x: [usize; 3]| (0..3).map(|a| mode[a] * x[a] * (count / points[a])).sum::<usize>() % count;
        all(points).map(|x| roots[turns(x)] * value(component, x)).sum()
    };
    all([nx / 2, ny, nz]).map(|mode| (mode, [0, 1, 2].map(|c| coefficient(c, mode)))).collect()
}

fn largest_error<T: Real>(found: &Modes<T>, exact: &Modes<f64>) -> f64 {
    assert!(found.keys().eq(exact.keys()), "every mode is somewhere");
    let error = |mode: &[usize; 3], c: usize| {
        let value = found[mode][c];
        (Complex::new(value.re.to_f64(), value.im.to_f64()) - exact[mode][c]).norm()
    };
    exact.keys().flat_map(|mode| (0..3).map(move |c| error(mode, c))).fold(0.0, f64::max)
}

#[test]
fn coefficients_are_the_sums_that_define_them() {
    for points in [[8, 6, 4], [4, 10, 14], [12, 2, 6], [2, 4, 2], [20, 6, 8], [22, 4, 6], [4, 26, 2], [2, 6, 34]] {
        let exact = slow(points, 2);
        let size = (points.iter().product::<usize>() as f64).sqrt();
        // A few roundings of sums that grow like the square root of the number of values.
        let error = largest_error(&on_ranks::<f64>(points, [1, 1], 2).0, &exact);
        assert!(error < 5e-15 * size, "{points:?}: {}", error / size);
        let error = largest_error(&on_ranks::<f32>(points, [1, 1], 2).0, &exact);
        assert!(error < 1e-6 * size, "{points:?}: {}", error / size);
    }
}

#[test]
fn ranks_in_any_table_have_the_bits_of_one_rank() {
    for points in [[36, 10, 12], [8, 6, 4], [70, 4, 18], [22, 26, 46], [106, 4, 22], [4, 34, 2]] {
        let one = on_ranks::<f64>(points, [1, 1], 3);
        for table in TABLES {
            assert!(on_ranks::<f64>(points, table, 3) == one, "{points:?} on {table:?} in double precision");
        }
        let one = on_ranks::<f32>(points, [1, 1], 3);
        for table in [[1, 7], [3, 2], [2, 2]] {
            assert!(on_ranks::<f32>(points, table, 3) == one, "{points:?} on {table:?} in single precision");
        }
    }
}

/// Rounds of one mode along y or of several, of which some ranks may have none, and a single round.
#[test]
fn rounds_have_the_bits_of_an_exchange_at_once() {
    for points in [[36, 10, 12], [8, 6, 4], [22, 26, 46]] {
        let one = on_ranks::<f64>(points, [1, 1], 3);
        for (table, room) in
            [[1, 1], [1, 2], [1, 3], [1, 4], [1, 7], [2, 2], [3, 2]].into_iter().zip([8, 3000, 9000].repeat(3))
        {
            assert!(in_room::<f64>(points, table, 3, room) == one, "{points:?} on {table:?} in {room} bytes");
        }
        assert!(in_room::<f32>(points, [1, 2], 3, 8) == on_ranks::<f32>(points, [1, 1], 3), "{points:?}");
    }
}

/// Application of an operator in rounds.
#[test]
fn operators_have_the_same_bits_in_rounds() {
    let (points, edges) = ([20, 14, 18], Vector::new(3.0, 2.0, 1.0));
    let applied = |table: [usize; 2], room: usize| {
        let shares = Comm::threads(table[0] * table[1], |comm| {
            let grid = Grid::new(points, PeriodicBox::new(edges).unwrap()).unwrap();
            let partition = Partition::with_table(&comm, grid.lines(), table);
            let mut transform = Transform::<f64>::planned(points, &partition, 5, room, AnyLength::new);
            let mut field = transform.field();
            fill(&mut field, true);
            transform.apply(&mut field, &Stokes::new(&grid, 1.5));
            let [ys, zs] = field.rows();
            let lines = ys.flat_map(|y| zs.clone().map(move |z| [y, z]));
            lines.map(|[y, z]| ([y, z], field.row(1, y, z).to_vec())).collect::<BTreeMap<_, _>>()
        });
        shares.into_iter().flatten().collect::<BTreeMap<_, _>>()
    };
    let one = applied([1, 1], ROOM);
    for (table, room) in [([1, 2], 8), ([1, 3], 9000), ([2, 2], 8), ([1, 4], ROOM)] {
        assert!(applied(table, room) == one, "on {table:?} in {room} bytes");
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    for points in [[48, 20, 18], [22, 34, 26]] {
        same_with_threads(points);
    }
}

fn same_with_threads(points: [usize; 3]) {
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let grid = Grid::new(points, PeriodicBox::new(Vector::new(3.0, 2.0, 1.0)).unwrap()).unwrap();
            let mut transform = Transform::<f64>::new(points, &Partition::new(&Comm::alone(), grid.lines()), 5);
            let mut field = transform.field();
            fill(&mut field, true);
            transform.apply(&mut field, &Stokes::new(&grid, 1.5));
            field.components().map(<[f64]>::to_vec)
        })
    };
    assert!(with_threads(1) == with_threads(2) && with_threads(1) == with_threads(5));
}

#[test]
fn there_and_back_is_the_field_without_the_highest_mode_of_x() {
    there_and_back([30, 12, 14]);
    there_and_back([22, 26, 34]);
    there_and_back([106, 46, 6]);
    there_and_back([6, 2, 194]);
}

fn there_and_back(points: [usize; 3]) {
    let [nx, ny, nz] = points;
    let mut transform = Transform::<f64>::new(points, &Partition::new(&Comm::alone(), [ny, nz]), 4);
    let mut field = transform.field();
    fill(&mut field, false);
    let before = field.to_vec();
    let spectrum = transform.forward(field);
    let field = transform.backward(spectrum);
    for (before, after) in before.chunks(nx).zip(field.to_vec().chunks(nx)) {
        let zigzag = |x: usize| if x.is_multiple_of(2) { 1.0 } else { -1.0 };
        let highest = before.iter().enumerate().map(|(x, v)| zigzag(x) * v).sum::<f64>() / nx as f64;
        for x in 0..nx {
            let expected = before[x] - zigzag(x) * highest;
            assert!((after[x] / (nx * ny * nz) as f64 - expected).abs() < 1e-14);
        }
    }
}

#[test]
fn halos_go_around() {
    halo_goes_around(7);
    halo_goes_around(27);
}

fn halo_goes_around(halo: usize) {
    let points = [10, 4, 6];
    let mut transform = Transform::<f64>::new(points, &Partition::new(&Comm::alone(), [4, 6]), halo);
    let [mut folded, mut beyond] = [transform.field(), transform.field()];
    fill(&mut beyond, true);
    fill(&mut folded, true);
    folded.fold_halo();
    assert!(folded.row(1, 2, 3)[10..].iter().all(|&v| v == 0.0));
    assert!(modes(&transform.forward(folded)) == modes(&transform.forward(beyond.clone())));
    let spectrum = transform.forward(beyond);
    let mut back = transform.backward(spectrum);
    let row = back.row(2, 1, 5);
    assert!(row[10..].chunks(10).all(|turn| *turn == row[..turn.len()]));
    let copied = back.row(0, 0, 0).to_vec();
    back.clear_halo();
    assert_eq!(back.row(0, 0, 0)[10..], vec![0.0; halo]);
    back.fill_halo();
    assert_eq!(back.row(0, 0, 0), copied);
    back.clear();
    assert!(back.to_vec().iter().all(|&v| v == 0.0));
}

#[test]
fn tiles_have_each_row_once() {
    Comm::threads(3, |comm| {
        let transform = Transform::<f32>::new([6, 10, 8], &Partition::new(&comm, [10, 8]), 2);
        let mut field = transform.field();
        let [ys, zs] = field.rows();
        let tiles = field.tiles([4, 2]);
        assert_eq!(tiles.len(), ys.len().div_ceil(4) * zs.len().div_ceil(2));
        for (number, mut tile) in tiles.into_iter().enumerate() {
            let [ys, zs] = tile.rows();
            for (y, z) in ys.flat_map(|y| zs.clone().map(move |z| (y, z))) {
                for (c, row) in tile.rows_mut(y, z).into_iter().enumerate() {
                    row.fill(number as f32 + 1.0 + 100.0 * c as f32);
                }
            }
        }
        let tiles_along_y = ys.len().div_ceil(4);
        for (y, z) in ys.clone().flat_map(|y| zs.clone().map(move |z| (y, z))) {
            let number = (z - zs.start) / 2 * tiles_along_y + (y - ys.start) / 4;
            for c in 0..3 {
                assert_eq!(field.row(c, y, z), [number as f32 + 1.0 + 100.0 * c as f32; 8]);
            }
        }
    });
}

#[test]
#[should_panic(expected = "the partition shares out the lines of this grid")]
fn a_partition_of_another_grid_is_refused() {
    let _ = Transform::<f64>::new([8, 6, 4], &Partition::new(&Comm::alone(), [4, 6]), 0);
}

#[test]
#[should_panic(expected = "row (5, 0) is another rank's")]
fn rows_of_other_ranks_are_refused() {
    let field = Transform::<f64>::new([8, 4, 4], &Partition::new(&Comm::alone(), [4, 4]), 0).field();
    let _ = field.row(0, 5, 0);
}
