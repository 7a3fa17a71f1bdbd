use super::*;
use crate::plan::problem::Fixed;
use domain::Vector;

fn problem() -> Problem {
    Problem { fixed: on_card(), ..Problem::of_five_spheres() }
}

fn on_card() -> Fixed {
    Fixed { device: ComputeDevice::Gpu, ..Fixed::default() }
}

fn refusal(problem: &Problem) -> String {
    problem.check_for_gpu().unwrap_err().to_string()
}

/// With a card the plan is for it; without one there is a sentence that names the key.
#[test]
fn without_a_driver_there_is_one_sentence() {
    match (gpu::Cuda::check(), Plan::choose(&problem())) {
        (Ok(()), Ok(plan)) => {
            assert_eq!((plan.device, plan.method), (ComputeDevice::Gpu, Method::Split));
            assert!(plan.describe().contains("\ndevice     gpu\n"));
        }
        (Err(reason), Err(error)) => {
            let start = format!("hydrodynamics.device is \"gpu\", but {reason}");
            assert!(error.to_string().starts_with(&start), "{error}");
            assert!(error.to_string().ends_with("; leave it out, or write \"cpu\""), "{error}");
        }
        (card, plan) => panic!("{card:?}: {plan:?}"),
    }
}

#[test]
fn plans_for_the_host_do_not_name_a_device() {
    let plan = Plan::choose(&Problem { fixed: Fixed::default(), ..problem() }).unwrap();
    assert!(!plan.describe().contains("device") && plan.device == ComputeDevice::Cpu);
}

#[test]
fn problems_that_a_card_does_not_solve_are_refused() {
    assert_eq!(problem().check_for_gpu(), Ok(()));
    let dense = Fixed { method: Some(Method::Dense), ..on_card() };
    assert!(refusal(&Problem { fixed: dense, ..problem() }).contains("hydrodynamics.method is \"dense\""));
    for boundaries in [Boundaries::Open, Boundaries::Walls, Boundaries::Wall, Boundaries::OpenAlongZ] {
        assert_eq!(Problem { boundaries, ..problem() }.check_for_gpu(), Ok(()));
    }
    assert_eq!(Problem { ranks: 2, ..problem() }.check_for_gpu(), Ok(()));
    assert!(refusal(&Problem { edges: Vector::new(200.0, 8.0, 10.0), ..problem() }).contains("sixteen times"));
    let radii = (0..40).map(|i| (1.0 + 0.01 * f64::from(i), 1)).collect();
    assert!(refusal(&Problem { radii, ..problem() }).contains("40 different radii"));
}

#[test]
fn plans_without_tables_are_left_out() {
    let of_host = Fixed { method: Some(Method::Split), ..Fixed::default() };
    let near = Plan::choose(&Problem { fixed: of_host, ..problem() }).unwrap();
    let split = Some(crate::Split { width: 33.0, cutoff: 275.0 });
    let far = Plan { split, tolerance: 1e-4, ..near.clone() };
    let mut plans = vec![far.clone(), near.clone()];
    assert_eq!(problem().keep_evaluable(&mut plans), Ok(()));
    assert_eq!(plans, vec![near]);
    let error = problem().keep_evaluable(&mut vec![far]).unwrap_err().to_string();
    assert!(error.contains("beyond any table"), "{error}");
}

/// Pairs cost less on a card, relative to stencils and grids, so grids are coarser.
#[test]
fn a_card_has_costs_of_its_own() {
    let edge = 152.0;
    let spheres = Problem {
        edges: Vector::splat(edge),
        volume: edge.powi(3),
        shortest_vector: edge,
        radii: vec![(1.0, 100_000)],
        rigid: false,
        ..problem()
    };
    let best = |fixed: Fixed| {
        let plans = Problem { fixed, ..spheres.clone() }.candidates();
        plans.into_iter().min_by(|a, b| a.predicted_seconds.total_cmp(&b.predicted_seconds)).unwrap()
    };
    let [host, card] = [Fixed { method: Some(Method::Split), ..Fixed::default() }, on_card()].map(best);
    assert!(card.grid[0] < host.grid[0] && 20.0 * card.predicted_seconds < host.predicted_seconds, "{card:?} {host:?}");
}

#[test]
fn evaluations_that_do_not_fit_are_refused() {
    let shared = |bytes, [ranks, on_card]: [usize; 2]| CardMemory {
        card: DeviceInfo { name: "NVIDIA H200".to_owned(), identity: [7; 16], total_bytes: 150e9, free_bytes: 148e9 },
        bytes,
        ranks,
        on_card,
    };
    let memory = |bytes| shared(bytes, [1, 1]);
    assert_eq!(memory(1.2e9).check(), Ok(()));
    assert_eq!(memory(1.2e9).describe(), "NVIDIA H200, 148 GB free of 150 GB; the solve takes about 1.20 GB");
    let refusal = memory(200e9).check().unwrap_err().to_string();
    let reason = "the solve takes 200 GB of the card, and NVIDIA H200 has 148 GB free of 150 GB";
    assert!(refusal.starts_with(&format!("hydrodynamics.device is \"gpu\", but {reason}; ")), "{refusal}");
    assert_eq!(shared(80e9, [2, 1]).check(), Ok(()));
    let refusal = shared(80e9, [4, 2]).check().unwrap_err().to_string();
    assert!(refusal.contains("the solve takes 160 GB of the card of 2 ranks, and NVIDIA H200 has 148 GB"), "{refusal}");
    let [of_each, for_each] = [[2, 1], [4, 2]].map(|ranks| shared(1.2e9, ranks).describe());
    assert!(of_each.ends_with("; 2 ranks have a card each, of which the solve takes about 1.20 GB"), "{of_each}");
    assert!(for_each.ends_with("; 2 of 4 ranks share it, and the solve takes about 1.20 GB for each"), "{for_each}");
}

/// Ranks that have slabs are served; a grid of 18 planes has four of at least four planes.
#[test]
fn ranks_without_slabs_are_refused() {
    let of_host = Plan::choose(&Problem { fixed: Fixed::default(), ..problem() }).unwrap();
    let plan = Plan { device: ComputeDevice::Gpu, grid: [18, 20, 18], ..of_host };
    for ranks in [1, 2, 3, 4, 5, 7] {
        assert_eq!(plan.check_ranks(ranks), Ok(()), "{ranks}");
    }
    let refusal = plan.check_ranks(6).unwrap_err().to_string();
    assert!(refusal.contains("there are 6 ranks, and 5 GPUs at most share a grid of 18 planes"), "{refusal}");
    assert_eq!(Plan { device: ComputeDevice::Cpu, ..plan }.check_ranks(6), Ok(()));
}

/// Two cards have half of the grid each, and what they exchange.
#[test]
fn cards_share_the_memory_of_the_grid() {
    let plan = Plan::choose(&Problem { fixed: Fixed { method: Some(Method::Split), ..Fixed::default() }, ..problem() });
    let plan = Plan { grid: [128; 3], ..plan.unwrap() };
    let bytes = |ranks: usize| {
        let counts = CardCounts { owned: 0.0, present: 0.0, ranks };
        plan.size_on_card(counts, 0.0).bytes().lists
    };
    let value = if plan.precision == Precision::Single { 4.0 } else { 8.0 };
    let (field, spectrum) = (3.0 * value * 128.0_f64.powi(3), 6.0 * value * 65.0 * 128.0 * 128.0);
    // The memory of the field has as much as that of the spectrum, which is more, for the exchange.
    let saved = field + spectrum - 2.0 * (0.5 * spectrum);
    assert!((bytes(1) - bytes(2) - saved).abs() < 1.0, "{} bytes", bytes(1) - bytes(2));
}
