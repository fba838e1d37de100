//! MCAP files with messages of ROS 2: a table per topic, a row per message.
//!
//! ```text
//! file     magic, records, magic; several files one behind the other are read as one
//! record   kind (1 byte), length (8 bytes), contents; a chunk holds records, packed by zstd or lz4 or not
//! message  CDR, of a type in `ros`; its schema, as ros2msg or ros2idl, is known by its name
//! ```
//! Time is that of the header in a message, not that of its arrival; messages are put in its order. A type without a
//! header has the time of its arrival, with a note. A file that ends in the middle is read to there, with a note.
//!
//! Source: <https://mcap.dev/spec>.

mod cdr;
mod messages;
mod records;

use core::cmp::Ordering;
use std::collections::BTreeMap;

use hpf_sim::task::Task;

use crate::mapping::Mapping;
use crate::mistake::{Mistake, Refusal};
use crate::saw::{Saw, Topic};
use crate::table::{Column, Table};
use crate::text::MAX_CELLS;
use crate::units::{UnitWord, of_word};
use messages::{Row, decode, kind_of};
use records::{Contents, Message};

/// What was read of a topic.
#[derive(Default)]
struct Series {
    kind: String,
    count: usize,
    /// Time of each row [ns].
    times: Vec<i64>,
    rows: Vec<Vec<f64>>,
    names: Vec<(String, &'static str)>,
    has_header: bool,
    /// Why messages are not read.
    why: Option<String>,
}

/// Reads the topic that the mapping names, or the only one with positions.
pub fn read(bytes: &[u8], mapping: &Mapping) -> Result<(Table, Vec<Topic>), Refusal> {
    let mut topics: BTreeMap<String, Series> = BTreeMap::new();
    let wanted: Vec<String> =
        mapping.topic.iter().flat_map(|topics| topics.split(',')).map(|name| name.trim().to_owned()).collect();
    let mut numbers = 0;
    let contents = records::read(bytes, |message| {
        // A frame of a message with several is asked for as topic#frame.
        let is_asked = |name: &String| name.split('#').next() == Some(message.topic);
        if wanted.is_empty() || wanted.iter().any(is_asked) {
            take(&mut topics, message, &mut numbers);
        } else {
            let series = topics.entry(message.topic.to_owned()).or_default();
            series.count += 1;
            message.schema.clone_into(&mut series.kind);
        }
    })
    .map_err(Mistake::whole)?;
    let is_read = |series: &Series| series.why.is_none() && series.rows.len() > 1;
    let listed: Vec<Topic> = topics
        .iter()
        .map(|(name, series)| Topic {
            name: name.clone(),
            kind: series.why.clone().map_or_else(|| series.kind.clone(), |why| format!("{}: {why}", series.kind)),
            count: series.count,
            is_read: is_read(series),
        })
        .collect();
    let refuse = |why: String| {
        let saw = Saw { kind: "an MCAP file".into(), topics: listed.clone(), ..Saw::default() };
        Refusal { saw: Some(Box::new(saw)), ..Refusal::from(Mistake::whole(why)) }
    };
    let names = if wanted.is_empty() { vec![only(&topics).map_err(&refuse)?.to_owned()] } else { wanted };
    let mut tables = Vec::new();
    for name in &names {
        let Some(series) = topics.remove(name) else {
            let known: Vec<&str> = topics.keys().map(String::as_str).collect();
            return Err(refuse(format!("there is no topic `{name}`; there are {}", known.join(", "))));
        };
        if let Some(why) = &series.why {
            return Err(refuse(format!("the topic `{name}` is not read: {why}")));
        }
        if series.rows.len() < 2 {
            return Err(refuse(format!("the topic `{name}` has {} messages: no motion", series.rows.len())));
        }
        tables.push(table(name, series, contents.task.as_deref()));
    }
    let mut tables = tables.into_iter();
    let mut table = tables.next().expect("a topic was chosen");
    for other in tables {
        join(&mut table, &other).map_err(&refuse)?;
    }
    notes(&contents, &mut table);
    Ok((table, listed))
}

/// Takes a message into its topic.
///
/// `numbers` are those of all topics so far: they are kept until it is known which topic is read.
fn take(topics: &mut BTreeMap<String, Series>, message: &Message<'_>, numbers: &mut usize) {
    let mut put = |topic: String, row: Option<Row>, why: Option<String>| {
        let series = topics.entry(topic).or_default();
        series.count += 1;
        if series.kind.is_empty() {
            series.kind = message.schema.to_owned();
        }
        series.why = series.why.take().or(why);
        let Some(row) = row else { return };
        if series.rows.is_empty() {
            series.names = row.names;
            series.has_header = row.stamp.is_some();
        } else if series.names != row.names {
            series
                .why
                .get_or_insert_with(|| "its messages have different fields or joints from message to message".into());
            return;
        }
        *numbers += row.values.len();
        if *numbers > MAX_CELLS {
            let why = || format!("more than {MAX_CELLS} numbers in all topics that are read: name one with --topic");
            series.why.get_or_insert_with(why);
            return;
        }
        series.times.push(row.stamp.unwrap_or(message.log_time as i64));
        series.rows.push(row.values);
    };
    if message.encoding != "cdr" {
        let why = format!("messages in {} are not read, those in cdr are", message.encoding);
        return put(message.topic.to_owned(), None, Some(why));
    }
    if kind_of(message.schema).is_none() {
        return put(message.topic.to_owned(), None, Some("this type is not read".into()));
    }
    match decode(message.schema, message.data) {
        Ok(rows) => {
            for (child, row) in rows {
                let topic =
                    if child.is_empty() { message.topic.to_owned() } else { format!("{}#{child}", message.topic) };
                put(topic, Some(row), None);
            }
        }
        Err(why) => put(message.topic.to_owned(), None, Some(why)),
    }
}

/// The only topic with positions.
fn only(topics: &BTreeMap<String, Series>) -> Result<&str, String> {
    let has_positions = |series: &&Series| {
        series.why.is_none() && series.rows.len() > 1 && kind_of(&series.kind).is_some_and(|kind| kind.has_positions())
    };
    let names: Vec<&str> =
        topics.iter().filter(|(_, series)| has_positions(series)).map(|(name, _)| name.as_str()).collect();
    match names.as_slice() {
        [] => Err("no topic holds positions that are read".into()),
        [one] => Ok(one),
        many => Err(format!("{} topics hold positions: name one with --topic, of {}", many.len(), many.join(", "))),
    }
}

/// `task` is the task of a run whose log this is: it knows the units of its axes.
fn table(topic: &str, mut series: Series, task: Option<&str>) -> Table {
    let mut order: Vec<usize> = (0..series.times.len()).collect();
    let is_sorted = series.times.is_sorted();
    order.sort_by(|a, b| match series.times[*a].cmp(&series.times[*b]) {
        Ordering::Equal => a.cmp(b),
        other => other,
    });
    let start = order.first().map_or(0, |first| series.times[*first]);
    let seconds = order.iter().map(|i| (series.times[*i] - start) as f64 / 1e9).collect();
    let second = of_word("s");
    let mut columns = vec![Column { unit: second, base: start as f64 / 1e9, ..Column::of("time_s", seconds) }];
    let task = task.and_then(|text| Task::parse(text).ok());
    for (at, (name, unit)) in series.names.iter().enumerate() {
        let values = order.iter().map(|i| series.rows[*i][at]).collect();
        let of_task =
            task.iter().flat_map(|task| &task.axis).find(|axis| name.strip_suffix(".position") == Some(&axis.name));
        let unit: Option<UnitWord> = of_word(of_task.map_or(*unit, |axis| axis.unit.symbol()));
        columns.push(Column { unit, ..Column::of(name.clone(), values) });
    }
    series.rows.clear();
    let mut table = Table {
        kind: format!("MCAP, topic {topic} of {}", series.kind),
        topic: topic.into(),
        lines: order.iter().map(|i| *i as u64 + 1).collect(),
        columns,
        is_named: true,
        time: Some(0),
        ..Table::default()
    };
    if !is_sorted {
        table.notes.push(format!("the messages of {topic} are put in the order of the time in their headers"));
    }
    if !series.has_header {
        let kind = series.kind.rsplit('/').next().unwrap_or_default();
        table.notes.push(format!("{kind} has no header: the time of arrival is taken, which may come in bursts"));
    }
    table
}

/// Adds the columns of `other` at the times of `table`, on straight lines between its rows.
fn join(table: &mut Table, other: &Table) -> Result<(), String> {
    // Both times begin at 0: what counts is the stamp, which a base keeps.
    let (times, others) = (&table.columns[0], &other.columns[0]);
    let shift = table_start(table) - table_start(other);
    let (first, last) = (others.values[0], others.values[others.values.len() - 1]);
    let at = |time: f64| time + shift;
    let outside = times.values.iter().filter(|time| !(first..=last).contains(&at(**time))).count();
    if 10 * outside > times.values.len() {
        return Err(format!("{} and {} were recorded at different times", table.topic, other.topic));
    }
    let rows: Vec<(usize, f64)> = times
        .values
        .iter()
        .map(|time| {
            let time = at(*time).clamp(first, last);
            let i = others.values.partition_point(|other| *other <= time).clamp(1, others.values.len() - 1) - 1;
            let length = others.values[i + 1] - others.values[i];
            (i, if length > 0.0 { (time - others.values[i]) / length } else { 0.0 })
        })
        .collect();
    for column in &other.columns[1..] {
        let value = |(i, share): &(usize, f64)| column.values[*i] + share * (column.values[i + 1] - column.values[*i]);
        let name = if table.columns.iter().any(|own| own.name == column.name) {
            format!("{}{}", other.topic, column.name)
        } else {
            column.name.clone()
        };
        table.columns.push(Column { unit: column.unit, ..Column::of(name, rows.iter().map(value).collect()) });
    }
    table.notes.push(format!("{} is brought to the times of {} on straight lines", other.topic, table.topic));
    table.notes.extend(other.notes.iter().cloned());
    Ok(())
}

/// When a table begins [s].
fn table_start(table: &Table) -> f64 {
    table.columns[0].base
}

fn notes(contents: &Contents, table: &mut Table) {
    if contents.is_cut {
        table
            .notes
            .push("the file ends in the middle: what comes before is read (hpf recover makes a whole one)".into());
    }
    if contents.damaged > 0 {
        table.notes.push(format!("{} chunks are damaged and left out: there may be gaps", contents.damaged));
    }
    if contents.orphans > 0 {
        table.notes.push(format!("{} messages of channels that nothing defines are left out", contents.orphans));
    }
    if contents.files > 1 {
        table.notes.push(format!("{} MCAP files one behind the other are read as one", contents.files));
    }
}
