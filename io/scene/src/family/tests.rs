use super::*;

const SCENE: &str = "seed = 5\n[box]\nedges = [9.0, 9.0, 9.0]\n[fluid]\nviscosity = 1.0\n[time]\nstep = 0.01\n\
    steps = 4\n[[species]]\nradius = 1.0\nvolume_fraction = 0.1\n";

fn family(sections: &str) -> Result<Family, String> {
    match SceneFile::parse(&format!("{SCENE}{sections}"), "f.toml", &[]) {
        Ok(SceneFile::Family(family)) => Ok(family),
        Ok(SceneFile::Scene(_)) => Err("a scene".to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

fn members(sections: &str) -> Vec<String> {
    family(sections).unwrap().members().iter().map(ToString::to_string).collect()
}

#[test]
fn a_grid_has_every_combination_in_the_order_in_which_keys_are_written() {
    let grid =
        "[sweep]\n\"species[0].volume_fraction\" = [0.1, 0.2]\nfluid.viscosity = [1, 2.0]\n[ensemble]\nseeds = 2\n";
    let family = family(grid).unwrap();
    assert_eq!(family.keys(), ["species[0].volume_fraction", "fluid.viscosity"]);
    let members: Vec<String> = family.members().iter().map(ToString::to_string).collect();
    assert_eq!(members.len(), 8);
    assert_eq!(members[0], "point-0001/seed-0005 (species[0].volume_fraction = 0.1, fluid.viscosity = 1)");
    assert_eq!(members[3], "point-0002/seed-0006 (species[0].volume_fraction = 0.1, fluid.viscosity = 2.0)");
    assert_eq!(members[7], "point-0004/seed-0006 (species[0].volume_fraction = 0.2, fluid.viscosity = 2.0)");
    assert_eq!(family.points().count(), 4);
}

#[test]
fn a_member_is_the_scene_with_its_keys_and_no_family() {
    let family =
        family("[ensemble]\nseeds = [3, 1]\n[[sweep]]\n\"time.duration\" = 0.5\n[[sweep]]\ntime.duration = 1\n")
            .unwrap();
    let scene = family.scene(&family.members()[3]).unwrap();
    let alone = Scene::parse(SCENE, "f.toml", &["time.duration=1".to_owned(), "seed=1".to_owned()]).unwrap();
    assert_eq!(scene.differences(&alone), []);
    assert_eq!((scene.kind().steps(), scene.kind().seed()), (100, 1));
    assert!(!scene.text().contains("ensemble"), "{}", scene.text());
}

#[test]
fn seeds_alone_are_a_family_of_one_point_and_values_alone_have_the_seed_of_the_scene() {
    assert_eq!(
        members("[ensemble]\nseeds = 3\n"),
        ["point-0001/seed-0005", "point-0001/seed-0006", "point-0001/seed-0007"]
    );
    assert_eq!(members("[sweep]\n\"fluid.viscosity\" = [2.0]\n"), ["point-0001/seed-0005 (fluid.viscosity = 2.0)"]);
    let Ok(SceneFile::Scene(_)) = SceneFile::parse(SCENE, "f.toml", &[]) else {
        panic!("a scene without either section")
    };
}

#[test]
fn overrides_reach_the_lists_and_the_members() {
    let overrides = ["ensemble.seeds=2", "time.steps=7"].map(str::to_owned);
    let Ok(SceneFile::Family(family)) = SceneFile::parse(SCENE, "f.toml", &overrides) else { panic!("a family") };
    assert_eq!(family.members().len(), 2);
    assert_eq!(family.scene(&family.members()[1]).unwrap().kind().steps(), 7);
}

#[test]
fn what_makes_no_family_is_refused_by_key() {
    for (sections, expected) in [
        ("[ensemble]\n", "ensemble.seeds is missing"),
        ("[ensemble]\nseeds = 0\n", "f.toml:13: ensemble.seeds is 0; it needs 1 <= seeds"),
        ("[ensemble]\nseeds = -3\n", "ensemble.seeds is -3"),
        ("[ensemble]\nseeds = []\n", "ensemble.seeds is empty"),
        ("[ensemble]\nseeds = [1, 2, 1]\n", "ensemble.seeds has 1 more than once"),
        ("[ensemble]\nseeds = [1.5]\n", "ensemble.seeds has 1.5"),
        ("[ensemble]\nseeds = 2\nseed = 3\n", "ensemble.seed is not a key"),
        ("[ensemble]\nseeds = 20000\n", "ensemble.seeds is 20000"),
        ("[sweep]\n", "f.toml:12: sweep has no keys"),
        ("[sweep]\n\"fluid.viscosity\" = []\n", "sweep.\"fluid.viscosity\" is empty"),
        ("[sweep]\n\"fluid.viscosity\" = 1.0\n", "sweep.\"fluid.viscosity\" is 1.0; list its values"),
        ("[sweep]\n\"fluid.viscosity\" = [1, 1.0]\n", "sweep.\"fluid.viscosity\" has 1.0 more than once"),
        (
            "[sweep]\n\"fluid.viscocity\" = [1.0]\n",
            "fluid.viscocity is not a key of a scene; did you mean \"viscosity\"",
        ),
        ("[sweep]\n\"species[1].radius\" = [1.0]\n", "sweep can't set species[1].radius=1.0: there is no item 1"),
        ("[sweep]\n\"species[0\" = [1.0]\n", "write it as in species[0].radius"),
        ("[sweep]\nseed = [1, 2]\n", "sweep.\"seed\" is not swept: list seeds by [ensemble]"),
        ("[sweep]\n\"output.folder\" = [\"a\", \"b\"]\n", "sweep.\"output.folder\" is not swept"),
        ("[sweep]\nkind = [\"suspension\"]\n", "sweep.\"kind\" is not swept"),
        ("[sweep]\nensemble.seeds = [1]\n", "a member of a family is no family"),
        ("[sweep]\n\"fluid.viscosity\" = [1]\nfluid.viscosity = [2]\n", "is swept twice"),
        ("[[sweep]]\nfluid.viscosity = 1\n[[sweep]]\ntime.step = 2\n", "sweep[1] has no fluid.viscosity"),
        (
            "[[sweep]]\nfluid.viscosity = 1\n[[sweep]]\nfluid.viscosity = 2\ntime.step = 1\n",
            "sweep[1] has time.step besides",
        ),
        (
            "[[sweep]]\nfluid.viscosity = 1\ntime.step = 1\n[[sweep]]\nfluid.viscosity = 1\ntime.step = 1.0\n",
            "sweep has the point fluid.viscosity = 1, time.step = 1.0 more than once",
        ),
        (
            "[sweep]\n\"species[0].volume_fraction\" = [0.1, 0.8]\n",
            "f.toml, point-0002/seed-0005 (species[0].volume_fraction = 0.8): ",
        ),
    ] {
        let error = family(sections).unwrap_err();
        assert!(error.contains(expected), "{sections}\n  expected: {expected}\n  found:    {error}");
    }
    let text = format!("sweep = 3\n{SCENE}");
    let error = SceneFile::parse(&text, "f.toml", &[]).unwrap_err().to_string();
    assert!(error.contains("sweep is 3; write a section"), "{error}");
}

#[test]
fn a_family_is_no_scene_of_one_run() {
    let error = Scene::parse(&format!("{SCENE}[ensemble]\nseeds = 2\n"), "f.toml", &[]).unwrap_err().to_string();
    assert!(error.starts_with("f.toml:12: ensemble makes a family of many runs"), "{error}");
}

#[test]
fn scenes_without_random_numbers_have_no_seeds() {
    let text = crate::Template::named("shear-cell-continuum").unwrap().text;
    let swept = format!("{text}\n[sweep]\n\"grains.restitution\" = [0.8, 0.9]\n");
    let Ok(SceneFile::Family(family)) = SceneFile::parse(&swept, "c.toml", &[]) else { panic!("a family") };
    assert_eq!(family.members()[1].folder(), "point-0002");
    let error = SceneFile::parse(&format!("{text}\n[ensemble]\nseeds = 2\n"), "c.toml", &[]).unwrap_err().to_string();
    assert!(error.contains("ensemble goes with scenes that have random numbers"), "{error}");
}

fn disks(sections: &str, sets: &[&str]) -> Result<Family, String> {
    let disks = crate::Template::named("granular-disks").unwrap().text;
    let sets: Vec<String> = sets.iter().map(|&set| set.to_owned()).collect();
    match SceneFile::parse(&format!("{disks}\n{sections}"), "d.toml", &sets) {
        Ok(SceneFile::Family(family)) => Ok(family),
        Ok(SceneFile::Scene(_)) => Err("a scene".to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

#[test]
fn former_lists_of_disks_are_those_of_now() {
    let former =
        disks("[sweep]\nseeds = [4, 2]\nviscosities = [0.001, 0.01]\nrates = [0.02]\narea_fractions = [0.5]\n", &[]);
    let now = disks(
        "[ensemble]\nseeds = [4, 2]\n[sweep]\n\"flow.rate\" = [0.02]\n\"fluid.viscosity\" = [0.001, 0.01]\n\
         \"particles.area_fraction\" = [0.5]\n",
        &[],
    );
    let (former, now) = (former.unwrap(), now.unwrap());
    assert_eq!(former.members(), now.members());
    assert_eq!(
        former.warnings(),
        [
            "sweep.seeds has another name now: [ensemble] seeds",
            "sweep.viscosities has another name now: [sweep] \"fluid.viscosity\"",
            "sweep.rates has another name now: [sweep] \"flow.rate\"",
            "sweep.area_fractions has another name now: [sweep] \"particles.area_fraction\"",
        ]
    );
    assert!(now.warnings().is_empty());
    let Ok(SceneFile::Family(again)) = SceneFile::parse(former.text(), "d.toml", &[]) else { panic!("a family") };
    assert!(again.warnings().is_empty() && again.members() == former.members());
    let set = disks("", &["sweep.seeds=[1, 2, 3]", "sweep.rates=[0.01]"]).unwrap();
    assert_eq!(set.members().len(), 3);
    assert_eq!(disks("[sweep]\nseeds = [1, 2]\n", &[]).unwrap().keys(), [""; 0]);
}

#[test]
fn former_lists_are_refused_by_their_names() {
    for (sections, expected) in [
        ("[sweep]\nseeds = []\n", "sweep.seeds is empty"),
        ("[sweep]\nviscosities = [0.01, 0.01]\n", "sweep.viscosities has 0.01 more than once"),
        ("[sweep]\nrates = 0.01\n", "sweep.rates is 0.01; list its values"),
        ("[sweep.rates]\nx = 0.01\n", "sweep.rates.x is 0.01; list its values"),
        (
            "[sweep]\nseeds = [1]\n[ensemble]\nseeds = 2\n",
            "sweep.seeds is the former name of [ensemble] seeds, which is set too",
        ),
        (
            "[sweep]\nrates = [0.01]\n\"flow.rate\" = [0.02]\n",
            "sweep.rates is the former name of [sweep] \"flow.rate\", which is set too",
        ),
        (
            "[sweep]\nviscosities = [0.01, 0.5]\n",
            "point-0002/seed-0001 (fluid.viscosity = 0.5): fluid.viscosity is 0.5",
        ),
    ] {
        let error = disks(sections, &[]).unwrap_err();
        assert!(error.contains(expected), "{sections}\n  expected: {expected}\n  found:    {error}");
    }
    let error = disks("[sweep]\nrates = [0.01, 0.02]\n", &["time.steps=9"]).unwrap_err();
    assert!(error.contains("end at the same strain by time.strain only"), "{error}");
    let spheres = family("[sweep]\nviscosities = [1.0]\n").unwrap_err();
    assert!(spheres.contains("viscosities is not a key of a scene"), "{spheres}");
}
