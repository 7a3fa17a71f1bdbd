//! Names that keys and words had in former versions. They are still read, with a warning that gives the present name.

mod tree;

use crate::kind_names::KINDS;
use tree::Tree;

/// A key with another name in former versions.
pub(crate) struct FormerKey {
    pub(crate) kind: &'static str,
    /// Section of the key; in a list of sections, of each of them.
    pub(crate) section: &'static str,
    pub(crate) former: &'static str,
    pub(crate) present: &'static str,
}

/// A word with another spelling in former versions.
pub(crate) struct FormerWord {
    pub(crate) kind: &'static str,
    pub(crate) section: &'static str,
    pub(crate) key: &'static str,
    pub(crate) former: &'static str,
    pub(crate) present: &'static str,
}

pub(crate) const SUSPENSION: &str = KINDS[0];
pub(crate) const DISKS: &str = KINDS[1];
pub(crate) const SHEAR_CELL: &str = KINDS[2];

const fn key(kind: &'static str, section: &'static str, names: [&'static str; 2]) -> FormerKey {
    FormerKey { kind, section, former: names[0], present: names[1] }
}

pub(crate) const FORMER_KEYS: [FormerKey; 12] = [
    key(SUSPENSION, "contacts", ["settling", "adaptation_strain"]),
    key(SUSPENSION, "contacts", ["settled_stiffness", "adapted_stiffness"]),
    key(SUSPENSION, "contacts", ["overlap", "target_overlap"]),
    key(SUSPENSION, "attraction", ["closest", "regularisation_length"]),
    key(SUSPENSION, "attraction", ["pressure", "osmotic_pressure"]),
    key(SUSPENSION, "species.distribution", ["deviation", "standard_deviation"]),
    key(DISKS, "species", ["share", "number_fraction"]),
    key(DISKS, "contact", ["clip_attraction", "suppress_attraction"]),
    key(DISKS, "preparation", ["settled", "inelastic_until"]),
    key(DISKS, "preparation", ["mixed", "elastic_until"]),
    key(SHEAR_CELL, "grains", ["agitation", "initial_velocity_deviation"]),
    key(SHEAR_CELL, "time", ["settle", "transient"]),
];

pub(crate) const FORMER_WORDS: [FormerWord; 2] = [
    FormerWord { kind: SUSPENSION, section: "time", key: "brownian", former: "midpoint", present: "drifter-corrector" },
    FormerWord {
        kind: SUSPENSION,
        section: "time",
        key: "brownian",
        former: "two-evaluations",
        present: "random-finite-difference",
    },
];

/// Kind of the scene in a document.
pub(crate) fn kind_of<T: Tree>(document: &T) -> &str {
    document.word("kind").unwrap_or(SUSPENSION)
}

/// The present name of a key such as `species[0].share` in a scene of some kind.
pub(crate) fn present_key(kind: &str, key: &str) -> String {
    let Some((section, name)) = key.rsplit_once('.') else { return key.to_owned() };
    let plain: Vec<&str> = section.split('.').map(|part| part.split('[').next().unwrap_or(part)).collect();
    let plain: Vec<&str> = plain.into_iter().filter(|part| part.parse::<usize>().is_err()).collect();
    let plain = plain.join(".");
    let found = FORMER_KEYS.iter().find(|one| one.kind == kind && one.section == plain && one.former == name);
    found.map_or_else(|| key.to_owned(), |one| format!("{section}.{}", one.present))
}

/// Gives all keys and words of a document their present names.
pub(crate) fn bring_up_to_date<T: Tree>(document: &mut T) {
    let kind = kind_of(document).to_owned();
    for one in FORMER_KEYS.iter().filter(|one| one.kind == kind) {
        document.in_sections(one.section, &mut |section| section.rename(one.former, one.present));
    }
    for one in FORMER_WORDS.iter().filter(|one| one.kind == kind) {
        document.in_sections(one.section, &mut |section| {
            if section.word(one.key) == Some(one.former) {
                section.set_word(one.key, one.present);
            }
        });
    }
}
