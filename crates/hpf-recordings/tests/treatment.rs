//! What is mended in recordings, by rule and with a note, and what is refused.

use core::f64::consts::{PI, TAU};

use hpf_recordings::{Mapping, Read, read};

fn text(header: &str, rows: impl IntoIterator<Item = (f64, f64)>) -> String {
    let rows: String = rows.into_iter().map(|(t, x)| format!("{t:.9},{x:.9}\n")).collect();
    format!("{header}\n{rows}")
}

/// Minimum jerk from 0 to 0.3 m in 2 s.
fn x(t: f64) -> f64 {
    let u = (t / 2.0).clamp(0.0, 1.0);
    0.3 * u * u * u * (10.0 - u * (15.0 - 6.0 * u))
}

fn at_100_hz() -> Vec<(f64, f64)> {
    (0..=200).map(|i| (0.01 * f64::from(i), x(0.01 * f64::from(i)))).collect()
}

fn plain(rows: &[(f64, f64)]) -> Read {
    read(text("time_s,x_m", rows.iter().copied()).as_bytes(), &Mapping::default()).unwrap()
}

fn refused(rows: &[(f64, f64)]) -> String {
    let text = text("time_s,x_m", rows.iter().copied());
    read(text.as_bytes(), &Mapping::default()).unwrap_err().mistakes[0].to_string()
}

#[track_caller]
fn follows(read: &Read, tolerance: f64) {
    let recording = &read.recording;
    for (t, position) in recording.time.iter().zip(&recording.axes[0].position) {
        assert!((position - x(*t)).abs() < tolerance, "{position} for {} at {t}: {:?}", x(*t), read.notes);
    }
}

#[test]
fn a_clean_recording_is_left_as_it_is() {
    let read = plain(&at_100_hz());
    assert!(read.notes.is_empty(), "{:?}", read.notes);
    follows(&read, 1e-9);
}

#[test]
fn rows_that_stand_twice_are_read_once() {
    let mut rows = at_100_hz();
    rows.insert(50, rows[49]);
    rows.insert(120, rows[119]);
    let read = plain(&rows);
    assert_eq!(read.recording.time.len(), 201);
    assert!(read.notes[0].contains("2 rows repeat the row before, from line 52 on"), "{:?}", read.notes);
}

#[test]
fn receive_times_in_bursts_are_spread_evenly() {
    // Four samples arrive together, within 50 us of the last one.
    let rows: Vec<_> = (0..=200)
        .map(|i| {
            let arrival = 0.04 * f64::from(i / 4) + 0.03 + 1e-5 * f64::from(i % 4);
            (arrival, x(0.01 * f64::from(i)))
        })
        .collect();
    let read = plain(&rows);
    assert!(read.notes[0].contains("time stamps arrive in bursts"), "{:?}", read.notes);
    // A stamp is off by at most 30 ms at 0.28 m/s.
    follows(&read, 0.012);
}

#[test]
fn a_stamp_that_makes_the_tool_jump_is_refused_where_steps_are_uneven() {
    let mut rows: Vec<_> = (0..40)
        .map(|i| {
            let u = f64::from(i) / 39.0;
            let t = 2.0 * u * u;
            (t, x(t))
        })
        .collect();
    rows[20].0 = rows[19].0 + 1e-5;
    let told = refused(&rows);
    assert!(told.starts_with("22: the time rises by") && told.contains("--sample-rate"), "{told}");
}

#[test]
fn held_samples_are_read_once_each() {
    // Measured at 20 Hz, logged at 100 Hz.
    let rows: Vec<_> = (0..=200).map(|i| (0.01 * f64::from(i), x(0.05 * f64::from(i / 5)))).collect();
    let read = plain(&rows);
    assert!(read.notes.iter().any(|note| note.contains("positions are held over 5 rows")), "{:?}", read.notes);
    follows(&read, 1e-9);
    assert!(read.recording.time.len() <= 43);
}

#[test]
fn gaps_at_rest_are_filled_in_and_others_refused() {
    let still: Vec<_> = at_100_hz().into_iter().filter(|(t, _)| *t < 0.001 || *t > 0.1).collect();
    let read = plain(&still);
    assert!(read.notes.iter().any(|note| note.contains("filled in by a cubic")), "{:?}", read.notes);
    assert_eq!(read.recording.time.len(), 201);
    follows(&read, 1e-3);
    let moving: Vec<_> = at_100_hz().into_iter().filter(|(t, _)| !(0.8..1.2).contains(t)).collect();
    assert!(
        refused(&moving).starts_with("82: no sample between lines 81 and 82: 0.41 s, 41 steps"),
        "{}",
        refused(&moving)
    );
}

#[test]
fn a_second_recording_in_the_file_is_refused_with_its_line() {
    let rows = [at_100_hz(), at_100_hz()].concat();
    let told = refused(&rows);
    assert!(told.starts_with("203: ") && told.contains("put it in a file of its own"), "{told}");
}

#[test]
fn a_wrapped_angle_is_followed_over_the_jump() {
    let rows: Vec<_> = (0..100)
        .map(|i| {
            let t = 0.01 * f64::from(i);
            let angle = 2.0 + 3.0 * t;
            (t, (angle + PI).rem_euclid(TAU) - PI)
        })
        .collect();
    let text = text("time_s,yaw_rad", rows);
    let read = read(text.as_bytes(), &Mapping::default()).unwrap();
    assert!(read.notes[0].contains("jumps by a turn, 1 times"), "{:?}", read.notes);
    for (t, angle) in read.recording.time.iter().zip(&read.recording.axes[0].position) {
        assert!((angle - 2.0 - 3.0 * t).abs() < 1e-8);
    }
}

#[test]
fn rest_at_the_ends_is_noted_and_cut_off_where_asked() {
    let rows: Vec<_> = (0..=600).map(|i| (0.01 * f64::from(i), x(0.01 * f64::from(i) - 2.0))).collect();
    let read = plain(&rows);
    assert!(read.notes[0].contains("--trim cuts it off"), "{:?}", read.notes);
    let text = text("time_s,x_m", rows);
    let cut = hpf_recordings::read(text.as_bytes(), &Mapping { trim: true, ..Mapping::default() }).unwrap();
    assert!(cut.recording.duration() < 2.0 && cut.recording.duration() > 1.6, "{}", cut.recording.duration());
    assert_eq!(cut.recording.time[0], 0.0);
}

#[test]
fn rows_without_numbers_are_refused_or_bridged() {
    let mut text = text("time_s,x_m", at_100_hz());
    text = text.replacen(&format!("{:.9}\n", x(1.0)), "nan\n", 1);
    let told = read(text.as_bytes(), &Mapping::default()).unwrap_err().mistakes[0].to_string();
    assert_eq!(told, "102: column `x_m`: nan is not finite");
    let bridged = read(text.as_bytes(), &Mapping { bridge: true, ..Mapping::default() }).unwrap();
    assert_eq!(bridged.recording.time.len(), 200);
    follows(&bridged, 1e-9);
}

#[test]
fn a_hand_that_is_too_fast_for_meters_is_noted() {
    let rows: Vec<_> = at_100_hz().into_iter().map(|(t, x)| (t, 1e3 * x)).collect();
    let read = plain(&rows);
    assert!(read.notes[0].contains("x=COLUMN:mm"), "{:?}", read.notes);
}
