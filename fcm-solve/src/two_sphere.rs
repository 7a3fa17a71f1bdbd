//! `fcm-solve two-sphere`: the exact resistance functions of two spheres, or of a sphere at a plane wall.

use crate::streams;
use anyhow::Context;
use domain::Comm;
use lubrication::two_sphere::{
    SphereWall, SphereWallSlip, TwoSphere, TwoSphereError, TwoSphereSlip, named, named_at_wall, named_slip,
    named_slip_at_wall,
};
use serde_json::{Map, Value};

/// Geometry of two spheres, and the form of the output.
#[derive(clap::Args)]
pub struct TwoSphereArgs {
    /// Radius of sphere 2 over that of sphere 1, from 0.05 to 20
    #[arg(long, value_name = "R", allow_hyphen_values = true, required_unless_present = "wall")]
    ratio: Option<f64>,
    /// A fixed plane wall in place of sphere 2: the functions of a sphere that moves at it
    #[arg(long, conflicts_with = "ratio")]
    wall: bool,
    /// Gap between the surfaces over the radius of sphere 1, above 0
    #[arg(long, value_name = "G", allow_hyphen_values = true)]
    gap: f64,
    /// Print the loads of spheres at rest by the slip of squirmers in place of resistance functions
    #[arg(long)]
    slip: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Prints the resistance functions `XA11` and so on, in the normalisation of Jeffrey & Onishi (1984) and Jeffrey
/// (1992), or the loads by slip `XF1_11` and so on over viscosity, in units of the first radius; at a wall `XA` or
/// `XF1` and so on. Collective.
pub fn run(args: &TwoSphereArgs, comm: &Comm) -> anyhow::Result<()> {
    let named = || args.ratio.map_or_else(|| "--wall".to_owned(), |ratio| format!("--ratio {ratio}"));
    let values = comm.agree(values(args)).with_context(|| format!("{} --gap {}", named(), args.gap))?;
    let text = if args.json {
        let object: Map<String, Value> = values.into_iter().map(|(name, value)| (name, value.into())).collect();
        format!("{}\n", Value::Object(object))
    } else {
        values.into_iter().map(|(name, value)| format!("{name}  {value:+.10e}\n")).collect::<Vec<_>>().concat()
    };
    streams::print(comm, &text)
}

/// Names and values.
fn values(args: &TwoSphereArgs) -> Result<Vec<(String, f64)>, TwoSphereError> {
    let Some(ratio) = args.ratio else { return at_wall(args) };
    let functions = TwoSphere::with_ratio(ratio)?.resistance(args.gap)?;
    if args.slip {
        return Ok(named_slip(&TwoSphereSlip::with_ratio(ratio)?.at(args.gap)));
    }
    Ok(named(&functions).into_iter().map(|(name, value)| (name.to_owned(), value)).collect())
}

fn at_wall(args: &TwoSphereArgs) -> Result<Vec<(String, f64)>, TwoSphereError> {
    let functions = SphereWall::get().resistance(args.gap)?;
    if args.slip {
        return Ok(named_slip_at_wall(&SphereWallSlip::get().at(args.gap)));
    }
    Ok(named_at_wall(&functions))
}
