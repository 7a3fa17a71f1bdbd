//! Tests of scenes in one program: each file here has to be a module of it to run.

mod scenes;
