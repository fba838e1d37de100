//! A thousand structural changes of valid files: what comes is right, noted or refused, never off by more than a note says.

use hpf_recordings::{Mapping, read};

/// A generator of numbers that is the same everywhere: SplitMix64.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, most: usize) -> usize {
        (self.next() % most as u64) as usize
    }
}

/// x [m] at t [s]: minimum jerk to 0.3 m in 2 s, and a hump of y.
fn path(t: f64) -> [f64; 2] {
    let u = (t / 2.0).clamp(0.0, 1.0);
    let s = u * u * u * (10.0 - u * (15.0 - 6.0 * u));
    [0.3 * s, 0.2 * (s - s * s)]
}

/// How far the position is from the path at its time, at most, where the recording may start `late` [s].
fn error(recording: &hpf_sim::Demonstration, late: f64) -> f64 {
    let axis = |name: &str| recording.axes.iter().position(|axis| axis.name == name);
    let mut most = 0.0_f64;
    for (i, t) in recording.time.iter().enumerate() {
        for (name, x) in ["x", "y"].into_iter().zip(path(t + late)) {
            if let Some(at) = axis(name) {
                most = most.max((recording.axes[at].position[i] - x).abs());
            }
        }
    }
    most
}

#[test]
fn a_thousand_changed_recordings_are_right_noted_or_refused() {
    let mut numbers = Numbers(1);
    let (mut right, mut noted, mut refused) = (0, 0, 0);
    for round in 0..1000 {
        let count = 60 + numbers.below(200);
        let dt = 2.0 / (count - 1) as f64;
        let mut rows: Vec<(f64, [f64; 2])> = (0..count).map(|i| (dt * i as f64, path(dt * i as f64))).collect();
        let mut header = "time_s,x_m,y_m".to_owned();
        let (mut late, mut is_swapped, mut scale) = (0.0, false, [1.0, 1.0, 1.0]);
        let kind = numbers.below(10);
        let at = 2 + numbers.below(count - 4);
        match kind {
            // A few rows cut out.
            0 => drop(rows.drain(at..(at + 1 + numbers.below(20)).min(count - 1))),
            // The start cut off.
            1 => {
                late = rows[at.min(count - 20)].0;
                rows.drain(..at.min(count - 20));
            }
            2 => rows.insert(at, rows[at]),
            3 => rows.swap(at, at - 1),
            // One stamp shifted.
            4 => rows[at].0 += dt * (numbers.below(4000) as f64 / 1000.0 - 2.0),
            // All stamps shifted: time may start anywhere.
            5 => rows.iter_mut().for_each(|row| row.0 += 1000.0),
            6 => {
                header = "x_m,time_s,y_m".into();
                is_swapped = true;
            }
            7 => {
                header = "time_ms,x_mm,y_cm".into();
                scale = [1e3, 1e3, 1e2];
            }
            // A column too few in one row.
            8 => {}
            // Stamps in ns under a name that says s.
            _ => scale[0] = 1e9,
        }
        let mut lines: Vec<String> = rows
            .iter()
            .map(|(t, [x, y])| {
                let [t, x, y] = [t * scale[0], x * scale[1], y * scale[2]].map(|value| format!("{value:.9}"));
                if is_swapped { format!("{x},{t},{y}") } else { format!("{t},{x},{y}") }
            })
            .collect();
        if kind == 8 {
            let line = &mut lines[at];
            line.truncate(line.rfind(',').unwrap());
        }
        let text = format!("{header}\n{}\n", lines.join("\n"));
        match read(text.as_bytes(), &Mapping::default()) {
            Err(refusal) => {
                assert!(refusal.mistakes.iter().all(|mistake| mistake.line > 1), "{round}: {refusal:?}");
                refused += 1;
            }
            Ok(read) => {
                let off = error(&read.recording, late);
                // 0.375 m/s at most: a stamp that is off by less than 0.4 steps is not told from jitter.
                let jitter = 0.29 * 0.4 * dt;
                let bound = match (kind, read.notes.is_empty()) {
                    (4, true) => jitter.max(1e-8),
                    // The note says how far a stamp moved, or that a gap is a guess.
                    (4, false) => jitter + 1e-8,
                    (0, false) => 0.02,
                    _ => 1e-8,
                };
                assert!(off <= bound, "{round}, kind {kind}: off by {off} m, {:?}", read.notes);
                if read.notes.is_empty() { right += 1 } else { noted += 1 }
            }
        }
    }
    println!("{right} right, {noted} noted, {refused} refused");
    assert!(right > 300 && refused > 200, "{right} {noted} {refused}");
}

/// Bytes that tend to break readers.
const NASTY: [&[u8]; 12] = [
    b"nan",
    b"-inf",
    b"1e999",
    b"99999999999999999999",
    b"\"",
    b",",
    b"\n",
    b"\r",
    b"\0",
    b"\xff\xfe",
    b";",
    &[0xff; 8],
];

#[test]
fn no_change_of_a_file_of_any_format_makes_the_reader_fail_otherwise_than_by_a_refusal() {
    let folder = format!("{}/../../fuzz/seeds/demonstrations", env!("CARGO_MANIFEST_DIR"));
    let mut numbers = Numbers(2);
    let mut mappings =
        vec![Mapping::default(), Mapping { ignore_rest: true, sample_rate: Some(50.0), ..Mapping::default() }];
    mappings.push(Mapping {
        time: Some("#1".parse().unwrap()),
        axes: vec!["x=#2:mm".parse().unwrap()],
        bridge: true,
        trim: true,
        ..Mapping::default()
    });
    for (_, preset) in hpf_recordings::PRESETS {
        mappings.push(Mapping { preset: Some(preset), ..Mapping::default() });
    }
    for entry in std::fs::read_dir(folder).unwrap() {
        let seed = std::fs::read(entry.unwrap().path()).unwrap();
        for round in 0..200 {
            let mut bytes = seed.clone();
            for _ in 0..1 + round % 3 {
                let at = numbers.below(bytes.len());
                match numbers.below(4) {
                    0 => bytes[at] ^= 1 << numbers.below(8),
                    1 => bytes.truncate(at.max(1)),
                    2 => drop(bytes.splice(at..at, NASTY[numbers.below(NASTY.len())].iter().copied())),
                    _ => bytes[at] = numbers.next() as u8,
                }
            }
            for mapping in &mappings {
                match read(&bytes, mapping) {
                    Ok(read) => {
                        let time = &read.recording.time;
                        assert!(time.windows(2).all(|pair| pair[0] < pair[1]), "{time:?}");
                        for axis in &read.recording.axes {
                            assert!(axis.position.len() == time.len() && axis.position.iter().all(|x| x.is_finite()));
                        }
                    }
                    Err(refusal) => {
                        assert!(!refusal.mistakes.is_empty());
                        refusal.mistakes.iter().for_each(|mistake| assert!(!mistake.to_string().is_empty()));
                    }
                }
            }
            let _ = hpf_recordings::inspect(&bytes, &Mapping::default()).map(|saw| saw.to_string());
        }
    }
}
