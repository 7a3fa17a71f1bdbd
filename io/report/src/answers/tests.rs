use super::*;
use domain::Random;
use scene::Template;
use statistics::Verdict;
use std::fmt::Write as _;
use tempfile::TempDir;

/// The folder of a run with a time series of some columns, in steps of `step`, of functions of the time.
fn series(step: f64, rows: u32, columns: &[(&str, &dyn Fn(f64) -> f64)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let names: Vec<&str> = columns.iter().map(|column| column.0).collect();
    let mut csv = format!("step,time,{}\n", names.join(","));
    for row in 0..rows {
        let time = f64::from(row) * step;
        let numbers: Vec<String> = columns.iter().map(|(_, of)| format!("{:?}", of(time))).collect();
        writeln!(csv, "{row},{time:?},{}", numbers.join(",")).unwrap();
    }
    std::fs::write(folder.path().join("observables.csv"), csv).unwrap();
    folder
}

/// White noise that is the same at the same time.
fn noise(time: f64, name: u64) -> f64 {
    Random::new(time.to_bits(), name).normal()[0]
}

/// The answers of a scene that comes with the program, with some keys set.
fn answers(name: &str, sets: &[&str], folder: &TempDir) -> Vec<RunAnswer> {
    let sets: Vec<String> = sets.iter().map(|&set| set.to_owned()).collect();
    let scene = Scene::parse(Template::named(name).unwrap().text, "scene.toml", &sets).unwrap();
    run_answers(folder.path(), &scene, &AnswerRange::of_scene(&scene)).unwrap()
}

fn get<'a>(answers: &'a [RunAnswer], quantity: &str, species: &str) -> &'a RunAnswer {
    let is_it = |answer: &&RunAnswer| answer.quantity == quantity && answer.species == species;
    answers.iter().find(is_it).unwrap_or_else(|| panic!("no {quantity} of {species} in {answers:#?}"))
}

/// The value of an answer, which is within three errors of the right one.
fn is_near(answer: &RunAnswer, expected: f64) {
    let (value, error) = (answer.mean.value, answer.mean.error);
    assert!((value - expected).abs() < 3.0 * error + 1e-9 * expected.abs(), "{answer:#?}, not {expected}");
}

#[test]
fn a_shear_flow_is_answered_by_its_stress_after_one_transient() {
    let folder = series(
        0.1,
        400,
        &[
            ("relative_viscosity", &|time| 5.0 + 0.2 * noise(time, 0)),
            ("first_normal_stress_difference", &|time| -0.4 + 0.2 * noise(time, 1)),
            ("second_normal_stress_difference", &|time| -1.0 + 0.2 * noise(time, 2)),
            ("particle_pressure", &|time| if time < 9.95 { 30.0 } else { 2.0 + 0.2 * noise(time, 3) }),
            ("segregation", &|_| f64::NAN),
        ],
    );
    let found = answers("shear", &["flow.rate=2.0", "fluid.viscosity=0.25"], &folder);
    is_near(get(&found, "relative_viscosity", "all"), 5.0);
    for (quantity, expected) in [
        ("first_normal_stress_difference", -0.4),
        ("second_normal_stress_difference", -1.0),
        ("particle_pressure", 2.0),
    ] {
        is_near(get(&found, quantity, "all"), expected);
        is_near(get(&found, &format!("reduced_{quantity}"), "all"), expected / 0.5);
    }
    let of_stress = found.iter().filter(|answer| answer.quantity != "segregation");
    assert!(
        of_stress.clone().count() == 7 && of_stress.clone().all(|answer| (answer.mean.transient - 10.0).abs() < 0.6)
    );
    assert!(of_stress.clone().all(|answer| answer.mean.verdict == Verdict::Converged), "{found:#?}");
    let none = get(&found, "segregation", "all").mean;
    assert!(none.value.is_nan() && none.verdict == Verdict::Meaningless);
    let text = answers_in_lines(&found);
    assert!(text.contains("relative viscosity") && !text.contains("reduced") && text.lines().count() == 5, "{text}");
}

#[test]
fn means_are_taken_in_the_range_that_is_asked_for() {
    let folder = series(0.1, 400, &[("relative_viscosity", &|time| time.floor() + 0.01 * noise(time, 0))]);
    let scene = Scene::parse(Template::named("shear").unwrap().text, "scene.toml", &[]).unwrap();
    let range = AnswerRange { from: Some(20.0), until: 20.95 };
    let found = run_answers(folder.path(), &scene, &range).unwrap();
    is_near(&found[0], 20.0);
    assert!((found[0].mean.transient - 20.0).abs() < 1e-9);
}

#[test]
fn a_scene_says_from_when_means_are_taken() {
    let folder = series(0.1, 400, &[("relative_viscosity", &|time| time.floor() + 0.01 * noise(time, 0))]);
    let longer = ["time.duration=40.0"];
    let found = answers("shear", &longer, &folder);
    assert!(found[0].mean.transient < 39.0, "{found:#?}");
    let found = answers("shear", &[longer[0], "answers.from=39.0"], &folder);
    is_near(&found[0], 39.0);
    assert!((found[0].mean.transient - 39.0).abs() < 1e-9);
    // A time that is asked for goes before that of the scene.
    let sets = [longer[0], "answers.from=39.0"].map(str::to_owned);
    let scene = Scene::parse(Template::named("shear").unwrap().text, "scene.toml", &sets).unwrap();
    assert_eq!(AnswerRange::of_run(folder.path(), &scene), AnswerRange { from: Some(39.0), until: f64::INFINITY });
    let found = run_answers(folder.path(), &scene, &AnswerRange { from: Some(20.0), until: 20.95 }).unwrap();
    is_near(&found[0], 20.0);
}

#[test]
fn grains_take_means_from_the_time_of_the_scene() {
    for (name, column, quantity) in
        [("granular-disks", "segregation", "segregation"), ("shear-cell", "temperature", "granular_temperature")]
    {
        let scene = |sets: &[String]| Scene::parse(Template::named(name).unwrap().text, "scene.toml", sets).unwrap();
        let end = match scene(&[]).kind() {
            Kind::GranularDisks(scene) => scene.time.end(),
            Kind::ShearCell(scene) => scene.time.end(),
            _ => panic!("grains"),
        };
        let folder = series(end / 400.0, 400, &[(column, &|time| (8.0 * time / end).floor() + 0.01 * noise(time, 0))]);
        let scene = scene(&[format!("answers.from={:?}", 0.875 * end)]);
        let found = run_answers(folder.path(), &scene, &AnswerRange::of_scene(&scene)).unwrap();
        is_near(get(&found, quantity, "all"), 7.0);
    }
}

#[test]
fn a_reversed_flow_is_answered_after_its_reversal() {
    let of_time = |time: f64| if time <= 4.0 { 50.0 } else { 20.0 + noise(time, 0) };
    let folder = series(0.005, 1400, &[("relative_viscosity", &of_time)]);
    let found = answers("reversal", &[], &folder);
    is_near(&found[0], 20.0);
    assert!(found[0].mean.transient >= 4.0);
}

#[test]
fn under_a_stress_the_rate_and_the_viscosity_are_the_answers() {
    let folder = series(1.0, 400, &[("shear_rate", &|time| 0.01 + 0.001 * noise(time, 0))]);
    let found = answers("thickening", &[], &folder);
    is_near(get(&found, "shear_rate", "all"), 0.01);
    is_near(get(&found, "relative_viscosity", "all"), 25.0);
    let [rate, viscosity] = ["shear_rate", "relative_viscosity"].map(|name| get(&found, name, "all").mean);
    assert!((rate.error / rate.value / (viscosity.error / viscosity.value) - 1.0).abs() < 1e-12);
}

#[test]
fn extensions_have_an_extensional_viscosity() {
    let folder = series(0.1, 100, &[("relative_viscosity", &|time| 3.0 + 0.1 * noise(time, 0))]);
    let found = answers("extension", &[], &folder);
    is_near(get(&found, "relative_extensional_viscosity", "all"), 3.0);
}

/// `s = g [G' sin(w t) + G'' cos(w t)]` with `g = 0.5`, `w = 2`.
#[test]
fn oscillations_are_answered_by_moduli() {
    let keys = ["flow.rate=1.0", "time.step=0.031415926535897934", "time.steps=2000"];
    let text = Template::named("shear")
        .unwrap()
        .text
        .replace("rate = ", "oscillation = { amplitude = 0.5, frequency = 2.0 } # ");
    let scene =
        Scene::parse(&text, "scene.toml", &keys[1..].iter().map(|&key| key.to_owned()).collect::<Vec<_>>()).unwrap();
    let stress = |time: f64| 0.5 * (3.0 * (2.0 * time).sin() + 7.0 * (2.0 * time).cos()) + 0.01 * noise(time, 0);
    let folder =
        series(0.031_415_926_535_897_934, 2000, &[("shear_stress", &stress), ("relative_viscosity", &|_| 1.0)]);
    let found = run_answers(folder.path(), &scene, &AnswerRange::of_scene(&scene)).unwrap();
    is_near(get(&found, "storage_modulus", "all"), 3.0);
    is_near(get(&found, "loss_modulus", "all"), 7.0);
    assert!(found.iter().all(|answer| answer.quantity != "relative_viscosity"));
}

#[test]
fn settling_is_along_the_force_on_each_species() {
    let folder = series(
        0.1,
        300,
        &[
            ("mean_velocity_x[heavy]", &|_| 9.0),
            ("mean_velocity_y[heavy]", &|_| 9.0),
            ("mean_velocity_z[heavy]", &|time| -0.6 + 0.05 * noise(time, 0)),
            ("mean_velocity_x[buoyant]", &|_| 9.0),
            ("mean_velocity_y[buoyant]", &|_| 9.0),
            ("mean_velocity_z[buoyant]", &|time| 0.7 + 0.05 * noise(time, 1)),
            ("velocity_variance_x[heavy]", &|_| 0.04),
            ("velocity_variance_y[heavy]", &|_| 0.02),
            ("velocity_variance_z[heavy]", &|time| 0.25 + 0.01 * noise(time, 2)),
            ("velocity_variance_x[buoyant]", &|_| 0.0),
            ("velocity_variance_y[buoyant]", &|_| 0.0),
            ("velocity_variance_z[buoyant]", &|_| 0.0),
        ],
    );
    let found = answers("segregation", &["fluid.viscosity=2.0"], &folder);
    is_near(get(&found, "settling_velocity", "heavy"), 0.6);
    is_near(get(&found, "settling_velocity", "buoyant"), 0.7);
    // A force of 6 pi and a viscosity of 2: alone it would settle at 1/2.
    is_near(get(&found, "hindered_settling_function", "heavy"), 1.2);
    is_near(get(&found, "velocity_fluctuation_parallel", "heavy"), 0.5);
    is_near(get(&found, "velocity_fluctuation_perpendicular", "heavy"), 0.03_f64.sqrt());
    assert!(found.iter().all(|answer| answer.species != "buoyant" || !answer.quantity.starts_with("velocity_f")));
}

#[test]
fn over_a_bottom_heights_are_the_answers() {
    let folder = series(
        0.1,
        300,
        &[
            ("height_mean[heavy]", &|time| 4.0 + 0.1 * noise(time, 0)),
            ("height_deviation[heavy]", &|time| 1.0 + 0.1 * noise(time, 1)),
            ("mean_velocity_x[heavy]", &|_| 0.0),
            ("mean_velocity_y[heavy]", &|_| 0.0),
            ("mean_velocity_z[heavy]", &|_| 0.0),
        ],
    );
    let found = answers("sediment", &[], &folder);
    is_near(get(&found, "mean_height", "heavy"), 4.0);
    is_near(get(&found, "height_deviation", "heavy"), 1.0);
    assert_eq!(found.len(), 2);
}

#[test]
fn channels_are_answered_by_flux_slip_and_migration() {
    let folder = series(
        0.1,
        300,
        &[
            ("mean_velocity_x[sphere]", &|time| -0.02 + 0.01 * noise(time, 0)),
            ("mean_velocity_y[sphere]", &|_| 9.0),
            ("mean_velocity_z[sphere]", &|_| 9.0),
            ("particle_flux_x[sphere]", &|time| 0.1 + 0.01 * noise(time, 1)),
            ("migration_z[sphere]", &|time| 0.9 + 0.01 * noise(time, 2)),
        ],
    );
    let found = answers("poiseuille", &[], &folder);
    is_near(get(&found, "particle_flux", "sphere"), 0.1);
    is_near(get(&found, "slip_velocity", "sphere"), -0.02);
    is_near(get(&found, "migration", "sphere"), 0.9);
    assert_eq!(get(&found, "slip_velocity", "sphere").mean.verdict, Verdict::Converged);
}

#[test]
fn grains_are_answered_by_stress_and_temperature() {
    let folder = series(
        1.0,
        300,
        &[
            ("stress_xx", &|time| 3.0 + 0.1 * noise(time, 0)),
            ("stress_xy", &|time| -1.0 + 0.1 * noise(time, 1)),
            ("stress_yy", &|time| 5.0 + 0.1 * noise(time, 2)),
            ("kinetic_energy", &|time| 0.5 + 0.1 * noise(time, 3)),
        ],
    );
    let found = answers("granular-disks", &[], &folder);
    for (quantity, expected) in [("shear_stress", -1.0), ("pressure", 4.0), ("granular_temperature", 0.5)] {
        is_near(get(&found, quantity, "all"), expected);
    }
    let wall = |name: &str| format!("wall_stress_{name}[bottom]");
    let [normal, along] = ["normal", "along"].map(wall);
    let of_cell = series(
        1.0,
        300,
        &[
            (normal.as_str(), &|time| 3.0 + 0.1 * noise(time, 0)),
            (along.as_str(), &|time| 1.0 + 0.1 * noise(time, 1)),
            ("temperature", &|time| 0.5 + 0.1 * noise(time, 2)),
        ],
    );
    let found = answers("shear-cell", &["time.step=1.0", "time.steps=300", "time.transient=100.0"], &of_cell);
    for (quantity, expected) in
        [("pressure_on_bottom", 3.0), ("shear_stress_on_bottom", 1.0), ("granular_temperature", 0.5)]
    {
        is_near(get(&found, quantity, "all"), expected);
        assert!(get(&found, quantity, "all").mean.transient >= 100.0);
    }
}

/// With statistics of a run: the mean over the axes, corrected for the box where the suspension is dilute.
#[test]
fn colloids_are_answered_by_diffusivities() {
    let folder = series(1.0, 300, &[("osmotic_pressure", &|time| 2.0 + 0.1 * noise(time, 0))]);
    let statistics = folder.path().join("statistics");
    std::fs::create_dir(&statistics).unwrap();
    let summary = |slope: f64, fraction: f64| {
        let text = format!(
            "quantity,species,unit,value,error,converged\nfirst_time,all,time,20.0,0.0,1.0\n\
             volume_fraction,colloid,,{fraction:?},0.0,1.0\nD_slope_x,colloid,length^2/time,{slope:?},0.003,1.0\n\
             D_slope_y,colloid,length^2/time,0.05,0.004,1.0\nD_slope_z,colloid,length^2/time,0.06,0.0,1.0\n"
        );
        std::fs::write(statistics.join("summary.csv"), text).unwrap();
        answers("colloid", &[], &folder)
    };
    let found = summary(0.04, 0.01);
    let of = get(&found, "diffusivity", "colloid").mean;
    assert!((of.value - 0.05).abs() < 1e-15 && (of.error - 0.005 / 3.0).abs() < 1e-15, "{of:?}");
    assert!(of.verdict == Verdict::Converged && (of.transient - 20.0).abs() < 1e-15, "{of:?}");
    let corrected = get(&found, "diffusivity_in_infinite_box", "colloid").mean;
    assert!((corrected.value - 0.05 - 2.837_297 / (6.0 * std::f64::consts::PI * 16.0)).abs() < 1e-15, "{corrected:?}");
    let dense = summary(0.04, 0.2);
    assert!(dense.iter().all(|answer| answer.quantity != "diffusivity_in_infinite_box"));
    let unknown = get(&summary(f64::NAN, 0.2), "diffusivity", "colloid").mean;
    assert!(unknown.value.is_nan() && unknown.verdict == Verdict::Meaningless, "{unknown:?}");
    is_near(get(&dense, "osmotic_pressure", "all"), 2.0);
}
