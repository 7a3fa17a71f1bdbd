use super::FamilyFolder;
use super::table::table;
use crate::{ExistingRun, MemberState};
use files::{MANIFEST, Manifest};
use scene::{Family, SceneFile};
use std::path::Path;

const SCENE: &str = "[box]\nedges = [9.0, 9.0, 9.0]\n[fluid]\nviscosity = 1.0\n[time]\nstep = 0.01\nsteps = 4\n\
    [[species]]\nradius = 1.0\nvolume_fraction = 0.1\n[ensemble]\nseeds = [1, 2]\n\
    [sweep]\n\"fluid.viscosity\" = [1.0, 2.0]\n";

fn family(text: &str) -> Family {
    let Ok(SceneFile::Family(family)) = SceneFile::parse(text, "f.toml", &[]) else { panic!("a family") };
    family
}

fn summary(folder: &Path, rows: &str) {
    let columns = "quantity,species,value,error,samples,transient,verdict,longer,unit\n";
    std::fs::write(folder.join("summary.csv"), format!("{columns}{rows}")).unwrap();
}

#[test]
fn rows_are_means_over_the_seeds_of_a_point() {
    let place = tempfile::tempdir().unwrap();
    let family = family(SCENE);
    let folder = FamilyFolder::claim(place.path(), &family, ExistingRun::Keep).unwrap();
    let [first, second, third, _] = family.members() else { panic!("four") };
    summary(&folder.member(first), "viscosity,,2.0,0.5,9,1.0,converged,,\nrate,a,1.0,0.1,9,1.0,converged,,1/time\n");
    summary(&folder.member(second), "viscosity,,4.0,0.5,9,1.0,too short,2.0,\nrate,a,,,,1.0,meaningless,,1/time\n");
    summary(&folder.member(third), "viscosity,,8.0,0.25,9,1.0,converged,,\n");
    let table = table(&folder, &family).unwrap();
    assert_eq!(table.rows.len(), 3);
    let words: Vec<&str> = table.rows[0].0.iter().map(String::as_str).collect();
    assert_eq!(words, ["point-0001", "fluid.viscosity = 1.0", "viscosity", "", "1 converged, 1 too short", ""]);
    assert_eq!(table.columns[0].0, "fluid.viscosity");
    let numbers = &table.rows[0].1;
    assert_eq!((numbers[0], numbers[1], numbers[3], numbers[5]), (1.0, 3.0, 2.0, 0.5));
    assert!((numbers[2] - 1.837_337).abs() < 1e-5, "2 values one apart from their mean: {}", numbers[2]);
    assert_eq!((&table.rows[1].1[1..4], table.rows[1].0[5].as_str()), (&[1.0, 0.1, 1.0][..], "1/time"));
    assert_eq!((table.rows[2].1[0], table.rows[2].1[1], table.rows[2].1[2]), (2.0, 8.0, 0.25));
    folder.write_table(&family).unwrap();
    let csv = std::fs::read_to_string(place.path().join("family.csv")).unwrap();
    assert!(
        csv.starts_with("point,values,quantity,species,verdicts,unit,fluid.viscosity,mean,error,seeds,spread"),
        "{csv}"
    );
}

#[test]
fn a_family_goes_on_with_more_values_and_not_with_another_scene() {
    let place = tempfile::tempdir().unwrap();
    let claim = |text: &str, former| FamilyFolder::claim(place.path(), &family(text), former).map(drop);
    claim(SCENE, ExistingRun::Keep).unwrap();
    let error = claim(SCENE, ExistingRun::Keep).unwrap_err().to_string();
    assert!(error.contains("already holds the results of a run"), "{error}");
    claim(&SCENE.replace("[1.0, 2.0]", "[1.0, 2.0, 3.0]"), ExistingRun::Continue).unwrap();
    assert!(place.path().join("point-0003/seed-0002").is_dir());
    let error = claim(&SCENE.replace("step = 0.01", "step = 0.02"), ExistingRun::Continue).unwrap_err().to_string();
    assert!(error.contains("holds another family: time.step is 0.02 here and 0.01 there"), "{error}");
    claim(&SCENE.replace("step = 0.01", "step = 0.02"), ExistingRun::Replace).unwrap();
    let listed = std::fs::read_to_string(place.path().join(MANIFEST)).unwrap();
    assert!(listed.contains("point-0002/seed-0001/run.log"), "{listed}");
    let manifest = Manifest::open(place.path()).unwrap().unwrap();
    assert!(manifest.lists(&place.path().join("family.csv")));
}

#[test]
fn files_of_others_in_the_place_of_members_are_kept() {
    let place = tempfile::tempdir().unwrap();
    std::fs::create_dir(place.path().join("point-0001")).unwrap();
    let error = FamilyFolder::claim(place.path(), &family(SCENE), ExistingRun::Replace).unwrap_err().to_string();
    assert!(
        error.contains("files that no run is known to have made, under names that a run uses: point-0001/"),
        "{error}"
    );
}

#[test]
fn the_state_of_a_member_is_that_of_its_folder() {
    let place = tempfile::tempdir().unwrap();
    let family = family(SCENE);
    let folder = FamilyFolder::claim(place.path(), &family, ExistingRun::Keep).unwrap();
    let member = &family.members()[0];
    let scene = family.scene(member).unwrap();
    let state = || folder.state(member, &scene);
    assert_eq!(state(), MemberState::Waiting);
    std::fs::write(folder.log(member), "step 1\nerror: it broke\n").unwrap();
    assert_eq!(state(), MemberState::Failed("it broke".to_owned()));
    std::fs::write(folder.log(member), "error: it broke\nstep 2\nstopped after step 3 of 4 by SIGTERM\n").unwrap();
    std::fs::write(folder.member(member).join("checkpoint-0000000003.bin"), "").unwrap();
    assert_eq!(state(), MemberState::Stopped(3));
    std::fs::write(folder.member(member).join("checkpoint-0000000004.bin"), "").unwrap();
    std::fs::write(folder.member(member).join("scene.toml"), scene.text()).unwrap();
    assert_eq!(state(), MemberState::Finished);
    let longer = family.scene(member).unwrap().with("a longer run", &["time.steps=9".to_owned()]).unwrap();
    assert_eq!(folder.state(member, &longer), MemberState::Stopped(4));
    std::fs::write(folder.log(member), "the suspension is jammed\nfinished after step 4; results in x\nviscosity 3\n")
        .unwrap();
    assert_eq!(folder.state(member, &longer), MemberState::Stopped(4), "another end");
    std::fs::write(folder.member(member).join("scene.toml"), longer.text()).unwrap();
    assert_eq!(folder.state(member, &longer), MemberState::Finished, "it ended before its last step");
    std::fs::write(folder.member(member).join("scene.toml"), scene.text()).unwrap();
    let lock = std::fs::File::create(folder.member(member).join(".lock")).unwrap();
    lock.lock().unwrap();
    assert_eq!(folder.state(member, &longer), MemberState::Running);
}

#[test]
fn the_report_of_a_family_has_curves_over_the_first_key() {
    let place = tempfile::tempdir().unwrap();
    let family = family(
        &SCENE.replace("\"fluid.viscosity\"", "\"hydrodynamics.method\" = [\"auto\", \"direct\"]\n\"fluid.viscosity\""),
    );
    let folder = FamilyFolder::claim(place.path(), &family, ExistingRun::Keep).unwrap();
    for member in family.members() {
        let value = (member.point + 1) as f64 + member.seed.unwrap() as f64;
        summary(&folder.member(member), &format!("shear_stress,,{value},0.5,9,1.0,converged,,force/length^2\n"));
    }
    folder.write_table(&family).unwrap();
    let page = place.path().join("report.html");
    report::write_report(place.path(), &page).unwrap();
    let text = std::fs::read_to_string(&page).unwrap();
    for expected in [
        "<dt>runs</dt><dd>8 at 4 points</dd>",
        "<figcaption>shear stress</figcaption>",
        "fluid.viscosity",
        "hydrodynamics.method = &quot;direct&quot;",
        "Means over the seeds",
        "2 converged",
        "mean over the seeds (force/length\u{b2})",
    ] {
        assert!(text.contains(expected), "{expected}");
    }
    assert!(!text.contains("No quantity has a mean"));
    let chart = &text[text.find("<figure>").unwrap()..text.find("</figure>").unwrap()];
    // A bar for each of the two points of the two lines.
    let bars = chart.lines().filter(|line| line.contains("<circle")).map(|line| line.matches('V').count());
    assert_eq!(bars.collect::<Vec<_>>(), [2, 2], "{chart}");
}

#[test]
fn the_report_of_a_family_without_means_says_so() {
    let place = tempfile::tempdir().unwrap();
    let family = family(SCENE);
    let folder = FamilyFolder::claim(place.path(), &family, ExistingRun::Keep).unwrap();
    for member in family.members() {
        summary(&folder.member(member), "shear_stress,,,,,1.0,meaningless,,force/length^2\n");
    }
    folder.write_table(&family).unwrap();
    let page = place.path().join("report.html");
    report::write_report(place.path(), &page).unwrap();
    let text = std::fs::read_to_string(&page).unwrap();
    assert!(text.contains("No quantity has a mean") && !text.contains("<figure>"));
}
