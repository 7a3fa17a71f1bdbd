//! `fcm-solve new`: scenes to start from.

use crate::streams;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use domain::Comm;
use scene::{TEMPLATES, Template};

/// Scene to print.
#[derive(clap::Args)]
pub struct NewArgs {
    /// Name of the scene
    #[arg(value_parser = template())]
    kind: Template,
}

fn template() -> impl TypedValueParser<Value = Template> {
    let names = TEMPLATES.iter().map(|template| PossibleValue::new(template.name).help(template.about));
    PossibleValuesParser::new(names).map(|name| Template::named(&name).expect("one of the names"))
}

/// First line of a scene, which refers editors to the JSON Schema of its keys; `fcm-solve schema` writes that file.
const SCHEMA: &str = "#:schema fcm-solve.schema.json\n";

/// Prints the scene.
pub fn run(args: &NewArgs, comm: &Comm) -> anyhow::Result<()> {
    streams::print(comm, &format!("{SCHEMA}{}", args.kind.text))
}
