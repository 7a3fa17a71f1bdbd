//! `fcm-solve two-sphere`: the exact resistance functions of two spheres.

use crate::streams;
use anyhow::Context;
use domain::Comm;
use lubrication::two_sphere::{TwoSphere, named};
use serde_json::{Map, Value};

/// Geometry of two spheres, and the form of the output.
#[derive(clap::Args)]
pub struct Args {
    /// Radius of sphere 2 over that of sphere 1, from 0.05 to 20
    #[arg(long, value_name = "R", allow_hyphen_values = true)]
    ratio: f64,
    /// Gap between the surfaces over the radius of sphere 1, above 0
    #[arg(long, value_name = "G", allow_hyphen_values = true)]
    gap: f64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Prints the resistance functions `XA11` and so on, in the normalisation of Jeffrey & Onishi (1984) and Jeffrey
/// (1992). Collective.
pub fn run(args: &Args, comm: &Comm) -> anyhow::Result<()> {
    let functions = TwoSphere::with_ratio(args.ratio).and_then(|table| table.resistance(args.gap));
    let values = named(&comm.agree(functions).with_context(|| format!("--ratio {} --gap {}", args.ratio, args.gap))?);
    let text = if args.json {
        let object: Map<String, Value> =
            values.into_iter().map(|(name, value)| (name.to_owned(), value.into())).collect();
        format!("{}\n", Value::Object(object))
    } else {
        values.into_iter().map(|(name, value)| format!("{name}  {value:+.10e}\n")).collect::<Vec<_>>().concat()
    };
    streams::print(comm, &text)
}
