//! The scenes that come with the program.

/// A scene to start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Template {
    /// Name.
    pub name: &'static str,
    /// Description in one line.
    pub about: &'static str,
    /// Text of the scene.
    pub text: &'static str,
}

/// A template from the file of that name among the scenes.
macro_rules! template {
    ($name:literal, $about:literal) => {
        Template { name: $name, about: $about, text: include_str!(concat!("../scenes/", $name, ".toml")) }
    };
}

/// All templates.
pub static TEMPLATES: [Template; 31] = [
    template!("suspension", "Spheres of two kinds, with every key explained"),
    template!("settling", "3,200 spheres that settle, at 12% by volume"),
    template!("silica-in-water", "Silica spheres that settle in water, in SI units"),
    template!("pair-settling", "Two spheres that settle side by side"),
    template!("segregation", "Heavy and buoyant spheres that separate into streams"),
    template!("shear", "Two sizes of spheres in a shear flow"),
    template!("dense", "Rough spheres that touch with friction in a shear flow, at 45% by volume"),
    template!("reversal", "The same with a flow that is reversed"),
    template!("extension", "The same in planar extension"),
    template!("thickening", "The same under a given stress, with friction above a critical load"),
    template!("couette", "Spheres between walls of which one moves, at 20% by volume"),
    template!("poiseuille", "Spheres between walls in the flow of a pressure gradient"),
    template!("sediment", "Rough spheres that settle on a bottom"),
    template!("cloud", "A cloud of spheres that settles in unbounded fluid"),
    template!("chain", "A tethered chain of bonded spheres in a shear flow of unbounded fluid"),
    template!("filament", "Flexible filaments in a shear flow"),
    template!("colloid", "Charged colloids that diffuse, at 20% by volume"),
    template!("brownian-shear", "The same in a shear flow"),
    template!("colloid-sediment", "Colloids that settle on a bottom and diffuse above it"),
    template!("orientations", "Aligned spheres that lose their order by Brownian rotation"),
    template!("squirmers", "Squirmers that start in random directions, at 10% by volume"),
    template!("bodies", "Rods, tetrahedra and spheres that settle together"),
    template!("rods", "Rods in a shear flow, at 10% by volume"),
    template!("rollers", "Spheres that are turned at a given rate and roll along a bottom"),
    template!("magnetic-chains", "Paramagnetic spheres that line up in chains along a field"),
    template!("family", "Three volume fractions with two seeds each: a viscosity with its error from many runs"),
    template!("granular-disks", "Disks that collide in a sheared liquid, with every key explained"),
    template!("disk-sweep", "Several seeds and viscosities of such disks"),
    template!("poiseuille-disks", "Disks of many sizes in a Poiseuille flow"),
    template!("shear-cell", "Grains in a shear cell, with every key explained"),
    template!("shear-cell-continuum", "The kinetic theory of a shear cell, with every key explained"),
];

impl Template {
    /// The template of that name, if there is one.
    pub fn named(name: &str) -> Option<Self> {
        TEMPLATES.iter().find(|template| template.name == name).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SceneFile;

    #[test]
    fn every_template_is_a_scene() {
        for template in TEMPLATES {
            SceneFile::parse(template.text, template.name, &[]).unwrap();
            assert_eq!(Template::named(template.name), Some(template));
        }
        assert_eq!(Template::named("sediments"), None);
    }
}
