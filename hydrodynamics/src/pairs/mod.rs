//! Lubrication, contacts and springs of near pairs as one sparse symmetric resistance.

pub mod assembly;
pub mod beams;
pub mod contacts;
pub mod device_tables;
pub mod lists;
pub mod lubrication;
pub mod matrix;
pub mod search;
pub mod slip;
pub mod squeezed;
pub mod surface_laws;
pub mod walls;
