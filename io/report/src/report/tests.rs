use super::*;
use domain::{Particles, PeriodicBox, Vector};
use files::{Manifest, Provenance, Series, Trajectory, write_contacts, write_tables};
use simulation::{ContactForce, ContactForces, ContactState, Frame, Quantity, Table};

const SCENE: &str = r#"
title = "<script>alert('a & b')</script>"
[box]
edges = [8.0, 8.0, 8.0]
[fluid]
viscosity = 1.0
[[species]]
name = "</script><b>"
radius = 0.5
count = 2
force = [0.0, 0.0, -1.0]
[time]
step = 0.1
steps = 20
[output]
trajectory_every = 10
observables_every = 10
"#;

fn provenance() -> Provenance {
    Provenance { scene: SCENE.into(), program: "test 1".into(), plan: "method <x>".into(), ranks: 2, seed: 7 }
}

/// Writes rows of a mean velocity and of the smallest gap at steps 0, 10, ...
fn add_series(folder: &Path, gaps: &[f64]) {
    let mean = Quantity::vectors("mean_velocity", "length/time", &["</script><b>".into()]);
    let quantities = [mean, Quantity::number("smallest_gap", "length")];
    let mut series = Series::create(&Manifest::none(folder), &provenance(), &quantities, gaps.len() as u64).unwrap();
    for (k, &gap) in gaps.iter().enumerate() {
        let values = [vec![0.0, f64::NAN, -0.5 * k as f64], vec![gap]];
        series.append((10 * k as u64, k as f64), &values).unwrap();
    }
}

fn add_trajectory(folder: &Path) {
    let mut particles = Particles::default();
    particles.push(0, Vector::ONE, 0.5, 0);
    particles.push(1, Vector::splat(4.0), 0.5, 0);
    let cell = PeriodicBox::new(Vector::splat(8.0)).unwrap();
    let frame = Frame { particles, cell, periodic: [true; 3] };
    let mut trajectory = Trajectory::create(&folder.join("trajectory.h5"), &provenance(), &frame, 2).unwrap();
    (0..2).for_each(|k| trajectory.append((10 * k, k as f64), &frame).unwrap());
}

fn report(folder: &Path) -> Result<String, String> {
    let out = folder.join("report.html");
    write_report(folder, &out).map_err(|e| e.to_string())?;
    Ok(std::fs::read_to_string(out).unwrap())
}

/// Element ids, by which the player finds elements, are unique.
#[test]
fn forces_of_contacts_can_be_shown() {
    let folder = tempfile::tempdir().unwrap();
    add_trajectory(folder.path());
    assert!(!report(folder.path()).unwrap().contains("show-chains\" type"));
    let contact = ContactForce {
        ids: [0, 1],
        position: Vector::ONE,
        separation: Vector::splat(3.0),
        normal: 1.0,
        tangential: Vector::ZERO,
        state: ContactState::Bond,
    };
    let lattice = [Vector::X * 8.0, Vector::Y * 8.0, Vector::Z * 8.0];
    let contacts = ContactForces { step: 10, time: 1.0, lattice, list: vec![contact] };
    write_contacts(&contacts, &Manifest::none(folder.path()), &provenance()).unwrap();
    let page = report(folder.path()).unwrap();
    let mut names: Vec<&str> = page.split(" id=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    names.sort_unstable();
    for name in ["chains", "show-chains", "widths"] {
        assert!(names.contains(&name), "{names:?}");
    }
    assert!(names.windows(2).all(|two| two[0] != two[1]), "{names:?}");
}

#[test]
fn a_page_tells_what_was_run() {
    let folder = tempfile::tempdir().unwrap();
    add_trajectory(folder.path());
    add_series(folder.path(), &[0.1, -0.02, 0.3]);
    let page = report(folder.path()).unwrap();
    for words in [
        "<dt>kind</dt><dd>suspension</dd>",
        "2 spheres of radius 0.5",
        "<dt>box</dt><dd>8 \u{d7} 8 \u{d7} 8, periodic along x, y, z</dd>",
        "<dt>steps</dt><dd>20 of 20</dd>",
        "<dt>made by</dt><dd>test 1 on 2 ranks</dd>",
        "<dt>seed</dt><dd>7</dd>",
        "Spheres overlap in 1 of 3 rows of the time series, by 0.02 at most.",
        "Mean velocity along z",
        "Smallest gap between surfaces",
        "method &lt;x&gt;",
        "trajectory_every = 10",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert!(!page.contains("not finished"));
}

#[test]
fn text_of_a_scene_is_no_part_of_the_page() {
    let folder = tempfile::tempdir().unwrap();
    add_trajectory(folder.path());
    add_series(folder.path(), &[0.1]);
    let page = report(folder.path()).unwrap();
    assert!(page.contains("<h1>&lt;script&gt;alert(&#39;a &amp; b&#39;)&lt;/script&gt;</h1>"));
    assert!(!page.contains("alert('a") && !page.contains("</script><b>"));
    assert_eq!(page.matches("<script").count(), page.matches("</script>").count());
    assert!(page.contains("\"names\":[\"\\u003c/script>\\u003cb>\"]"), "the player has the name");
    let before = page.split("<script>\n").next().unwrap();
    assert!(!before.contains("://") && !before.contains("src="), "it asks nothing of a network");
}

#[test]
fn what_is_not_there_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    add_series(folder.path(), &[0.1, 0.2]);
    let page = report(folder.path()).unwrap();
    assert!(page.contains("The run is not finished: its results end at step 10 of 20."));
    assert!(page.contains("<svg") && !page.contains("id=\"picture\"") && !page.contains("<script"));
}

#[test]
fn tables_of_solutions_are_a_report() {
    let folder = tempfile::tempdir().unwrap();
    let mut summary = Table::new("summary", &[], &[("speed", "length/time"), ("slip", "length/time"), ("dilute", "")]);
    summary.add(&[], &[1.5, 0.25, 1.0]);
    write_tables(folder.path(), "solution", &provenance(), &[summary], &Manifest::none(folder.path())).unwrap();
    let page = report(folder.path()).unwrap();
    assert!(page.contains("<th>speed (length/time)</th>") && page.contains("<td>1.5</td>"), "{page}");
    assert!(page.contains("1 of 1 solutions are dilute."));
}

#[test]
fn statistics_are_charts_and_a_table() {
    let folder = tempfile::tempdir().unwrap();
    add_series(folder.path(), &[0.1]);
    let mut pairs = Table::new("pairs", &["first", "second"], &[("distance", "length"), ("g", "")]);
    pairs.add(&["a", "b"], &[1.0, 0.5]);
    pairs.add(&["a", "b"], &[2.0, 1.0]);
    let labels = &["quantity", "species", "unit"];
    let mut summary = Table::new("summary", labels, &[("value", ""), ("error", ""), ("converged", "")]);
    summary.add(&["T_xx", "a", "length^2/time^2"], &[0.5, 0.01, 0.0]);
    summary.add(&["D_slope_x", "a", "length^2/time"], &[f64::NAN, f64::NAN, 1.0]);
    write_tables(
        &folder.path().join("stats"),
        "statistics",
        &provenance(),
        &[pairs, summary],
        &Manifest::none(folder.path()),
    )
    .unwrap();
    let page = report(folder.path()).unwrap();
    assert!(page.contains(">a and b</text>") && page.contains("distance of centres (length)"));
    let row = "<td>T_xx</td><td>a</td><td>0.5</td><td>\u{b1} 0.01 at least</td><td>length\u{b2}/time\u{b2}</td>";
    assert!(page.contains(row) && page.contains("<td>unknown</td><td></td>"), "{page}");
    // Both points, from margin to margin of the plot area.
    assert!(page.contains("d=\"M82.2 270.8L487.8 41.2\""), "{page}");
}

#[test]
fn displacements_of_the_species_are_drawn_without_their_mean() {
    let folder = tempfile::tempdir().unwrap();
    add_series(folder.path(), &[0.1]);
    let names = [("time", "time"), ("displacement_x", ""), ("displacement_y", ""), ("displacement_z", "")];
    let drawn = |species: &[&str]| {
        let mut lags = Table::new("lags", &["species"], &names);
        for of in species {
            for time in [1.0, 2.0] {
                lags.add(&[of], &[time; 4]);
            }
        }
        write_tables(
            &folder.path().join("stats"),
            "statistics",
            &provenance(),
            &[lags],
            &Manifest::none(folder.path()),
        )
        .unwrap();
        let page = report(folder.path()).unwrap();
        let chart = page.split("<svg").find(|svg| svg.contains("mean square displacement")).unwrap();
        let chart = chart.split("</svg>").next().unwrap();
        (chart.contains(">all"), chart.matches("class=\"line\"").count())
    };
    assert_eq!(drawn(&["a", "b", "all"]), drawn(&["a", "b"]));
    assert_ne!(drawn(&["all"]).1, 0);
}

#[test]
fn stresses_on_walls_are_a_table() {
    let folder = tempfile::tempdir().unwrap();
    add_series(folder.path(), &[0.1]);
    let mut walls = Table::new("walls", &["wall"], &[("normal", "force/length"), ("normal_error", "force/length")]);
    walls.add(&["lower"], &[2.5, 0.125]);
    write_tables(folder.path(), "averages", &provenance(), &[walls], &Manifest::none(folder.path())).unwrap();
    let page = report(folder.path()).unwrap();
    assert!(page.contains("Stresses on the walls") && page.contains("<td>lower</td><td>2.5</td><td>0.125</td>"));
}

#[test]
fn a_column_of_a_table_in_time_is_that_of_its_row() {
    let folder = tempfile::tempdir().unwrap();
    let mean = Quantity::vectors("mean_velocity", "length/time", &["a".into(), "b".into()]);
    let mut series = Series::create(&Manifest::none(folder.path()), &provenance(), &[mean], 2).unwrap();
    for k in [0.0, 10.0] {
        let values: Vec<f64> = (0..6).map(|n| k + f64::from(n)).collect();
        series.append((k as u64, k), &[values]).unwrap();
    }
    drop(series);
    let read = Observables::read(&folder.path().join("observables.h5")).unwrap().unwrap();
    let mean = read.get("mean_velocity").unwrap();
    assert_eq!(mean.column(1, 2).collect::<Vec<_>>(), [5.0, 15.0]);
    assert_eq!(mean.column(0, 1).collect::<Vec<_>>(), [1.0, 11.0]);
}

#[test]
fn a_folder_without_a_run_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let name = folder.path().display().to_string();
    let expected = format!("{name} holds no run: it has no scene.toml and no results; name the folder of a run");
    assert_eq!(report(folder.path()), Err(expected));
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    assert!(report(folder.path()).unwrap_err().starts_with(&format!("{name} has a scene, but no results to report")));
}

#[test]
fn damage_names_its_file() {
    for name in ["trajectory.h5", "observables.h5"] {
        let folder = tempfile::tempdir().unwrap();
        add_trajectory(folder.path());
        add_series(folder.path(), &[0.1]);
        let path = folder.path().join(name);
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() / 3]).unwrap();
        let error = report(folder.path()).unwrap_err();
        assert!(error.contains(&format!("{name} is damaged: ")), "{error}");
        assert!(!folder.path().join("report.html").exists());
    }
}

#[test]
fn damaged_rows_are_left_out_and_named() {
    let folder = tempfile::tempdir().unwrap();
    add_series(folder.path(), &[0.1, 0.123456, 0.3]);
    let path = folder.path().join("observables.h5");
    let mut bytes = std::fs::read(&path).unwrap();
    let place = bytes.windows(8).position(|bytes| bytes == 0.123456_f64.to_le_bytes()).unwrap();
    bytes[place] ^= 1;
    std::fs::write(&path, bytes).unwrap();
    let page = report(folder.path()).unwrap();
    let words = "Left out of observables.h5: frame 1 does not fit its checksums: observables/smallest_gap.";
    assert!(page.contains(words));
    let series = Observables::read(&path).unwrap().unwrap();
    assert_eq!(series.line("smallest_gap").unwrap().1, [[0.0, 0.1], [2.0, 0.3]]);
}

#[test]
fn a_place_that_is_no_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    add_series(folder.path(), &[0.1]);
    let error = write_report(folder.path(), folder.path()).unwrap_err().to_string();
    assert!(error.contains("it is no file"), "{error}");
}

#[test]
fn names_with_commas_are_those_of_one_species() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE.replace("</script><b>", "silica, 2 um")).unwrap();
    let mean = Quantity::vectors("mean_velocity", "length/time", &["silica, 2 um".into()]);
    let mut series = Series::create(&Manifest::none(folder.path()), &provenance(), &[mean], 2).unwrap();
    for step in 0..2 {
        series.append((step, step as f64), &[vec![0.0, 0.0, -1.0]]).unwrap();
    }
    drop(series);
    assert!(report(folder.path()).unwrap().contains("silica, 2 um"));
}
