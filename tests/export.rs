//! `hpf export`: what firmware gets is what was learned.

use std::fs;
use std::path::Path;
use std::process::Command;

use hpf_core::packed::Packed;
use hpf_core::{HybridPrimitive, Real};
use hpf_sim::{Family, Policy, Task};

use crate::support::{Columns, expect, folder, hpf, read, root, task};
use crate::waves;

/// A policy of two axes whose weights have no short decimal form, each primitive with a basis of its own, and names that
/// no language takes as they are.
fn policy() -> Policy {
    let task = Task::parse(&read(task("via_point.toml"))).unwrap();
    let mut policy = Policy::initial(&task).unwrap();
    policy.task = "7 \"odd\" */ // `names`\n\\ é??/".into();
    policy.axes[1].name = "\"θ\" */ \\\n??/1".into();
    policy.axes[1].unit = hpf_sim::task::Unit::Rad;
    for (a, axis) in policy.axes.iter_mut().enumerate() {
        let wave = |i: usize, speed: f64| (speed * i as f64 + a as f64).sin();
        axis.movement.weights.iter_mut().enumerate().for_each(|(i, w)| *w = 60.0 * wave(i, 1.1));
        axis.movement.weights[3] = -0.0;
        axis.movement.weights[4] = 1.25e-17;
        axis.stiffness.weights.iter_mut().enumerate().for_each(|(i, w)| *w = 200.0 + 150.0 * wave(i, 0.7));
        axis.damping.weights.iter_mut().enumerate().for_each(|(i, w)| *w = 50.0 + 35.0 * wave(i, 0.9));
        for list in [&mut axis.damping.centers, &mut axis.damping.widths, &mut axis.damping.weights] {
            list.truncate(7);
        }
        axis.stiffness.centers.truncate(12);
        axis.stiffness.widths.truncate(12);
        axis.stiffness.weights.truncate(12);
    }
    policy
}

/// The same task's policy with bases of the time family and a law of second order.
fn policy_in_time() -> Policy {
    let text = read(task("via_point.toml"));
    let text = text.replacen("basis = 20 ", "basis = { family = \"time\" } ", 1);
    let text = text.replacen("basis = 20\n", "basis = { family = \"time\", count = 11 }\n", 1);
    let task = Task::parse(&(text + "\n[admittance]\norder = 2\nmass = [1.5, 0.1]\n")).unwrap();
    waves::policy(&task)
}

/// Writes a policy as policy.json.
fn write(folder: &Path, policy: &Policy) {
    fs::write(folder.join("policy.json"), policy.to_json()).unwrap();
}

/// Every number of a policy, in the order of the C header and of the packed skill: bases, then axis by axis.
fn numbers(policy: &Policy) -> Vec<f64> {
    let first = &policy.axes[0];
    let bases = [
        (&first.movement.centers, &first.movement.widths),
        (&first.stiffness.centers, &first.stiffness.widths),
        (&first.damping.centers, &first.damping.widths),
    ];
    let mut numbers = vec![policy.duration_s, policy.phase.decay];
    bases.iter().for_each(|(centers, widths)| numbers.extend(centers.iter().chain(*widths)));
    let mass = |i: usize| policy.admittance.mass.as_ref().map_or(0.0, |mass| mass[i]);
    for (i, axis) in policy.axes.iter().enumerate() {
        numbers.extend([axis.start, axis.goal, axis.movement.alpha, axis.movement.forcing_scale]);
        numbers.extend(&axis.movement.weights);
        for gain in [&axis.stiffness, &axis.damping] {
            numbers.extend([gain.min, gain.max]);
            numbers.extend(&gain.weights);
        }
        numbers.extend([mass(i), 0.0, 0.0]);
    }
    numbers
}

/// The commands of 600 steps under a force, as bits of doubles.
fn motion<T: Real, S: AsRef<[T]>>(skill: &HybridPrimitive<T, S, 2>) -> Vec<u64> {
    let mut state = skill.initial_state();
    let steps = (0..600).flat_map(|step| {
        let force = [T::of(f64::from(step % 7) - 3.0), T::of(1.5)];
        skill.step(&mut state, force, T::ONE, T::of(0.01))
    });
    let numbers = steps.flat_map(|axis| [axis.position, axis.velocity, axis.stiffness, axis.damping]);
    numbers.map(|number| number.to_f64().to_bits()).collect()
}

/// A program around an exported module that prints what `motion` gives.
const MAIN: &str = r#"
fn main() {
    let skill = exported::policy::skill().unwrap();
    let mut state = skill.initial_state();
    for step in 0..600 {
        let force = [(f64::from(step % 7) - 3.0) as exported::policy::Scalar, 1.5];
        for axis in skill.step(&mut state, force, 1.0, 0.01) {
            for number in [axis.position, axis.velocity, axis.stiffness, axis.damping] {
                #[allow(clippy::unnecessary_cast)]
                let number = number as f64;
                println!("{}", number.to_bits());
            }
        }
    }
}
"#;

/// Builds the exported module in a no_std crate of its own, and runs it.
fn run_rust(folder: &Path) -> Vec<u64> {
    let core = root().join("crates/hpf-core").canonicalize().unwrap();
    let manifest = format!(
        "[package]\nname = \"exported\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n[workspace]\n\n[dependencies]\nhpf-core = {{ path = {:?} }}\n",
        core.display().to_string()
    );
    fs::create_dir(folder.join("src")).unwrap();
    fs::write(folder.join("Cargo.toml"), manifest).unwrap();
    // The versions that the workspace is built with are there without a network.
    fs::copy(root().join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    let lib = "#![no_std]\n#![forbid(unsafe_code)]\n#![deny(warnings, missing_docs)]\n//! Exported.\npub mod policy;\n";
    fs::write(folder.join("src/lib.rs"), lib).unwrap();
    fs::write(folder.join("src/main.rs"), MAIN).unwrap();
    fs::rename(folder.join("policy.rs"), folder.join("src/policy.rs")).unwrap();
    let output = Command::new(std::env::var("CARGO").unwrap_or("cargo".into()))
        .current_dir(folder)
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .args(["run", "--quiet", "--offline"])
        .output()
        .expect("cargo starts");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}\n{}", read(folder.join("src/policy.rs")));
    String::from_utf8(output.stdout).unwrap().lines().map(|line| line.parse().unwrap()).collect()
}

#[test]
fn the_rust_module_builds_without_std_and_steps_to_the_same_bits() {
    for (policy, scalar) in [(policy(), "f64"), (policy(), "f32"), (policy_in_time(), "f64"), (policy_in_time(), "f32")]
    {
        let folder = folder();
        write(folder.path(), &policy);
        let (stdout, _) = expect(0, folder.path(), &["export", "policy.json", "--format", "rust", "--scalar", scalar]);
        assert!(stdout.starts_with("policy.rs: rust, "), "{stdout}");
        let expected = match scalar {
            "f32" => motion(&policy.to_hybrid_of::<f32, 2>().unwrap()),
            _ => motion(&policy.to_hybrid::<2>().unwrap()),
        };
        assert_eq!(run_rust(folder.path()), expected, "{scalar}");
    }
}

/// A program that prints every number of the header, in the order of [`numbers`].
fn printer(prefix: &str, digits: &str) -> String {
    let upper = prefix.to_uppercase();
    let list = |name: &str, count: &str| {
        format!("for (int i = 0; i < {upper}_{count}_BASIS; i++) show({prefix}_{name}[i]);\n")
    };
    let bases: String = ["movement", "stiffness", "damping"]
        .iter()
        .flat_map(|name| ["centers", "widths"].map(|what| list(&format!("{name}_{what}"), &name.to_uppercase())))
        .collect();
    let one = |name: &str| format!("show({prefix}_{name}[a]);\n");
    let mut axis: String = ["start", "goal", "alpha", "forcing_scale"].map(one).concat();
    for name in ["movement", "stiffness", "damping"] {
        if name != "movement" {
            axis += &(one(&format!("{name}_min")) + &one(&format!("{name}_max")));
        }
        axis += &list(&format!("{name}_weights[a]"), &name.to_uppercase());
    }
    axis += &(one("mass") + "show(0.0);\nshow(0.0);\n");
    format!(
        "#include <stdio.h>\n#include \"policy.h\"\n#include \"policy.h\"\n\
         static void show(double x) {{ printf(\"{digits}\\n\", x); }}\n\
         int main(void) {{ show({prefix}_duration); show({prefix}_decay);\n{bases}\
         for (int a = 0; a < {upper}_AXES; a++) {{\n{axis}}}\n\
         for (int a = 0; a < {upper}_AXES; a++) printf(\"%s\\n--\\n\", {prefix}_names[a]);\nreturn 0; }}\n"
    )
}

#[test]
fn the_c_header_compiles_without_warnings_and_has_the_same_numbers() {
    let mut policy = policy();
    policy.admittance = hpf_sim::AdmittancePolicy { order: 2, mass: Some(vec![1.5, 0.1]) };
    for (scalar, digits) in [("f64", "%.17g"), ("f32", "%.9g")] {
        let folder = folder();
        write(folder.path(), &policy);
        expect(0, folder.path(), &["export", "policy.json", "--format", "c", "--scalar", scalar]);
        let header = read(folder.path().join("policy.h"));
        let guard = header.split("#ifndef ").nth(1).and_then(|rest| rest.split("_H\n").next()).unwrap();
        assert!(guard.starts_with("HPF_7__ODD_") && guard.bytes().all(|b| b == b'_' || b.is_ascii_alphanumeric()));
        fs::write(folder.path().join("main.c"), printer(&guard.to_lowercase(), digits)).unwrap();
        let built = Command::new("cc")
            .current_dir(folder.path())
            .args(["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror"])
            .args(["main.c", "-o", "main"])
            .output()
            .expect("cc starts");
        assert!(built.status.success(), "{}\n{header}", String::from_utf8_lossy(&built.stderr));
        let printed = Command::new(folder.path().join("main")).output().unwrap();
        let printed = String::from_utf8(printed.stdout).unwrap();
        let expected = numbers(&policy);
        let (found, names) = printed.split_at(printed.match_indices('\n').nth(expected.len() - 1).unwrap().0 + 1);
        let found = found.lines().map(|line| line.parse::<f64>().unwrap());
        for (found, expected) in found.zip(&expected) {
            match scalar {
                "f32" => assert_eq!((found as f32).to_bits(), (*expected as f32).to_bits()),
                _ => assert_eq!(found.to_bits(), expected.to_bits()),
            }
        }
        assert_eq!(names, format!("{}\n--\n{}\n--\n", policy.axes[0].name, policy.axes[1].name));
    }
}

/// A program in C89 that fills a policy of `hpf.h` and prints every number of it.
fn filler(upper: &str, scalar: &str) -> String {
    let lists = ["movement", "stiffness", "damping"];
    let shown = |of: &str| format!("show(p.{of});\n");
    let mut text: String = ["duration", "decay"].map(shown).concat();
    for name in lists {
        text += &format!(
            "if (p.{name}_basis.family == HPF_BASIS_TIME) show(p.{name}_basis.overlap);\n\
             else for (i = 0; i < p.{name}_basis.count; i++) {{\n\
             show(p.{name}_basis.centers[i]); show(p.{name}_basis.widths[i]); }}\n"
        );
    }
    let mut axis: String =
        ["start", "goal", "alpha", "forcing_scale"].map(|of| shown(&format!("axis[a].{of}"))).concat();
    for of in ["stiffness_min", "stiffness_max", "damping_min", "damping_max"] {
        axis += &shown(&format!("axis[a].{of}"));
    }
    axis += "show(p.axis[a].mass);\n";
    for name in lists {
        axis += &format!("for (i = 0; i < p.{name}_basis.count; i++) show(p.axis[a].{name}_weights[i]);\n");
    }
    format!(
        "#include <stdio.h>\n#include \"hpf.h\"\n#include \"policy.h\"\n\
         static void show(double x) {{ printf(\"%.17g\\n\", x); }}\n\
         int main(void) {{\nhpf_{scalar}_policy_t p;\nuint32_t a, i;\n\
         {upper}_POLICY(p);\n\
         if (p.struct_size != sizeof p || p.abi_version != HPF_ABI_VERSION || p.lists != HPF_LISTS_BORROWED) return 1;\n\
         {text}for (a = 0; a < p.axes; a++) {{\n{axis}}}\nreturn 0; }}\n"
    )
}

#[test]
fn the_c_header_fills_the_policy_of_the_interface() {
    let include = concat!(env!("CARGO_MANIFEST_DIR"), "/../hpf-c/include");
    for policy in [policy(), policy_in_time()] {
        for scalar in ["f64", "f32"] {
            let folder = folder();
            write(folder.path(), &policy);
            expect(0, folder.path(), &["export", "policy.json", "--format", "c", "--scalar", scalar]);
            let header = read(folder.path().join("policy.h"));
            let upper = header.split("#ifndef ").nth(1).and_then(|rest| rest.split("_H\n").next()).unwrap();
            fs::write(folder.path().join("main.c"), filler(upper, scalar)).unwrap();
            let built = Command::new("cc")
                .current_dir(folder.path())
                .args(["-std=c89", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-I", include])
                .args(["main.c", "-o", "main"])
                .output()
                .expect("cc starts");
            assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
            let printed = Command::new(folder.path().join("main")).output().unwrap();
            assert!(printed.status.success());
            let found: Vec<f64> =
                String::from_utf8(printed.stdout).unwrap().lines().map(|line| line.parse().unwrap()).collect();
            let mut expected = vec![policy.duration_s, policy.phase.decay];
            let first = &policy.axes[0];
            let bases = [
                (first.movement.family, &first.movement.centers, &first.movement.widths),
                (first.stiffness.family, &first.stiffness.centers, &first.stiffness.widths),
                (first.damping.family, &first.damping.centers, &first.damping.widths),
            ];
            for (family, centers, widths) in bases {
                match family {
                    Family::Time { overlap } => expected.push(overlap),
                    Family::Phase => expected.extend(centers.iter().zip(widths).flat_map(|(&c, &w)| [c, w])),
                }
            }
            for (i, axis) in policy.axes.iter().enumerate() {
                expected.extend([axis.start, axis.goal, axis.movement.alpha, axis.movement.forcing_scale]);
                expected.extend([axis.stiffness.min, axis.stiffness.max, axis.damping.min, axis.damping.max]);
                expected.push(policy.admittance.mass.as_ref().map_or(0.0, |mass| mass[i]));
                let lists = [&axis.movement.weights, &axis.stiffness.weights, &axis.damping.weights];
                expected.extend(lists.into_iter().flatten());
            }
            if scalar == "f32" {
                expected.iter_mut().for_each(|number| *number = f64::from(*number as f32));
            }
            assert_eq!(found, expected, "{scalar}");
        }
    }
}

/// The skill that the examples in C run, an export of the plain reach, is what `hpf export` writes.
#[test]
fn the_skill_of_the_examples_in_c_is_an_export() {
    let folder = folder();
    let reach = Policy::initial(&Task::parse(&read(task("reach.toml"))).unwrap()).unwrap();
    write(folder.path(), &reach);
    expect(0, folder.path(), &["export", "policy.json", "--format", "c"]);
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("../hpf-c/examples/skill.h");
    let written = read(folder.path().join("policy.h"));
    if std::env::var_os("UPDATE_HEADER").is_some() {
        fs::write(&kept, &written).unwrap();
    }
    let found = fs::read_to_string(&kept).unwrap_or_default();
    assert!(
        found == written,
        "{} is stale: UPDATE_HEADER=1 cargo test -p hpf-cli --test e2e -- export::",
        kept.display()
    );
}

#[test]
fn the_packed_skill_steps_to_the_same_bits_and_is_refused_when_damaged() {
    let (folder, policy) = (folder(), policy());
    write(folder.path(), &policy);
    expect(0, folder.path(), &["export", "policy.json", "--format", "binary"]);
    let bytes = fs::read(folder.path().join("policy.bin")).unwrap();
    let packed = Packed::parse(&bytes).unwrap();
    assert_eq!(packed.values::<f64>().collect::<Vec<_>>(), numbers(&policy));
    assert_eq!((packed.head().functions, packed.head().rotary), ([20, 12, 7], 0b10));
    let mut storage = vec![0.0; packed.head().storage()];
    let expected = motion(&policy.to_hybrid::<2>().unwrap());
    assert_eq!(motion(&packed.skill_in::<f64, 2>(&mut storage).unwrap()), expected);
    for place in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[place] ^= 0x10;
        assert!(Packed::parse(&damaged).is_err() && Packed::parse(&bytes[..place]).is_err(), "{place}");
    }

    let output =
        hpf(folder.path(), &["export", "policy.json", "--format", "postcard", "--scalar", "f32", "--out", "-"]);
    assert!(output.status.success());
    let single = Packed::parse(&output.stdout).unwrap();
    let mut storage = vec![0.0; single.head().storage()];
    let expected = motion(&policy.to_hybrid_of::<f32, 2>().unwrap());
    assert_eq!(motion(&single.skill_in::<f32, 2>(&mut storage).unwrap()), expected);
}

#[test]
fn a_packed_skill_of_the_time_family_steps_to_the_same_bits_and_is_refused_when_it_is_not_one() {
    let (folder, policy) = (folder(), policy_in_time());
    write(folder.path(), &policy);
    expect(0, folder.path(), &["export", "policy.json", "--format", "binary"]);
    let mut bytes = fs::read(folder.path().join("policy.bin")).unwrap();
    let packed = Packed::parse(&bytes).unwrap();
    assert_eq!((packed.head().functions, packed.head().in_time), ([20, 11, 20], [true, true, false]));
    let room = packed.head().storage();
    let mut storage = vec![0.0; room];
    let expected = motion(&policy.to_hybrid::<2>().unwrap());
    assert_eq!(motion(&packed.skill_in::<f64, 2>(&mut storage).unwrap()), expected);
    // A number of the basis that is another one, under a checksum that fits.
    bytes[32 + 8 * 3] ^= 1;
    let body = bytes.len() - 4;
    let sum = hpf_core::packed::crc32(&bytes[..body]).to_le_bytes();
    bytes[body..].copy_from_slice(&sum);
    let refused = Packed::parse(&bytes).unwrap().skill_in::<f64, 2>(&mut storage).unwrap_err().to_string();
    assert!(refused.starts_with("centers must lie in"), "{refused}");

    expect(0, folder.path(), &["export", "policy.json", "--format", "binary", "--scalar", "f32", "--out", "f32.bin"]);
    let single = fs::read(folder.path().join("f32.bin")).unwrap();
    let mut storage = vec![0.0; room];
    let expected = motion(&policy.to_hybrid_of::<f32, 2>().unwrap());
    assert_eq!(motion(&Packed::parse(&single).unwrap().skill_in::<f32, 2>(&mut storage).unwrap()), expected);
}

#[test]
fn exports_name_the_law_and_carry_masses_and_overlaps() {
    let folder = folder();
    write(folder.path(), &policy_in_time());
    // The mass tells: under the law of first order the same gains move otherwise.
    let skill = policy_in_time().to_hybrid::<2>().unwrap();
    assert_ne!(motion(&skill), motion(&skill.clone().with_laws([hpf_core::Law::FirstOrder; 2]).unwrap()));
    expect(0, folder.path(), &["export", "policy.json", "--format", "binary"]);
    let (info, _) = expect(0, folder.path(), &["info", "policy.bin"]);
    assert!(info.contains("law       second order, mass 1.5") && info.contains("second order, mass 0.1"), "{info}");
    let text = |format: &str| expect(0, folder.path(), &["export", "policy.json", "--format", format, "--out", "-"]).0;
    let (rust, c) = (text("rust"), text("c"));
    assert!(rust.contains("pub static MASS: [Scalar; AXES] = [") && rust.contains("MOVEMENT_OVERLAP: Scalar = 0.6;"));
    assert!(rust.contains("second order") && rust.contains("DAMPING_WIDTHS") && !rust.contains("STIFFNESS_WIDTHS"));
    assert!(c.contains("hpf_via_point_mass[HPF_VIA_POINT_AXES] = {\n    1.5, 0.1,"), "{c}");
    assert!(c.contains("hpf_via_point_stiffness_overlap = 0.6;") && c.contains("hpf_via_point_stiffness_falls["));
}

#[test]
fn nothing_is_overwritten_unless_forced() {
    let folder = folder();
    fs::create_dir(folder.path().join("run")).unwrap();
    write(&folder.path().join("run"), &policy());
    let export =
        |code: i32, more: &[&str]| expect(code, folder.path(), &[&["export", "run", "--format", "c"], more].concat());
    let before = read(folder.path().join("run/policy.json"));
    export(0, &[]);
    let header = folder.path().join("run/policy.h");
    assert!(read(&header).contains("#endif"));
    fs::write(&header, "mine").unwrap();
    let (_, stderr) = export(2, &[]);
    assert!(stderr.contains("--force"), "{stderr}");
    assert_eq!(read(&header), "mine");
    export(0, &["--force"]);
    assert!(read(&header).contains("#endif"));
    let (_, stderr) = export(2, &["--out", "run/policy.json", "--force"]);
    assert!(stderr.contains("the policy itself"), "{stderr}");
    let (_, stderr) = export(2, &["--out", "run", "--force"]);
    assert!(stderr.contains("this is a directory"), "{stderr}");
    export(2, &["--out", "-", "--json"]);
    assert_eq!(read(folder.path().join("run/policy.json")), before);
    let (stdout, _) = export(0, &["--out", "there/skill.h", "--json"]);
    let object: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    let length = fs::metadata(folder.path().join("there/skill.h")).unwrap().len();
    assert_eq!((object["form"].as_str(), object["bytes"].as_u64()), (Some("c"), Some(length)));
    let (stdout, _) = export(0, &["--out", "-"]);
    assert_eq!(stdout, read(header));
}

#[test]
fn what_makes_no_skill_in_single_precision_is_refused() {
    let (folder, mut policy) = (folder(), policy());
    for axis in &mut policy.axes {
        axis.movement.centers[1] = 1.0 - 1e-12; // a center of its own in f64 only
    }
    write(folder.path(), &policy);
    for format in ["rust", "c", "binary"] {
        let arguments = ["export", "policy.json", "--format", format, "--scalar"];
        let (_, stderr) = expect(2, folder.path(), &[&arguments[..], &["f32"]].concat());
        assert!(stderr.contains("policy.json: this makes no skill in f32: centers must fall"), "{stderr}");
        expect(0, folder.path(), &[&arguments[..], &["f64"]].concat());
    }
    expect(2, folder.path(), &["export", "missing.json", "--format", "c"]);
    expect(2, folder.path(), &["export", "policy.json"]);
}

#[test]
fn a_run_becomes_a_bag_of_ros_messages() {
    let folder = folder();
    expect(
        0,
        folder.path(),
        &[
            "learn",
            &task("via_point.toml"),
            "--quiet",
            "--set",
            "learning.updates=2",
            "--set",
            "output.snapshots=[]",
            "--set",
            "accept={}",
            "--out",
            "run",
        ],
    );
    let (stdout, _) = expect(0, folder.path(), &["export", "run", "--ros2"]);
    assert!(stdout.starts_with("run/ros2.mcap: ros2, 4902 messages, "), "{stdout}");
    expect(0, folder.path(), &["export", "run/policy.json", "--format", "ros2", "--out", "again.mcap"]);
    let bag = fs::read(folder.path().join("run/ros2.mcap")).unwrap();
    assert!(bag == fs::read(folder.path().join("again.mcap")).unwrap(), "the same run gives the same bytes");

    let summary = mcap::Summary::read(&bag).unwrap().unwrap();
    for channel in summary.channels.values() {
        let schema = channel.schema.as_ref().unwrap();
        assert_eq!(
            (channel.message_encoding.as_str(), schema.encoding.as_str()),
            ("cdr", "ros2msg"),
            "{}",
            channel.topic
        );
        assert!(channel.metadata["offered_qos_profiles"].contains("reliability"), "{}", channel.topic);
    }
    let trajectory = Columns::read(folder.path().join("run/trajectory.csv"));
    let positions = trajectory.column("y_position_m");
    let poses = mcap::MessageStream::new(&bag).unwrap().map(Result::unwrap);
    let poses: Vec<Vec<u8>> = poses
        .filter(|message| message.channel.topic == "/tool/pose")
        .map(|message| message.data.into_owned())
        .collect();
    assert_eq!(poses.len(), positions.len());
    for (pose, position) in poses.iter().zip(positions) {
        // Encapsulation, time, "world" and its end, filled up to 8; then x, y, z and the quaternion.
        let y = f64::from_le_bytes(pose[4 + 24 + 8..][..8].try_into().unwrap());
        assert_eq!((y.to_bits(), pose.len()), (position.to_bits(), 4 + 24 + 7 * 8));
    }

    let (_, stderr) = expect(2, folder.path(), &["export", "run", "--ros2", "--scalar", "f32", "--force"]);
    assert!(stderr.contains("--scalar is for firmware"), "{stderr}");
    fs::create_dir(folder.path().join("alone")).unwrap();
    write(&folder.path().join("alone"), &policy());
    let (_, stderr) = expect(2, folder.path(), &["export", "alone/policy.json", "--ros2"]);
    assert!(stderr.contains("name a run directory"), "{stderr}");
    expect(2, folder.path(), &["export", "run", "--ros2", "--format", "c"]);
}
