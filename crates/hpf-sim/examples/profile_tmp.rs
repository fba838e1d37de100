//! profile
use std::time::Instant;
use hpf_learn::*;
use hpf_sim::{Policy, Simulation, Task};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let k: usize = args.get(1).map_or(20, |a| a.parse().unwrap());
    let threads: usize = args.get(2).map_or(1, |a| a.parse().unwrap());
    let updates = 600;
    let task = Task::parse(include_str!("../../../tasks/cantilever.toml")).unwrap();
    let policy = Policy::initial(&task).unwrap();
    let sim = Simulation::new(&task, &policy).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let options = Pi2Options { rollouts: k, updates, ..task.learning.pi2_options() };
        for _ in 0..5 {
            let start = Instant::now();
            let h = learn(&sim, policy.weights(), options, None, |_| true).unwrap();
            let all = start.elapsed().as_secs_f64();
            let mut learner = Pi2::new(sim.blocks(), sim.steps(), policy.weights(), options);
            let mut batch = Batch::default();
            let mut costs = vec![Cost::default(); k];
            let mut w = sim.workspace();
            let mut t = [1.0f64; 4];
            for _ in 0..updates {
                let s = Instant::now();
                learner.ask_into(&mut batch);
                t[0] = t[0].min(s.elapsed().as_secs_f64());
                let s = Instant::now();
                let params: Vec<_> = (0..k).map(|i| batch.sample(i)).collect();
                sim.rollouts(Draws::Update(0), &params, &mut w, &mut costs);
                t[1] = t[1].min(s.elapsed().as_secs_f64());
                let s = Instant::now();
                learner.tell(&batch, &costs).unwrap();
                t[2] = t[2].min(s.elapsed().as_secs_f64());
                let s = Instant::now();
                let mut c = Cost::default();
                Problem::rollout(&sim, Draws::HeldOut, Parameters::Constant(learner.weights()), &mut w, &mut c);
                t[3] = t[3].min(s.elapsed().as_secs_f64());
            }
            println!("learn {:.1} ms best {} | us/update: ask {:.1} roll {:.1} tell {:.1} eval {:.1}", all * 1e3, h.best.total, t[0] * 1e6, t[1] * 1e6, t[2] * 1e6, t[3] * 1e6);
        }
    });
}
