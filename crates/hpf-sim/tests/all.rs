//! All tests of hpf-sim as one program: what they share is compiled and linked once.

mod batch;
mod continuous;
mod controlled;
mod cost;
mod docs;
mod draws;
mod environment;
mod generator;
mod imitation;
mod inertial;
mod learned_parts;
mod learning_cases;
mod model;
mod optimum;
mod policy;
mod process;
mod random_tasks;
mod rest;
mod robot;
mod signals;
mod sizes;
mod solver;
mod stepped;
mod task;
mod time_family;
mod waves;
