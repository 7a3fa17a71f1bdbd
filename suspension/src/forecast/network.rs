//! The network in the outline of a scene.

use super::scaling::NODE;
use super::summary::{Asked, plan_values};
use crate::evaluation::prepared::Planned;
use crate::flow::open_cell::follows;
use crate::model::Model;
use crate::start::plan::problem;
use domain::Number;
use fcm::{Network, Plan, Problem};
use simulation::Outline;

/// Adds the time of an evaluation on the ranks of the scene's network. If the scene has none, and the ranks fill more
/// than a node of those assumed: the plan for such a network, if it is another.
pub(super) fn with_network(outline: Outline, model: &Model, planned: &Planned, asked: Asked) -> Outline {
    let (plan, kinds) = (&planned.plan, planned.radii.kinds());
    let seconds = |network: &Network, plan: &Plan| network.evaluation(plan, kinds);
    if let Some(network) = model.hydrodynamics.network {
        let on_them = seconds(&network, plan);
        let of_work = 1.0 - network.seconds(plan.traffic(kinds, network.ranks)) / on_them;
        let text = format!(
            "planned for {} ranks that send {:.3} GB/s each: {on_them:.2e} s for an evaluation, {:.0}% of it work",
            network.ranks,
            Number(network.bandwidth / 1e9),
            100.0 * of_work
        );
        return outline.line("network", text).value("seconds_with_network", on_them);
    }
    let ranks = asked.ranks;
    if ranks.count * ranks.threads <= NODE.cores || follows(model.cell.boundaries()) || !plan.has_grid() {
        return outline;
    }
    let network = NODE.network(ranks.count, ranks.threads);
    let best = Plan::choose(&Problem { network: Some(network), ..problem(model, &planned.radii) });
    let Some(best) = best.ok().filter(|best| best != plan) else { return outline };
    let Network { ranks, threads, bandwidth, latency } = network;
    let key =
        format!("{{ ranks = {ranks}, threads = {threads}, bandwidth = {bandwidth:.3e}, latency = {latency:.1e} }}");
    outline
        .line(
            "network",
            format_args!(
                "on {ranks} ranks {:.2e} s for an evaluation, but {:.2e} s with {}:",
                seconds(&network, plan),
                seconds(&network, &best),
                best.in_short_for(model.turn)
            ),
        )
        .line("", format_args!("set hydrodynamics.network = {key}"))
        .value("seconds_with_network", seconds(&network, plan))
        .value("plan_for_network", plan_values(&best, model.turn))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Hydrodynamics, Parameters, Species};
    use domain::{PeriodicBox, Vector};
    use hydrodynamics::memory::Ranks;

    /// Outline for four million spheres at 12%.
    fn outlined(count: usize, network: Option<Network>) -> serde_json::Value {
        let cell = PeriodicBox::new(Vector::splat(518.7)).unwrap();
        let hydrodynamics = Hydrodynamics { network, ..Hydrodynamics::default() };
        let species = vec![Species::new("spheres", 1.0, 4_000_000)];
        let model = Model::new(Parameters { hydrodynamics, ..Parameters::new(cell, 1.0, species, 0.1, 10) }).unwrap();
        let planned = Planned::of_model(&model).unwrap().unwrap();
        let asked = Asked { ranks: Ranks { count, threads: 1 }, on_a_machine: 1, are_present: false };
        let outline = with_network(Outline::default(), &model, &planned, asked);
        outline.value("grid", planned.plan.grid[0]).to_json()
    }

    #[test]
    fn many_ranks_are_told_of_a_plan_for_their_network() {
        assert!(outlined(40, None).get("plan_for_network").is_none());
        let many = outlined(512, None);
        let of_plan = many["plan_for_network"]["grid"][0].as_u64().unwrap();
        assert!(of_plan < many["grid"].as_u64().unwrap(), "{many}");
        let set = outlined(512, Some(NODE.network(512, 1)));
        assert_eq!(set["grid"].as_u64(), Some(of_plan));
        assert!(set["seconds_with_network"].as_f64() < many["seconds_with_network"].as_f64());
    }
}
