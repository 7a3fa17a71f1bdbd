//! The list against a brute-force search over all images.

use super::List;
use crate::disks::{DiskFlow, DiskModel, DiskParameters, Disks, Sizes};

/// Overlapping pairs as (id, id, overlap), by brute force.
fn all_overlaps(disks: &Disks) -> Vec<(u64, u64, f64)> {
    let seen = disks.snapshot();
    let cell = disks.model().cell(disks.law.strain(disks.clock.step()));
    let mut all = Vec::new();
    for (i, a) in seen.disks.iter().enumerate() {
        for b in &seen.disks[..i] {
            for steps in (-2..=2).flat_map(|x| (-2..=2).map(move |y| [x, y, 0])) {
                let d = (b.position - a.position) + cell.lattice(steps).truncate();
                if d.length() < a.radius + b.radius {
                    all.push((b.id, a.id, a.radius + b.radius - d.length()));
                }
            }
        }
    }
    all.sort_by(|a, b| a.partial_cmp(b).unwrap());
    all
}

/// Overlapping pairs from the list.
fn listed_overlaps(disks: &Disks) -> Vec<(u64, u64, f64)> {
    let (state, mut list) = (&disks.state, disks.list.clone());
    list.move_images(&disks.law, disks.clock.step());
    let mut all = Vec::new();
    for batch in list.batches() {
        for pair in &batch.pairs {
            let (i, j) = (pair.i as usize, pair.j as usize);
            let distance = (state.bodies[j].position - state.bodies[i].position + batch.image.shift).length();
            if distance < pair.contact_distance {
                let (a, b) = (state.identities[i].id, state.identities[j].id);
                all.push((a.min(b), a.max(b), pair.contact_distance - distance));
            }
        }
    }
    all.sort_by(|a, b| a.partial_cmp(b).unwrap());
    all
}

fn compare(parameters: DiskParameters, steps: u64, times: usize) {
    let mut disks = Disks::prepared(&DiskModel::new(parameters).unwrap()).unwrap();
    for _ in 0..times {
        disks.advance(steps);
        let (listed, all) = (listed_overlaps(&disks), all_overlaps(&disks));
        assert!(!all.is_empty() && listed.len() == all.len(), "step {}", disks.clock.step());
        for (l, a) in listed.iter().zip(&all) {
            assert!((l.0, l.1) == (a.0, a.1) && (l.2 - a.2).abs() < 1e-11);
        }
    }
}

#[test]
fn every_overlap_is_listed() {
    // 25 checks, 37 steps apart, at offsets of 0.28 L each: all over the cell, also just below L.
    let shear = DiskFlow::Shear { rate: 0.05 };
    compare(DiskParameters { edges: [40.0; 2], flow: shear, ..DiskParameters::default() }, 37, 25);
    let still =
        DiskParameters { edges: [70.0, 30.0], flow: DiskFlow::Shear { rate: -0.01 }, ..DiskParameters::default() };
    compare(DiskParameters { viscosity: 0.001, ..still }, 41, 25);
}

#[test]
fn so_it_is_for_a_spread_of_sizes_in_a_parabola() {
    let sizes = Sizes::Spread { smallest: 1.0, largest: 8.0, exponent: -3.0 };
    let flow = DiskFlow::Poiseuille { peak: 0.4 };
    compare(DiskParameters { edges: [50.0; 2], sizes, flow, ..DiskParameters::default() }, 23, 15);
}

#[test]
fn a_new_list_remembers_who_touched() {
    let mut disks =
        Disks::prepared(&DiskModel::new(DiskParameters { edges: [40.0; 2], ..DiskParameters::default() }).unwrap())
            .unwrap();
    disks.advance(500);
    let marked = |disks: &Disks, step: u64| {
        let touched = disks.list.batches().flat_map(|b| &b.touched);
        touched.filter(|&&last| last == step as u32).count()
    };
    let before = marked(&disks, disks.clock.step());
    let list = List::build(&mut disks.state, &disks.model, &disks.law, disks.clock.step() + 1, Some(&disks.list));
    disks.list = list;
    assert!(before > 50 && marked(&disks, disks.clock.step()) == before);
}
