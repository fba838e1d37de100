//! Everything that reads files, fed with the seeds of the fuzz targets and with seeds that were changed at random: what
//! must hold of any bytes is asserted in `hpf::readers`.
//!
//! 200 changed seeds per reader; `PROPTEST_CASES=100000 cargo test --release -p hpf --test readers` tries more.

use std::fs;
use std::path::Path;

use hpf::readers::{ALL, Reader};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::{Config, TestRunner};

/// What tends to break readers.
const NASTY: [&[u8]; 24] = [
    b"nan",
    b"-inf",
    b"1e999",
    b"-1e-320",
    b"-0.0",
    b"0",
    b"-1",
    b"99999999999999999999",
    b"18446744073709551615",
    b"1e300",
    b"0x7fffffffffffffff",
    b"\"",
    b"'''",
    b"[[",
    b"{",
    b",",
    b"\n",
    b"\r\n",
    b"=",
    b"\xef\xbb\xbf",
    b"\xff\xfe",
    b"\0",
    "µ💥".as_bytes(),
    &[0xff; 8],
];

/// The seeds of a reader, by name.
fn seeds(name: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds").join(name);
    let files = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut seeds: Vec<_> = files
        .map(|entry| entry.unwrap().path())
        .map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), fs::read(&path).unwrap()))
        .collect();
    seeds.sort();
    seeds
}

#[test]
fn seeds_are_read_and_those_called_bad_are_refused() {
    for (name, read) in ALL {
        let seeds = seeds(name);
        assert!(seeds.iter().any(|(file, _)| !file.starts_with("bad")), "{name} has nothing to accept");
        for (file, bytes) in seeds {
            assert_eq!(read(&bytes), !file.starts_with("bad"), "{name}/{file}");
        }
    }
}

#[test]
fn shipped_tasks_are_seeds_too() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tasks");
    let task: Reader = ALL[0].1;
    let tasks = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    for path in tasks.filter(|path| path.extension().is_some_and(|extension| extension == "toml")) {
        assert!(task(&fs::read(&path).unwrap()), "{}", path.display());
    }
}

/// One change of some bytes.
#[derive(Clone, Debug)]
enum Change {
    Flip(Index, u8),
    Cut(Index),
    Remove(Index, usize),
    Repeat(Index, usize),
    Insert(Index, &'static [u8]),
    /// The text between two places that hold no digit, point or sign: a number, or what stands beside it.
    Number(Index, &'static [u8]),
}

impl Change {
    fn apply(&self, bytes: &mut Vec<u8>) {
        let count = bytes.len();
        let stretch = |at: &Index, length: usize| {
            let start = at.index(count + 1);
            start..(start + length).min(count)
        };
        match self {
            Self::Flip(at, bits) if count > 0 => bytes[at.index(count)] ^= bits,
            Self::Flip(..) => {}
            Self::Cut(at) => bytes.truncate(at.index(count + 1)),
            Self::Remove(at, length) => drop(bytes.drain(stretch(at, *length))),
            Self::Repeat(at, length) => {
                let again = bytes[stretch(at, *length)].to_vec();
                let place = at.index(count + 1);
                bytes.splice(place..place, again);
            }
            Self::Insert(at, nasty) => drop(bytes.splice(stretch(at, 0), nasty.iter().copied())),
            Self::Number(at, nasty) => {
                let is_number = |byte: &u8| byte.is_ascii_digit() || b".+-e".contains(byte);
                let start = stretch(at, 0).start;
                let start = bytes[start..].iter().position(is_number).map_or(count, |more| start + more);
                let length = bytes[start..].iter().take_while(|byte| is_number(byte)).count();
                bytes.splice(start..start + length, nasty.iter().copied());
            }
        }
    }
}

fn change() -> impl Strategy<Value = Change> {
    let at = any::<Index>;
    prop_oneof![
        (at(), 1..=255_u8).prop_map(|(at, bits)| Change::Flip(at, bits)),
        at().prop_map(Change::Cut),
        (at(), 1..40_usize).prop_map(|(at, length)| Change::Remove(at, length)),
        (at(), 1..200_usize).prop_map(|(at, length)| Change::Repeat(at, length)),
        (at(), select(&NASTY[..])).prop_map(|(at, nasty)| Change::Insert(at, nasty)),
        (at(), select(&NASTY[..])).prop_map(|(at, nasty)| Change::Number(at, nasty)),
    ]
}

#[test]
fn seeds_changed_at_random_break_no_reader() {
    let cases = Config { cases: Config::default().cases.min(200), failure_persistence: None, ..Config::default() };
    let asked = std::env::var("PROPTEST_CASES").is_ok();
    let config = if asked { Config { failure_persistence: None, ..Config::default() } } else { cases };
    for (name, read) in ALL {
        let strategy = (select(seeds(name)), vec(change(), 1..6));
        TestRunner::new(config.clone())
            .run(&strategy, |((_, mut bytes), changes)| {
                changes.iter().for_each(|change| change.apply(&mut bytes));
                read(&bytes);
                Ok(())
            })
            .unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}
