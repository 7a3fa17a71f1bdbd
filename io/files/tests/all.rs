//! Tests of files of runs in one program: each file here has to be a module of it to run.

mod kill;
