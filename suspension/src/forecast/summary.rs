//! Outline of a scene before it is run, in numbers.

use crate::error::StartError;
use crate::error::gap::Gap;
use crate::evaluation::prepared::{Planned, Setup};
use crate::flow::open_cell::follows;
use crate::forecast::network::with_network;
use crate::forecast::warnings::{cautions, diffusive_step};
use crate::model::radii::Radii;
use crate::model::{Bodies, Contacts, Flow, Model, MomentKind, Species, Swimming};
use crate::start::memory;
use crate::start::plan::{dipole_plans, problem_in};
use domain::{AxisRotation, Boundaries, Comm, GivenPositions, MemoryNeed, Number, PeriodicBox, readable_bytes, sphere};
use fcm::{CardMemory, CardRanks, ComputeDevice, Plan, Precision, Problem, Split};
use hydrodynamics::memory::Ranks;
use serde_json::{Value, json};
use simulation::Outline;

/// Number of alternative plans that are listed.
const RUNNERS_UP: usize = 3;

/// Parallel layout for which the outline is made.
#[derive(Debug, Clone, Copy)]
pub struct Asked {
    /// Ranks and their threads.
    pub ranks: Ranks,
    /// Number of ranks that share a machine.
    pub on_a_machine: usize,
    /// Whether these are the present ranks, for which a run that needs too much memory is refused.
    pub are_present: bool,
}

impl Asked {
    /// Layout of the present ranks.
    pub fn present(comm: &Comm) -> Self {
        let ranks = Ranks { count: comm.size(), threads: rayon::current_num_threads() };
        Self { ranks, on_a_machine: comm.size(), are_present: true }
    }
}

/// Memory of each rank, and an error if this machine does not have it.
struct MemoryForecast {
    needs: Vec<MemoryNeed>,
    missing: Option<String>,
}

/// Outline of a scene for a parallel layout that need not be present. Collective.
pub fn outline(
    model: &Model,
    placed: Option<GivenPositions>,
    asked: Asked,
    comm: &Comm,
) -> Result<Outline, StartError> {
    let planned = Planned::of_model(model)?;
    let fits = |planned: &Planned| comm.check_memory(memory::placing(model, &planned.radii)).is_ok();
    let (planned, gap, relaxed) = match planned {
        Some(planned) if comm.any(!fits(&planned)) => (planned, None, None),
        planned => {
            let setup = Setup::placed(model, placed, planned, comm)?;
            let (gap, relaxed) = (setup.gap(), setup.relaxed());
            (Planned { radii: setup.radii, plan: setup.plan }, Some(gap), relaxed)
        }
    };
    planned.plan.check_ranks(asked.ranks.count)?;
    let cell = if follows(model.cell.boundaries()) { planned.plan.cell() } else { model.cell };
    let mut others = Plan::ranked(&problem_in(&cell, model, &planned.radii))?;
    others.retain(|plan| *plan != planned.plan);
    let outline = with_particles(Outline::default(), model, &planned.radii, gap.as_ref());
    let outline =
        outline.lines(&planned.plan.describe_for(model.turn)).value("plan", plan_values(&planned.plan, model.turn));
    let outline = with_end(outline, model);
    let outline = match diffusive_step(model, &planned.radii) {
        None => outline,
        Some(step) => outline
            .line("diffusion", format_args!("{:.3} of the smallest sphere's a^2/D0 in a step", Number(step)))
            .value("diffusive_step", step),
    };
    let outline = with_fields(with_flux(with_stiffness(outline, model), model), model, &planned.radii);
    let memory = MemoryForecast::of(model, &planned, asked);
    let refusal = asked.are_present.then(|| planned.check_memory(model, comm).err()).flatten();
    let outline = outline.refusal(refusal.map(|failure| failure.to_string()));
    let card = memory::card(model, &planned.radii, &planned.plan, CardRanks::Asked(asked.ranks.count))?;
    let outline = with_card(memory.add_to(outline), card, model);
    let outline = with_cost(outline, &planned.plan, model.turn, &others);
    let outline = with_network(outline, model, &planned, asked);
    let outline = beside_periodic(outline, model, &cell, &planned, asked.ranks);
    Ok(outline.warnings(memory.missing.into_iter().chain(relaxed).chain(cautions(model, &planned.radii))))
}

/// Predicted peak memory in bytes of the rank that needs most, before any particle is placed; `None` if a file
/// determines the particles.
pub fn predicted_memory(model: &Model, ranks: Ranks) -> Result<Option<f64>, StartError> {
    let Some(planned) = Planned::of_model(model)? else { return Ok(None) };
    let needs = memory::needs(model, &planned.radii, &planned.plan, ranks);
    Ok(needs.iter().map(|need| need.resident).reduce(f64::max))
}

/// Adds the last step, and the strain at which the run may end before it.
fn with_end(outline: Outline, model: &Model) -> Outline {
    let (steps, end) = (model.steps, Number(model.end()));
    let text = match model.last_strain {
        Some(strain) => format!("at most {steps}, until strain {:.6} or time {end:.6}", Number(strain)),
        None => format!("{steps}, until time {end:.6}"),
    };
    let outline = outline.line("steps", text).value("steps", steps).value("end_time", model.end());
    match model.last_strain {
        Some(strain) => outline.value("last_strain", strain),
        None => outline,
    }
}

/// Adds the estimated stiffness of contacts, if it is automatic.
fn with_stiffness(outline: Outline, model: &Model) -> Outline {
    let Some(contacts) = model.contacts.filter(|contacts| contacts.stiffness.is_none()) else { return outline };
    let stiffness = contacts.contact(model).stiffness;
    let settles = match contacts.settling.unwrap_or(Contacts::SETTLING) {
        strain if contacts.settles(model) => format!(" at first; it settles in a strain of {}", Number(strain)),
        _ => String::new(),
    };
    outline
        .line("contacts", format_args!("stiffness {:.4}{settles}", Number(stiffness)))
        .value("contact_stiffness", stiffness)
}

/// Adds the pressure gradient of a given flux.
fn with_flux(outline: Outline, model: &Model) -> Outline {
    let Flow::ConstantFlux { mean_velocity } = model.flow else { return outline };
    let curvature = model.flow.curvature(model.viscosity, model.cell.edges().z).unwrap_or_default();
    let alone = model.viscosity * curvature;
    outline
        .line(
            "flux",
            format_args!(
                "mean velocity {:.6}, for which the fluid alone takes a pressure gradient of {:.4}; a solve takes one \
                 evaluation more with lubrication",
                Number(mean_velocity),
                Number(alone)
            ),
        )
        .value("pressure_gradient_of_fluid", alone)
}

/// Adds the plans of the fields of magnetic and electric moments.
fn with_fields(outline: Outline, model: &Model, radii: &Radii) -> Outline {
    let kinds = MomentKind::ALL.into_iter().filter(|kind| kind.field(model).is_some());
    kinds.zip(dipole_plans(model, radii)).fold(outline, |outline, (kind, plan)| {
        let text = format!("{}; about {:.2e} s for a field", plan.in_short_for(model.turn), plan.predicted_seconds);
        outline.line(kind.name(), text).value(kind.name(), plan_values(&plan, model.turn))
    })
}

/// Adds the particles, and their smallest gap if there is memory to place them (infinite for a single sphere).
fn with_particles(outline: Outline, model: &Model, radii: &Radii, gap: Option<&Gap>) -> Outline {
    let fraction = fraction(model, radii);
    let filled = fraction.map_or_else(String::new, |part| format!(", {:.4}% by volume", Number(100.0 * part)));
    let place = match gap {
        None => ", not placed for want of memory".to_owned(),
        Some(gap) if gap.length.is_finite() => format!(", smallest gap {gap}"),
        Some(_) => String::new(),
    };
    let outline = outline
        .line("particles", format_args!("{}{filled}{place}", radii.count()))
        .value("particles", radii.count())
        .value("volume_fraction", fraction);
    let outline = with_groups(outline.value("smallest_gap", gap.map(|gap| gap.length)), "bodies", &model.bodies);
    let rods: Vec<_> = model.filaments.iter().map(|filaments| filaments.rods.clone()).collect();
    with_swimmers(with_groups(outline, "filaments", &rods), model)
}

/// Adds the rigid bodies or filaments, if there are some.
fn with_groups(outline: Outline, name: &'static str, kinds: &[Bodies]) -> Outline {
    if kinds.is_empty() {
        return outline;
    }
    let each = |kind: &Bodies| match kind.spheres.len() {
        1 => format!("{} \"{}\" of one sphere", kind.count, kind.name),
        spheres => format!("{} \"{}\" of {spheres} spheres", kind.count, kind.name),
    };
    let text = kinds.iter().map(each).collect::<Vec<_>>().join(", ");
    outline.line(name, text).value(name, kinds.iter().map(|kind| kind.count).sum::<u64>())
}

/// Adds the species that swim, with their speed and the time in which one alone swims its radius.
fn with_swimmers(outline: Outline, model: &Model) -> Outline {
    let swimming = model.species.iter().filter_map(|species| Some((species, species.swimming.as_ref()?)));
    let values: Vec<Value> =
        swimming.clone().map(|(species, swimming)| swimming_values(model, species, swimming)).collect();
    let lines = swimming.map(|(species, swimming)| swimming_line(model, species, swimming));
    let outline = lines
        .enumerate()
        .fold(outline, |outline, (number, text)| outline.line(if number == 0 { "swimmers" } else { "" }, text));
    if values.is_empty() { outline } else { outline.value("swimmers", values) }
}

/// A species of swimmers as named values.
fn swimming_values(model: &Model, species: &Species, swimming: &Swimming) -> Value {
    let second = swimming.second_mode(species.radius, model.viscosity);
    json!({
        "species": species.name,
        "speed": swimming.speed,
        "first_mode": swimming.first_mode(),
        "second_mode": second,
        "time_per_radius": (swimming.speed > 0.0).then(|| species.radius / swimming.speed),
    })
}

/// A species of swimmers in a line.
fn swimming_line(model: &Model, species: &Species, swimming: &Swimming) -> String {
    let (first, second) = (swimming.first_mode(), swimming.second_mode(species.radius, model.viscosity));
    let name = &species.name;
    if first == 0.0 {
        return format!("\"{name}\" with B2 = {:.4}, alone at rest", Number(second));
    }
    format!(
        "\"{name}\" at the speed {:.4} with beta {:.4}: a time of {:.4} for a radius, {:.4} of a radius in a step",
        Number(swimming.speed),
        Number(second / first),
        Number(species.radius / swimming.speed),
        Number(swimming.speed * model.time_step / species.radius)
    )
}

/// Adds the cost of the boundaries, relative to a periodic box with the same edges.
fn beside_periodic(outline: Outline, model: &Model, cell: &PeriodicBox, planned: &Planned, ranks: Ranks) -> Outline {
    let boundaries = model.cell.boundaries();
    let periodic = Problem { boundaries: Boundaries::Periodic, ..problem_in(cell, model, &planned.radii) };
    let (Ok(periodic), true) = (Plan::choose(&periodic), boundaries != Boundaries::Periodic) else { return outline };
    let memory = |plan: &Plan| memory::need(model, &planned.radii, plan, ranks, 0).resident;
    let times = planned.plan.predicted_seconds / periodic.predicted_seconds;
    let room = memory(&planned.plan) / memory(&periodic);
    let edges = model.user_axes().list(cell.edges().to_array()).map(|edge| Number(edge).to_string()).join(" x ");
    let text = format!(
        "{times:.1} times the time of an evaluation, and {room:.1} times the memory, of a periodic box of {edges}"
    );
    let outline = outline.line(if boundaries.walls() > 0 { "walls" } else { "unbounded" }, text);
    let outline = outline.value("time_over_periodic", times).value("memory_over_periodic", room);
    let near = "spheres that lie in layers on one may err by up to two and a half times the tolerance, in stresslets \
        above all";
    let outline = if boundaries.walls() > 0 { outline.line("", near) } else { outline };
    let follows_them = "the box follows the spheres: time and memory go with the room that they take";
    if follows(boundaries) { outline.line("", follows_them) } else { outline }
}

/// Volume fraction in the box, or in the ball in which the spheres start; `None` in unbounded fluid.
fn fraction(model: &Model, radii: &Radii) -> Option<f64> {
    let ball = model.start.ball().map(sphere::volume);
    let is_open = model.cell.boundaries() == Boundaries::Open;
    ball.or((!is_open).then(|| model.cell.volume())).map(|volume| radii.volume() / volume)
}

/// Adds the card, if there is one to evaluate the far field, and where spheres move.
fn with_card(outline: Outline, card: Option<CardMemory>, model: &Model) -> Outline {
    let Some(memory) = card else { return outline };
    let several = if memory.ranks > 1 { Some("the number of ranks") } else { None };
    let by = several.or(model.moves_on_host_by());
    let place = match by {
        None => "spheres move on the card, from which nothing is copied but what is observed or written".to_owned(),
        Some(by) => format!(
            "spheres move on the host, by {by}: positions are copied to the card and motions back in each evaluation"
        ),
    };
    let (of_run, [total, free]) =
        (memory.bytes.ceil(), [memory.card.total_bytes, memory.card.free_bytes].map(|bytes| bytes as u64));
    outline.line("card", memory.describe()).line("", place).value(
        "card",
        json!({
            "name": memory.card.name,
            "bytes": total,
            "free_bytes": free,
            "expected_bytes": of_run as u64,
            "ranks_on_card": memory.on_card,
            "moves_spheres": by.is_none(),
            "moves_on_host_by": by,
        }),
    )
}

/// Adds the cost of an evaluation and the fastest alternative plans.
fn with_cost(outline: Outline, plan: &Plan, turn: AxisRotation, others: &[Plan]) -> Outline {
    let seconds = plan.predicted_seconds;
    let place = if plan.device == ComputeDevice::Gpu { "the card" } else { "one core" };
    let text = format!("about {seconds:.2e} s on {place} for an evaluation; with dipoles a step takes several");
    let mut outline = outline.line("cost", text).value("seconds_per_evaluation", seconds);
    let others = &others[..others.len().min(RUNNERS_UP)];
    for (number, plan) in others.iter().enumerate() {
        let label = if number == 0 { "instead" } else { "" };
        outline = outline.line(label, format_args!("{:.2e} s: {}", plan.predicted_seconds, plan.in_short_for(turn)));
    }
    outline.value("other_plans", others.iter().map(|plan| plan_values(plan, turn)).collect::<Vec<_>>())
}

/// A plan as named values; `turn` is the rotation from the reader's axes to those of the box.
pub fn plan_values(plan: &Plan, turn: AxisRotation) -> Value {
    let (width, cutoff) = plan.split.map(|Split { width, cutoff }| (width, cutoff)).unzip();
    json!({
        "method": plan.method.name(),
        "width": width,
        "cutoff": cutoff,
        "precision": if plan.precision == Precision::Single { "f32" } else { "f64" },
        "grid": plan.has_grid().then(|| turn.inverse().list(plan.grid)),
        "support": plan.has_grid().then(|| turn.inverse().list(plan.support.along_axes())),
        "tolerance": plan.tolerance,
        "expected_error": plan.predicted_error,
        "iteration_tolerance": plan.iteration_tolerance,
        "expected_seconds": plan.predicted_seconds,
    })
}

impl MemoryForecast {
    fn of(model: &Model, planned: &Planned, asked: Asked) -> Self {
        let needs = memory::needs(model, &planned.radii, &planned.plan, asked.ranks);
        // The first ranks share a machine, and the first of them needs the most memory.
        let together = &needs[..asked.on_a_machine.min(needs.len())];
        let missing = if asked.are_present { None } else { Comm::check_memory_of(together).err() };
        let remedy = memory::advice(model, &planned.radii);
        Self { missing: missing.map(|error| format!("{error}, and `run` would refuse it here; {remedy}")), needs }
    }

    fn add_to(&self, outline: Outline) -> Outline {
        let bytes = |need: &MemoryNeed| readable_bytes(need.resident);
        let others = self.needs.iter().skip(1).max_by(|a, b| a.resident.total_cmp(&b.resident));
        let ranks = match others {
            None => "1 rank".to_owned(),
            Some(others) => {
                format!("the first of {} ranks, {} on each of the others", self.needs.len(), bytes(others))
            }
        };
        let first = self.needs.first().map(bytes).unwrap_or_default();
        outline
            .line("memory", format_args!("about {first} at most on {ranks}"))
            .value("memory_bytes", self.needs.iter().map(|need| need.resident.ceil() as u64).collect::<Vec<_>>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Parameters, Species};
    use domain::Vector;
    use gpu::DeviceInfo;

    /// Text of the lines about a card.
    fn of_card(model: &Model, ranks: usize) -> String {
        let card = DeviceInfo { name: "NVIDIA H200".to_owned(), identity: [7; 16], total_bytes: 1e9, free_bytes: 9e8 };
        let memory = CardMemory { card, bytes: 1e6, ranks, on_card: 1 };
        with_card(Outline::default(), Some(memory), model).to_string()
    }

    #[test]
    fn a_card_moves_spheres_or_the_key_is_named() {
        let model = |boundaries| {
            let cell = PeriodicBox::new(Vector::splat(9.0)).unwrap().with_boundaries(boundaries).unwrap();
            Model::new(Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 2)], 0.01, 1)).unwrap()
        };
        assert!(of_card(&model(Boundaries::Periodic), 1).contains("spheres move on the card"));
        assert!(of_card(&model(Boundaries::Walls), 1).contains("on the host, by box.boundaries"));
        assert!(of_card(&model(Boundaries::Periodic), 2).contains("on the host, by the number of ranks"));
    }
}
