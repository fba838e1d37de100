//! All tests of hpf-learn as one program: what they share is compiled and linked once.

mod block;
mod cma_es;
mod fit;
mod gauss_newton;
mod learn;
mod model;
mod pi2;
mod session;
mod starts;
