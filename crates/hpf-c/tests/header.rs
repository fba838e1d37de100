//! `include/hpf.h` and `src/f32.rs` are what the sources say; `UPDATE_HEADER=1` writes them.

use std::fs;
use std::path::Path;

/// Generic types of the border, and what C calls them between `hpf_f64_` and `_t`.
const NAMES: [(&str, &str); 10] = [
    ("BasisPolicy", "basis"),
    ("AxisPolicy", "axis_policy"),
    ("Policy", "policy"),
    ("Limits", "limits"),
    ("AxisSettings", "axis_settings"),
    ("Settings", "settings"),
    ("Input", "input"),
    ("AxisOutput", "axis_output"),
    ("Output", "output"),
    ("Instance", "instance"),
];

const TOP: &str = "\
/* The C interface of the HPF controller. Made from the sources of crates/hpf-c; do not edit.
 *
 * Every struct with struct_size and abi_version is prepared by HPF_PREPARE(object). Functions return HPF_OK or the reason
 * of a refusal, hpf_status_text says it in words; a refused call changes nothing but what its comment names. SI units. */";

const HELP: &str = "
/* Sets a struct to zero, and its size and version. */
#define HPF_PREPARE(object) \\
  (memset(&(object), 0, sizeof(object)), (object).struct_size = (uint32_t)sizeof(object), \\
   (object).abi_version = HPF_ABI_VERSION)

/* Upper bounds of hpf_..._size for memory set aside before the program runs; numbers: those of all lists, 2 per function
 * of each basis and, where they are copied, 1 per function, primitive and axis. Use them for arrays of uint64_t. */
#define HPF_F32_BYTES(axes, numbers) (HPF_F32_BYTES_BASE + (axes) * HPF_F32_BYTES_PER_AXIS + (numbers) * 4)
#define HPF_F64_BYTES(axes, numbers) (HPF_F64_BYTES_BASE + (axes) * HPF_F64_BYTES_PER_AXIS + (numbers) * 8)";

/// Compares `path` with what it should hold, or writes it.
fn agrees(path: &str, expected: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    if std::env::var_os("UPDATE_HEADER").is_some() {
        fs::write(&path, expected).unwrap();
    }
    let found = fs::read_to_string(&path).unwrap_or_default();
    assert!(found == expected, "{} is stale: UPDATE_HEADER=1 cargo test -p hpf-c --test header", path.display());
}

fn source(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

#[test]
fn single_precision_has_the_entries_of_double_precision() {
    agrees("src/f32.rs", &source("src/f64.rs").replace("f64", "f32").replace("double precision", "single precision"));
}

#[test]
fn the_header_is_that_of_the_sources() {
    let mut config = cbindgen::Config {
        language: cbindgen::Language::C,
        cpp_compat: true,
        style: cbindgen::Style::Both,
        include_guard: Some("HPF_H".into()),
        header: Some(TOP.into()),
        after_includes: Some(HELP.into()),
        no_includes: true,
        sys_includes: ["stddef.h", "stdint.h", "string.h"].map(String::from).to_vec(),
        documentation_style: cbindgen::DocumentationStyle::C,
        usize_is_size_t: true,
        line_length: 120,
        tab_width: 2,
        ..cbindgen::Config::default()
    };
    for scalar in ["f32", "f64"] {
        for (rust, c) in NAMES {
            config.export.rename.insert(format!("{rust}_{scalar}"), format!("hpf_{scalar}_{c}_t"));
        }
        config.export.rename.insert(format!("Handle_{scalar}"), format!("hpf_{scalar}_controller_t"));
    }
    config.export.rename.insert("Counters".into(), "hpf_counters_t".into());
    config.export.rename.insert("Error".into(), "hpf_error_t".into());
    let mut builder = cbindgen::Builder::new().with_config(config);
    for name in ["status", "abi", "instance", "f64", "f32"] {
        builder = builder.with_src(Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("src/{name}.rs")));
    }
    let mut header = Vec::new();
    builder.generate().unwrap().write(&mut header);
    // C89 knows no line comments, and nothing behind a directive.
    let header = String::from_utf8(header).unwrap();
    let lines = header.lines().map(|line| line.split(" //").next().unwrap_or_default().trim_end());
    agrees("include/hpf.h", &(lines.collect::<Vec<_>>().join("\n") + "\n"));
}
