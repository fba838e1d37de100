//! All tests of hpf-core as one program: the controller is compiled once for every kind of skill, not once per file.

mod adversary;
mod campaign;
mod closed_form;
mod conditioning;
mod contact;
mod controller;
mod domain;
mod energy;
mod exponential;
mod faults;
mod first_order;
mod hour;
mod inertial;
mod lanes;
mod law;
mod limits;
mod long;
mod order;
mod packed;
mod passivity;
mod port;
mod properties;
mod rates;
mod reference;
mod support;
mod tare;
