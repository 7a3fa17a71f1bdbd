//! `fcm-solve new`: scenes to start from.

use crate::streams;
use clap::ValueEnum;
use domain::Comm;

/// What to print.
#[derive(clap::Args)]
pub struct Args {
    /// Which scene.
    kind: Template,
}

/// The scenes that come with the program.
#[derive(Clone, Copy, ValueEnum)]
enum Template {
    /// Spheres of two kinds, with every key explained
    Suspension,
    /// 3,200 spheres that settle, at 12% by volume
    Settling,
    /// Silica spheres that settle in water, in SI units
    SilicaInWater,
    /// Two spheres that settle side by side
    PairSettling,
    /// Two sizes of spheres in a shear flow
    Shear,
    /// Disks that collide in a sheared liquid, with every key explained
    GranularDisks,
    /// Several seeds and viscosities of such disks
    DiskSweep,
    /// Disks of many sizes in a Poiseuille flow
    PoiseuilleDisks,
    /// Grains in a shear cell, with every key explained
    ShearCell,
    /// The kinetic theory of a shear cell, with every key explained
    ShearCellContinuum,
}

impl Template {
    fn text(self) -> &'static str {
        match self {
            Self::Suspension => include_str!("../../scenes/suspension.toml"),
            Self::Settling => include_str!("../../scenes/settling.toml"),
            Self::SilicaInWater => include_str!("../../scenes/silica-in-water.toml"),
            Self::PairSettling => include_str!("../../scenes/pair-settling.toml"),
            Self::Shear => include_str!("../../scenes/shear.toml"),
            Self::GranularDisks => include_str!("../../scenes/granular-disks.toml"),
            Self::DiskSweep => include_str!("../../scenes/disk-sweep.toml"),
            Self::PoiseuilleDisks => include_str!("../../scenes/poiseuille-disks.toml"),
            Self::ShearCell => include_str!("../../scenes/shear-cell.toml"),
            Self::ShearCellContinuum => include_str!("../../scenes/shear-cell-continuum.toml"),
        }
    }
}

/// Prints the scene.
pub fn run(args: &Args, comm: &Comm) -> anyhow::Result<()> {
    streams::print(comm, args.kind.text())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_template_is_a_scene() {
        for template in Template::value_variants() {
            io::Scene::parse(template.text(), "template.toml", &[]).unwrap();
        }
    }
}
