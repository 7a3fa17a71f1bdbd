use super::*;
use crate::former_names::{DISKS, SHEAR_CELL, SUSPENSION};
use crate::{Scene, SceneFile, Template, differences_of};

/// A scene of a kind with a section for each key.
fn scene_of(kind: &str) -> String {
    match kind {
        DISKS => Template::named("granular-disks").unwrap().text.to_owned(),
        SHEAR_CELL => Template::named("shear-cell").unwrap().text.to_owned(),
        _ => r#"
[box]
edges = [30.0, 30.0, 30.0]
[fluid]
viscosity = 1.0
[[species]]
distribution = { kind = "log-normal", mean = 1.0, standard_deviation = 0.2 }
count = 100
[flow]
kind = "shear"
rate = 1.0
[time]
step = 0.1
steps = 10
[hydrodynamics]
lubrication = true
"#
        .to_owned(),
    }
}

/// Sections that some keys need, and a value of the key.
fn needed(key: &str) -> (&'static str, &'static str) {
    match key {
        "regularisation_length" => (
            "[repulsion]\nstrength = 1.0\nrange = 0.1\n[attraction]\nkind = \"van-der-waals\"\nhamaker = 1.0\n",
            "0.05",
        ),
        "osmotic_pressure" => (
            "[repulsion]\nstrength = 1.0\nrange = 0.1\n[attraction]\nkind = \"depletion\"\ndepletant_radius = 0.1\n",
            "0.5",
        ),
        "adaptation_strain" => ("[contacts]\nfriction = 0.1\n", "1.5"),
        "adapted_stiffness" => ("[contacts]\nfriction = 0.1\n", "1234.5"),
        "target_overlap" => ("[contacts]\nfriction = 0.1\n", "0.25"),
        _ => ("", ""),
    }
}

/// The line of a key, which is the only one of that name.
fn with_name(text: &str, name: &str, other: &str) -> String {
    let (at_start, inside) = (format!("\n{name} ="), format!(" {name} ="));
    let renamed = text.replace(&at_start, &format!("\n{other} =")).replace(&inside, &format!(" {other} ="));
    assert_ne!(renamed, text, "{name}");
    renamed
}

#[test]
fn former_names_of_keys_give_the_same_scene_with_a_warning() {
    for FormerKey { kind, section, former, present } in &FORMER_KEYS {
        let (more, value) = needed(present);
        let set = if value.is_empty() { String::new() } else { format!("{present} = {value}\n") };
        let present_text = format!("{}{more}{set}", scene_of(kind));
        let former_text = with_name(&present_text, present, former);
        let [now, then] = [&present_text, &former_text].map(|text| Scene::parse(text, "scene.toml", &[]).unwrap());
        assert_eq!(format!("{:?}", now.kind()), format!("{:?}", then.kind()), "{former}");
        assert_eq!((now.warnings(), then.text()), (&[][..], former_text.as_str()));
        assert!(!then.warnings().is_empty(), "{former}");
        for warning in then.warnings() {
            let section = section.replace("species", "species[0]");
            let expected = format!("{section}.{former} has another name now: {section}.{present}");
            assert_eq!(warning.replace("species[1]", "species[0]"), expected);
        }
        assert_eq!(differences_of(now.text(), then.text()).unwrap(), []);
    }
}

#[test]
fn former_words_give_the_same_scene_with_a_warning() {
    for FormerWord { former, present, .. } in &FORMER_WORDS {
        let scene = Template::named("colloid").unwrap().text;
        let text = |word: &str| scene.replace("[time]", &format!("[time]\nbrownian = \"{word}\""));
        let [now, then] = [present, former].map(|word| Scene::parse(&text(word), "scene.toml", &[]).unwrap());
        assert_eq!(format!("{:?}", now.kind()), format!("{:?}", then.kind()));
        let expected = format!("time.brownian = \"{former}\" has another name now: \"{present}\"");
        assert_eq!((now.warnings(), then.warnings()), (&[][..], &[expected.clone()][..]));
        assert_eq!(differences_of(now.text(), then.text()).unwrap(), []);
        let set = [format!("time.brownian={former}")];
        let then = Scene::parse(scene, "scene.toml", &set).unwrap();
        assert_eq!((then.warnings(), then.text().contains(present)), (&[expected][..], true));
    }
}

#[test]
fn keys_may_be_set_by_their_former_names() {
    let text = format!("{}[contacts]\nfriction = 0.1\nsettling = 1.0\n", scene_of(SUSPENSION));
    let read = |set: &str| Scene::parse(&text, "scene.toml", &[set.to_owned()]);
    for key in ["contacts.settling", "contacts.adaptation_strain"] {
        let scene = read(&format!("{key}=1.5")).unwrap();
        assert!(scene.text().contains("adaptation_strain = 1.5") && !scene.text().contains("settling"));
        assert_eq!(scene.warnings(), ["contacts.settling has another name now: contacts.adaptation_strain"]);
        let refused = read(&format!("{key}=-1.5")).unwrap_err().to_string();
        assert!(refused.starts_with(&format!("scene.toml with --set {key}=-1.5: {key} is -1.5")), "{refused}");
    }
    let deviation = read("species.0.distribution.deviation=0.1").unwrap();
    assert!(deviation.text().contains("standard_deviation = 0.1"));
}

#[test]
fn families_may_sweep_former_names() {
    let text = format!(
        "{}[contacts]\nfriction = 0.1\n[sweep]\n\"contacts.overlap\" = [0.2, 0.3]\n[ensemble]\nseeds = 2\n",
        scene_of(SUSPENSION)
    );
    let Ok(SceneFile::Family(family)) = SceneFile::parse(&text, "f.toml", &[]) else { panic!("a family") };
    assert_eq!(family.warnings(), ["contacts.overlap has another name now: contacts.target_overlap"]);
    let scene = family.scene(&family.members()[3]).unwrap();
    assert!(scene.text().contains("target_overlap = 0.3"));
}

#[test]
fn kept_scenes_with_former_names_are_those_of_the_same_run() {
    let text = format!("{}[contacts]\nfriction = 0.1\n", scene_of(SUSPENSION));
    let now = Scene::parse(&text, "scene.toml", &[]).unwrap();
    let kept = Scene::parse(&format!("{text}settled_stiffness = 500.0\n"), "scene.toml", &[]).unwrap();
    assert!(now.fixed_differences(&kept).is_empty());
    let again = now.with_own_keys_of(&kept).unwrap();
    assert!(again.text().contains("adapted_stiffness = 500.0") && again.warnings().is_empty());
}
