//! Files as other programs write them: the same motion in each, read to the same numbers.

use hpf_recordings::{Mapping, Read, Refusal, inspect, read};
use hpf_sim::Demonstration;
use hpf_sim::task::Unit;

/// Samples of the motion, at 50 Hz.
const COUNT: usize = 51;

fn time(i: usize) -> f64 {
    0.02 * i as f64
}

/// x and y [m] at a sample.
fn path(i: usize) -> [f64; 2] {
    let u = i as f64 / (COUNT - 1) as f64;
    let s = u * u * u * (10.0 - u * (15.0 - 6.0 * u));
    [0.3 * s, 0.1 + 0.2 * (s - s * s)]
}

/// A table with these lines before and after, a row written by `row` for each sample.
fn table(header: &str, row: impl Fn(f64, [f64; 2]) -> String) -> String {
    header.to_owned() + &(0..COUNT).map(|i| row(time(i), path(i)) + "\n").collect::<String>()
}

fn mapping(axes: &[&str]) -> Mapping {
    Mapping { axes: axes.iter().map(|axis| axis.parse().unwrap()).collect(), ..Mapping::default() }
}

#[track_caller]
fn found(bytes: &[u8], mapping: &Mapping) -> Read {
    read(bytes, mapping).unwrap_or_else(|refusal: Refusal| {
        panic!("{:#?}\n{}", refusal.mistakes, refusal.saw.map_or(String::new(), |saw| saw.to_string()))
    })
}

#[track_caller]
fn is_motion(found: &Demonstration, tolerance: f64) {
    assert_eq!(found.time.len(), COUNT);
    for i in 0..COUNT {
        assert!((found.time[i] - time(i)).abs() < 1e-6, "{} at {i}", found.time[i]);
        for (axis, x) in found.axes.iter().zip(path(i)) {
            assert!((axis.position[i] - x).abs() < tolerance, "{} {x} at {i}", axis.position[i]);
        }
    }
}

#[test]
fn separators_decimals_units_and_quotes_are_read() {
    let comma = |x: f64| format!("{x:.6}").replace('.', ",");
    for text in [
        table("time_s,x_m,y_m\n", |t, [x, y]| format!("{t},{x},{y}")),
        table("time_s;x_m;y_m\r\n", |t, [x, y]| format!("{};{};{}\r", comma(t), comma(x), comma(y))),
        table("time_s\tx_m\ty_m\n", |t, [x, y]| format!("{t}\t{x}\t{y}")),
        table("time_s x_m  y_m\n", |t, [x, y]| format!(" {t:10.3} {x:12.8}  {y:12.8}")),
        table("\"time_ms\",\"x_mm\",\"y_cm\"\n", |t, [x, y]| format!("\"{}\",{},{}", 1e3 * t, 1e3 * x, 1e2 * y)),
        table("made by a program\non a Monday, late\n\ntime_s,x_m,y_m\n", |t, [x, y]| format!("{t},{x},{y}")),
        table("time_s,x_m,y_m,\n", |t, [x, y]| format!("{t},{x},{y},")),
        table("# a comment\n# time_s x_m y_m\n", |t, [x, y]| format!("{t} {x} {y}")),
        table("time,x,y\n[ms],[mm],[mm]\n", |t, [x, y]| format!("{},{},{}", 1e3 * t, 1e3 * x, 1e3 * y)),
    ] {
        let first = &text[..60];
        let options = if first.starts_with("time,x,y") { mapping(&["x=x", "y=y"]) } else { Mapping::default() };
        let found = found(text.as_bytes(), &options);
        println!("{first:?}: {:?}", found.notes);
        is_motion(&found.recording, 1e-6);
        let wide: Vec<u8> = [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
        is_motion(&read(&wide, &options).unwrap().recording, 1e-6);
        let marked = format!("\u{feff}{text}");
        is_motion(&read(marked.as_bytes(), &options).unwrap().recording, 1e-6);
    }
}

#[test]
fn a_file_of_other_names_is_looked_into_and_read_by_the_command_that_is_offered() {
    let text = table("stamp,id,px,py,state\n", |t, [x, y]| {
        format!("{},7,{},{},ok", 1_700_000_000_000_000_000_u64 + (1e9 * t) as u64, 1e3 * x, 1e3 * y)
    });
    let refusal = read(text.as_bytes(), &Mapping::default()).unwrap_err();
    let saw = refusal.saw.unwrap();
    let command = saw.command("my file.csv").unwrap();
    assert_eq!(
        command, "hpf imitate 'my file.csv' --time stamp:ns --axis x=px:mm --axis y=py:mm --ignore-rest",
        "{saw}"
    );
    assert!(saw.to_string().contains("its steps of 2.0e7 would be 50 Hz"), "{saw}");
    assert!(saw.to_string().contains("m/s over"), "{saw}");
    let options = Mapping { time: Some("stamp:ns".parse().unwrap()), ..mapping(&["x=px:mm", "y=py:mm"]) };
    is_motion(&found(text.as_bytes(), &options).recording, 1e-9);
    assert_eq!(inspect(text.as_bytes(), &Mapping::default()).unwrap(), *saw);
}

#[test]
fn a_time_of_another_name_is_named_and_the_axes_read_by_theirs() {
    let text = table("when,x_m,y_m,fx\n", |t, [x, y]| format!("{t},{x},{y},1"));
    let time = Some("when:s".parse().unwrap());
    let forces = vec!["x=fx:N".parse().unwrap()];
    let found = found(text.as_bytes(), &Mapping { time, forces, ..Mapping::default() });
    is_motion(&found.recording, 1e-12);
    assert!(found.recording.axes[0].force.is_some() && found.notes.is_empty(), "{:?}", found.notes);
}

#[test]
fn a_table_without_header_is_read_by_numbers_of_columns() {
    let text = table("", |t, [x, y]| format!("{t} {x} {y}"));
    let saw = read(text.as_bytes(), &Mapping::default()).unwrap_err().saw.unwrap();
    assert!(saw.options.as_ref().unwrap().contains("--time '#1:s'"), "{saw}\n{:?}", saw.options);
    let found =
        found(text.as_bytes(), &Mapping { time: Some("#1:s".parse().unwrap()), ..mapping(&["x=#2:m", "y=#3:m"]) });
    is_motion(&found.recording, 1e-12);
}

#[test]
fn a_rate_stands_for_time_and_a_force_has_its_unit() {
    let text = table("x,y,fx\n", |t, [x, y]| format!("{x},{y},{}", 1e-3 * t));
    let options =
        Mapping { sample_rate: Some(50.0), forces: vec!["x=fx:kN".parse().unwrap()], ..mapping(&["x=x:m", "y=y:m"]) };
    let found = found(text.as_bytes(), &options);
    is_motion(&found.recording, 1e-12);
    assert!((found.recording.axes[0].force.as_ref().unwrap()[50] - 1.0).abs() < 1e-12);
}

#[test]
fn presets_read_what_their_programs_write() {
    let preset = |name: &str| Mapping { preset: Some(name.parse().unwrap()), ..Mapping::default() };
    let poses = (0..6).map(|i| format!("actual_TCP_pose_{i} ")).collect::<String>();
    let forces = (0..6).map(|i| format!("actual_TCP_force_{i} ")).collect::<String>();
    let ur = table(&format!("timestamp {poses}{forces}\n"), |t, [x, y]| {
        format!("{} {x} {y} 0.4 0 3.1 0 1 2 3 0 0 0", 1234.5 + t)
    });
    let read = found(ur.as_bytes(), &preset("ur"));
    is_motion(&read.recording, 1e-12);
    assert_eq!(read.recording.axes[1].force.as_ref().unwrap()[3], 2.0);

    let names: String = (0..16).map(|i| format!(",O_T_EE[{i}]")).collect();
    let franka =
        table(&format!("time{names}\n"), |t, [x, y]| format!("{},1,0,0,0,0,1,0,0,0,0,1,0,{x},{y},0.5,1", 1e3 * t));
    is_motion(&found(franka.as_bytes(), &preset("franka")).recording, 1e-12);

    let tum = table("# timestamp tx ty tz qx qy qz qw\n", |t, [x, y]| format!("{:.6} {x} {y} 1.0 0 0 0 1", 1.3e9 + t));
    is_motion(&found(tum.as_bytes(), &preset("tum")).recording, 1e-12);
    let bare = tum.split_once('\n').unwrap().1;
    is_motion(&found(bare.as_bytes(), &preset("tum")).recording, 1e-12);

    let header = "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w []\n";
    let euroc =
        table(header, |t, [x, y]| format!("{},{x},{y},1,1", 1_403_636_580_838_555_648_u64 + (t * 1e9).round() as u64));
    is_motion(&found(euroc.as_bytes(), &preset("euroc")).recording, 1e-12);

    let optitrack = table(
        "Format Version,1.23,Take Name,a,Length Units,Millimeters\n\n,Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n\
         ,Name,tool,tool,tool,tool\n,ID,1,1,1,1\n,,Rotation,Position,Position,Position\nFrame,Time (Seconds),W,X,Y,Z\n",
        |t, [x, y]| format!("{},{t},1,{},{},4", (t * 50.0).round(), 1e3 * x, 1e3 * y),
    );
    is_motion(&found(optitrack.as_bytes(), &preset("optitrack")).recording, 1e-12);

    let lasa = table("", |t, [x, y]| format!("{t} {} {}", 1e3 * x, 1e3 * y));
    let read = found(lasa.as_bytes(), &preset("lasa"));
    is_motion(&read.recording, 1e-12);
    assert_eq!(read.recording.axes[0].unit, Unit::M);
    assert!(
        hpf_recordings::read(lasa.as_bytes(), &preset("ur")).unwrap_err().mistakes[0]
            .message
            .contains("actual_TCP_pose_0")
    );
}

#[test]
fn formats_that_are_not_read_are_refused_by_name_with_the_command_that_converts() {
    for (bytes, words) in [
        (&b"#ROSBAG V2.0\n"[..], "ROS 1"),
        (b"SQLite format 3\0", "rosbags-convert"),
        (b"\x89HDF\r\n\x1a\n", "h5py"),
        (b"MATLAB 5.0 MAT-file", "scipy"),
        (b"PAR1\x15", "read_parquet"),
        (b"\x00\x01\x02", "this is no text"),
    ] {
        let refusal = read(bytes, &Mapping::default()).unwrap_err();
        assert!(refusal.mistakes[0].message.contains(words), "{refusal:?}");
    }
}
