//! Random valid tasks: the text of a task file from a seed.
//!
//! Everything a task file may hold is drawn, over ranges wider than anybody would use. To let a new key occur, add one
//! line: `text.maybe(dice, "key", |dice| value)` under its table.

use core::fmt::Write as _;

/// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014).
pub struct Dice(u64);

impl Dice {
    /// Dice that fall the same for the same seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0xd134_2543_de82_ef95))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn within(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Every order of magnitude alike.
    fn wide(&mut self, lo: f64, hi: f64) -> f64 {
        self.within(lo.ln(), hi.ln()).exp().clamp(lo, hi)
    }

    fn whole(&mut self, lo: usize, hi: usize) -> usize {
        lo + (self.next() % (hi - lo + 1) as u64) as usize
    }

    fn chance(&mut self, probability: f64) -> bool {
        self.within(0.0, 1.0) < probability
    }

    fn one_of<'a>(&mut self, choices: &[&'a str]) -> &'a str {
        choices[self.whole(0, choices.len() - 1)]
    }

    /// One of some texts, quoted.
    fn name(&mut self, choices: &[&str]) -> String {
        format!("\"{}\"", self.one_of(choices))
    }

    /// A number of basis functions, or a family with it.
    fn basis(&mut self) -> String {
        let count = self.whole(2, 30);
        let family = self.one_of(&["phase", "time"]);
        if self.chance(0.7) { count.to_string() } else { format!("{{ family = \"{family}\", count = {count} }}") }
    }

    /// `scale` times a number from `lo` to `hi`, or what such numbers are drawn from.
    fn quantity(&mut self, scale: f64, lo: f64, hi: f64) -> String {
        let mut numbers = [(); 3].map(|()| scale * self.within(lo, hi));
        numbers.sort_by(f64::total_cmp);
        let [a, b, c] = numbers;
        match self.whole(0, 9) {
            0 if a < c => format!("{{ uniform = [{a:?}, {c:?}] }}"),
            1 => format!("{{ choice = [{a:?}, {b:?}, {c:?}] }}"),
            _ => format!("{b:?}"),
        }
    }

    /// One number for all axes, or one for each.
    fn per_axis(&mut self, axes: usize, mut number: impl FnMut(&mut Self) -> f64) -> String {
        if self.chance(0.5) {
            return format!("{:?}", number(self));
        }
        let numbers: Vec<f64> = (0..axes).map(|_| number(self)).collect();
        format!("{numbers:?}")
    }
}

/// A task file being written.
struct Text(String);

impl Text {
    fn table(&mut self, head: &str) {
        let _ = writeln!(self.0, "\n{head}");
    }

    fn key(&mut self, key: &str, value: impl core::fmt::Display) {
        let _ = writeln!(self.0, "{key} = {value}");
    }

    /// The key, or half of the time nothing.
    fn maybe<V: core::fmt::Display>(&mut self, dice: &mut Dice, key: &str, value: impl FnOnce(&mut Dice) -> V) {
        if dice.chance(0.5) {
            let value = value(dice);
            self.key(key, value);
        }
    }
}

/// The text of task `seed`.
pub fn task(seed: u64) -> String {
    let dice = &mut Dice::new(seed);
    let axes = dice.whole(1, 7);
    let steps = if dice.chance(0.1) { dice.whole(2, 5) } else { dice.whole(6, 150) };
    // No slower than 0.1 Hz: certificates are of forces at most 10 s late.
    let duration = dice.wide(1e-3, 1e4).min(9.0 * steps as f64);
    let mut text = Text(String::new());
    text.key("name", format!("\"random-{seed}\""));
    text.key("duration", format!("{duration:?}"));
    text.key("rate", format!("{:?}", steps as f64 / duration));
    let is_linear: Vec<bool> = (0..axes).map(|_| dice.chance(0.7)).collect();
    let has_goal_scaling = dice.chance(0.5);
    for (i, is_linear) in is_linear.iter().enumerate() {
        text.table("[[axis]]");
        text.key("name", format!("\"q{i}\""));
        text.key("unit", if *is_linear { "\"m\"" } else { "\"rad\"" });
        let start = if dice.chance(0.5) { 0.0 } else { dice.within(-3.0, 3.0) };
        let rest = !has_goal_scaling && dice.chance(0.3);
        let way = if rest { 0.0 } else { dice.wide(1e-5, 1e3) * if dice.chance(0.5) { 1.0 } else { -1.0 } };
        text.key("start", format!("{start:?}"));
        text.key("goal", format!("{:?}", start + way));
    }
    primitives(&mut text, dice, axes, has_goal_scaling);
    let has_contact = environment(&mut text, dice, &is_linear, duration);
    let via_points = if dice.chance(0.4) { dice.whole(1, 4) } else { 0 };
    for _ in 0..via_points {
        text.table("[[via_point]]");
        text.key("time", format!("{:?}", duration * dice.within(1e-3, 1.0)));
        let position: Vec<f64> = (0..axes).map(|_| dice.within(-2.0, 2.0)).collect();
        text.key("position", format!("{position:?}"));
    }
    cost_and_targets(&mut text, dice, axes, has_contact, via_points > 0);
    learning(&mut text, dice, axes);
    text.0
}

fn primitives(text: &mut Text, dice: &mut Dice, axes: usize, has_goal_scaling: bool) {
    text.table("[phase]");
    text.maybe(dice, "decay", |dice| dice.wide(1e-3, 100.0));

    text.table("[movement]");
    text.maybe(dice, "basis", Dice::basis);
    text.maybe(dice, "overlap", |dice| dice.within(1e-3, 0.999));
    text.maybe(dice, "alpha", |dice| dice.per_axis(axes, |dice| dice.wide(1e-3, 1e5)));
    if !has_goal_scaling {
        let amplitude = format!("{{ amplitude = {} }}", dice.per_axis(axes, |dice| dice.wide(1e-3, 100.0)));
        text.key("scaling", if dice.chance(0.5) { "\"unit\"".into() } else { amplitude });
    }
    text.table("[admittance]");
    if dice.chance(0.3) {
        text.key("order", 2);
        text.key("mass", dice.per_axis(axes, |dice| dice.wide(1e-2, 1e3)));
    } else {
        text.maybe(dice, "order", |_| 1);
    }

    for (name, lo, hi) in [("[stiffness]", 1e-3, 1e8), ("[damping]", 1e-3, 1e6)] {
        text.table(name);
        text.maybe(dice, "basis", Dice::basis);
        text.maybe(dice, "overlap", |dice| dice.within(1e-3, 0.999));
        let bounds: Vec<[f64; 3]> = (0..axes)
            .map(|_| {
                let mut bounds = [(); 3].map(|()| dice.wide(lo, hi));
                bounds.sort_by(f64::total_cmp);
                bounds
            })
            .collect();
        for (i, key) in ["min", "initial", "max"].into_iter().enumerate() {
            let numbers: Vec<f64> = bounds.iter().map(|bounds| bounds[i]).collect();
            text.key(key, format!("{numbers:?}"));
        }
    }
}

/// Disturbances and a contact; returns whether there is one.
fn environment(text: &mut Text, dice: &mut Dice, is_linear: &[bool], duration: f64) -> bool {
    for _ in 0..dice.whole(0, 4) {
        text.table("[[disturbance]]");
        let kind = dice.one_of(&["sine", "step", "pulse", "ramp"]);
        text.key("kind", format!("\"{kind}\""));
        text.key("axis", format!("\"q{}\"", dice.whole(0, is_linear.len() - 1)));
        let scale = dice.wide(1.0, 1e4);
        text.key("amplitude", dice.quantity(scale, -1.0, 1.0));
        match kind {
            "sine" => {
                text.key("period", dice.quantity(duration, 0.01, 10.0));
                text.maybe(dice, "phase", |dice| dice.quantity(1.0, -7.0, 7.0));
                text.maybe(dice, "length", |dice| dice.quantity(duration, 0.01, 3.0));
            }
            "step" => text.key("start", dice.quantity(duration, 0.0, 1.2)),
            _ => {
                text.key("start", dice.quantity(duration, 0.0, 1.2));
                text.key("length", dice.quantity(duration, 1e-3, 2.0));
            }
        }
    }
    let linear: Vec<usize> = (0..is_linear.len()).filter(|&i| is_linear[i]).collect();
    let has_contact = !linear.is_empty() && dice.chance(0.5);
    if has_contact {
        text.table("[contact]");
        let axis = linear[dice.whole(0, linear.len() - 1)];
        text.key("axis", format!("\"q{axis}\""));
        if dice.chance(0.5) {
            text.key("kind", "\"cantilever\"");
            text.maybe(dice, "curve", |dice| dice.name(&["tip_load", "moving_load"]));
            text.key("length", dice.wide(0.05, 3.0));
            text.key("width", dice.wide(0.005, 0.2));
            text.key("thickness", dice.wide(0.0005, 0.02));
            text.key("youngs_modulus", dice.wide(1e9, 300e9));
            text.key("force", dice.wide(0.1, 100.0));
            text.maybe(dice, "contact_stiffness", |dice| dice.wide(1.0, 1e12));
            text.maybe(dice, "travel", |dice| dice.name(&["minimum_jerk", "linear"]));
            text.maybe(dice, "from", |dice| dice.within(0.0, 0.04));
        } else {
            text.key("kind", "\"wall\"");
            text.key("position", dice.within(-2.0, 2.0));
            text.key("stiffness", dice.wide(1e-2, 1e12));
            text.maybe(dice, "side", |dice| dice.name(&["above", "below"]));
            text.maybe(dice, "force", |dice| dice.within(0.0, 50.0));
        }
    }
    // A measured contact may be unstable, and then has no finite cost.
    if !has_contact && dice.chance(0.3) {
        text.table("[sensor]");
        text.maybe(dice, "noise", |dice| dice.wide(1e-3, 10.0));
        text.maybe(dice, "bias", |dice| dice.quantity(1.0, -5.0, 5.0));
        text.maybe(dice, "delay", |dice| format!("{:?}", duration * dice.within(0.0, 1.0)));
        text.maybe(dice, "dropout", |dice| dice.within(0.0, 0.9));
        text.maybe(dice, "quantisation", |dice| dice.wide(1e-3, 1.0));
        if dice.chance(0.5) {
            text.table("[actuator]");
            text.key("lag", format!("{:?}", duration * dice.wide(1e-4, 1.0)));
        }
    }
    if dice.chance(0.2) {
        text.table("[recording]");
        text.maybe(dice, "position_noise", |dice| dice.per_axis(is_linear.len(), |dice| dice.wide(1e-6, 1e-2)));
        text.maybe(dice, "force_noise", |dice| dice.per_axis(is_linear.len(), |dice| dice.wide(1e-4, 1.0)));
    }
    has_contact
}

fn cost_and_targets(text: &mut Text, dice: &mut Dice, axes: usize, has_contact: bool, has_via_point: bool) {
    text.table("[cost]");
    text.key("goal", dice.per_axis(axes, |dice| dice.wide(1e-6, 1e9)));
    for key in ["end_velocity", "rest", "acceleration", "stiffness", "damping"] {
        text.maybe(dice, key, |dice| dice.per_axis(axes, |dice| dice.wide(1e-6, 1e4)));
    }
    if has_via_point {
        text.maybe(dice, "via_point", |dice| dice.per_axis(axes, |dice| dice.wide(1e-6, 1e9)));
    }
    if has_contact {
        text.maybe(dice, "tracking", |dice| dice.wide(1e-2, 1e8));
        text.maybe(dice, "contact_force", |dice| dice.wide(1e-4, 1e2));
    }
    text.table("[accept]");
    for (key, has) in [
        ("max_deviation", has_contact),
        ("max_force_error", has_contact),
        ("max_contact_loss", has_contact),
        ("max_via_error", has_via_point),
        ("rms_via_error", has_via_point),
        ("max_goal_error", true),
        ("max_end_speed", true),
        ("max_rest_error", true),
        ("rms_rest_error", true),
        ("max_cost", true),
    ] {
        if has {
            text.maybe(dice, key, |dice| dice.wide(1e-3, 1e6));
        }
    }
}

fn learning(text: &mut Text, dice: &mut Dice, axes: usize) {
    text.table("[learning]");
    let updates = dice.whole(1, 3);
    let rollouts = dice.whole(2, 8);
    text.key("updates", updates);
    text.key("rollouts", rollouts);
    text.key("seed", dice.whole(0, 1 << 40));
    text.maybe(dice, "max_rollouts", |dice| dice.whole(5 * (rollouts + 2), 300));
    // Half of them PI2, whose keys below need it named.
    let method = if dice.chance(0.5) { dice.name(&["gauss-newton", "auto", "cma-es"]) } else { dice.name(&["pi2"]) };
    text.key("method", method);
    text.maybe(dice, "preset", |dice| dice.name(&["pi2", "paper", "pi-bb"]));
    text.maybe(dice, "exploration", |dice| dice.name(&["rollout", "basis", "step"]));
    text.maybe(dice, "anneal", |dice| dice.name(&["none", "linear", "geometric"]));
    text.maybe(dice, "final_noise", |dice| dice.wide(1e-3, 1.0));
    text.maybe(dice, "credit", |dice| dice.name(&["to-go", "total"]));
    text.maybe(dice, "projection", |dice| dice.chance(0.5));
    // Of a stiffer spring a smooth path takes weights that no controller takes: refused by name.
    let alpha = text.0.lines().find_map(|line| line.strip_prefix("alpha = ")).unwrap_or_default();
    let mut alphas = alpha.split(['[', ']', ',', ' ']).filter_map(|number| number.parse::<f64>().ok());
    let is_stiff = alphas.any(|alpha| alpha > 1e3);
    text.maybe(dice, "initial_path", |dice| {
        let path = dice.name(&["pull", "minimum_jerk"]);
        if is_stiff { "\"pull\"".into() } else { path }
    });
    text.maybe(dice, "temperature", |dice| match dice.whole(0, 3) {
        0 => "\"rank\"".to_owned(),
        1 => format!("{{ range = {:?} }}", dice.wide(0.1, 100.0)),
        2 => format!("{{ lambda = {:?} }}", dice.wide(1e-3, 1e3)),
        _ => format!("{{ effective_size = {:?} }}", dice.within(1.0, 10.0)),
    });
    text.maybe(dice, "covariance", |dice| {
        format!("{{ floor = {:?}, ceiling = {:?} }}", dice.wide(1e-3, 1.0), dice.wide(1.0, 100.0))
    });
    text.maybe(dice, "learn", |dice| match dice.whole(0, 3) {
        0 => "[\"goal\", \"stiffness\"]",
        1 => "[\"q0.movement\"]",
        2 => "[\"movement\", \"damping\"]",
        _ => "[\"q0.goal\", \"movement\"]",
    });
    text.maybe(dice, "draws", |dice| dice.whole(1, 5));
    text.maybe(dice, "evaluation_draws", |dice| dice.whole(1, 9));
    text.maybe(dice, "noise.goal", |dice| dice.per_axis(axes, |dice| dice.wide(1e-6, 1.0)));
    text.maybe(dice, "noise.movement", |dice| dice.per_axis(axes, |dice| dice.wide(1e-3, 1e6)));
    text.maybe(dice, "noise.stiffness", |dice| dice.per_axis(axes, |dice| dice.wide(1e-3, 1e7)));
    text.maybe(dice, "noise.damping", |dice| dice.per_axis(axes, |dice| dice.wide(1e-3, 1e7)));
    text.table("[output]");
    text.maybe(dice, "snapshots", |dice| format!("[0, {}]", dice.whole(1, updates)));
}
