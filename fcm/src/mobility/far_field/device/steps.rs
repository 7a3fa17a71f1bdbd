//! Measures of displacements of particles that move on a device.

use super::kept_lists::KeptLists;
use crate::mobility::stepping::{
    DisplacementError, DisplacementOrders, DisplacementWeights, GapChanges, HeldSteps, HeldVelocities, Separation,
};
use domain::RemoteList;

impl HeldSteps for KeptLists {
    fn combined(&self, terms: &[(RemoteList, f64)]) -> RemoteList {
        let _ = terms;
        unimplemented!()
    }

    fn displacement_error(&self, columns: &[RemoteList], orders: &DisplacementOrders) -> DisplacementError {
        let _ = (columns, orders);
        unimplemented!()
    }

    fn gap_changes(
        &self,
        velocities: &HeldVelocities,
        orders: &DisplacementOrders,
        least: [f64; 2],
        reach: f64,
    ) -> GapChanges {
        let _ = (velocities, orders, least, reach);
        unimplemented!()
    }

    fn moved_apart(
        &self,
        velocities: &HeldVelocities,
        weights: &DisplacementWeights,
        closest: f64,
        reach: f64,
    ) -> Separation {
        let _ = (velocities, weights, closest, reach);
        unimplemented!()
    }

    fn smallest_relative_gap(&self, reach: f64) -> f64 {
        let _ = reach;
        unimplemented!()
    }
}
