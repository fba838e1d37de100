//! The layouts of Foxglove and PlotJuggler name what is in a log.

use std::collections::BTreeSet;

use prost_reflect::{DescriptorPool, DynamicMessage, Kind, ReflectMessage as _, Value};

use crate::support::{expect, folder, json, read, root};

/// Linear axes, a rotary one and a contact: all that a log can have.
const TASK: &str = r#"
    name = "all"
    duration = 1.0
    rate = 100.0
    axis = [{ name = "x", start = 0.0, goal = 0.1 }, { name = "y", start = 0.0, goal = 0.032 },
        { name = "yaw", unit = "rad", start = 0.0, goal = 1.0 }]
    stiffness = { initial = 100.0, min = 30.0, max = 400.0 }
    damping = { initial = 50.0, min = 10.0, max = 100.0 }
    contact = { kind = "cantilever", axis = "y", length = 0.8, width = 0.05, thickness = 0.004, youngs_modulus = 200e9,
        force = 10.0 }
    cost = { tracking = 1e7, goal = 1e4 }
    learning = { updates = 3, rollouts = 3 }
"#;

/// Every topic of a log, and every number in it by its path, as `/topic.field[0].number`.
struct Contents {
    topics: BTreeSet<String>,
    numbers: BTreeSet<String>,
}

impl Contents {
    fn of(log: &[u8]) -> Self {
        let mut contents = Self { topics: BTreeSet::new(), numbers: BTreeSet::new() };
        for message in mcap::MessageStream::new(log).unwrap() {
            let message = message.unwrap();
            let schema = message.channel.schema.as_ref().unwrap();
            contents.topics.insert(message.channel.topic.clone());
            if schema.encoding == "protobuf" {
                let pool = DescriptorPool::decode(schema.data.as_ref()).unwrap();
                let kind = pool.get_message_by_name(&schema.name).unwrap();
                let decoded = DynamicMessage::decode(kind, message.data.as_ref()).unwrap();
                contents.collect(&message.channel.topic, &Value::Message(decoded));
            }
        }
        contents
    }

    fn collect(&mut self, path: &str, value: &Value) {
        match value {
            Value::Message(message) => {
                for field in message.descriptor().fields() {
                    let is_absent = matches!(field.kind(), Kind::Message(_)) && !message.has_field(&field);
                    if field.is_list() || !is_absent {
                        self.collect(&format!("{path}.{}", field.name()), &message.get_field(&field));
                    }
                }
            }
            Value::List(list) => {
                list.iter().enumerate().for_each(|(i, value)| self.collect(&format!("{path}[{i}]"), value));
            }
            value if value.as_f64().is_some() || value.as_u64().is_some() => drop(self.numbers.insert(path.to_owned())),
            _ => {}
        }
    }
}

fn contents() -> Contents {
    let folder = folder();
    std::fs::write(folder.path().join("all.toml"), TASK).unwrap();
    expect(0, folder.path(), &["learn", "all.toml", "--quiet", "--out", "all"]);
    Contents::of(&std::fs::read(folder.path().join("all/log.mcap")).unwrap())
}

#[test]
fn every_topic_and_field_of_the_layouts_is_in_a_log() {
    let contents = contents();
    let foxglove = json(root().join("layouts/foxglove.json"));
    let panels = foxglove["configById"].as_object().unwrap();
    let mut named = 0;
    for (id, panel) in panels {
        for path in panel["paths"].as_array().into_iter().flatten() {
            let path = path["value"].as_str().unwrap();
            assert!(contents.numbers.contains(path), "foxglove.json, {id}: no {path} in a log");
            named += 1;
        }
        let topics = panel["topics"].as_object().into_iter().flat_map(|topics| topics.keys().map(String::as_str));
        for topic in topics.chain(panel["topicToRender"].as_str()) {
            assert!(contents.topics.contains(topic), "foxglove.json, {id}: no {topic} in a log");
            named += 1;
        }
    }
    assert!(named > 25, "{named}");

    let plotjuggler = read(root().join("layouts/plotjuggler.xml"));
    let between = |start: &str, end: &str| -> Vec<String> {
        plotjuggler.split(start).skip(1).map(|rest| rest.split(end).next().unwrap().to_owned()).collect()
    };
    let made = between("<snippet name=\"", "\"");
    let numbers: BTreeSet<String> = contents.numbers.iter().map(|path| path.replace('.', "/")).collect();
    let curves = [between("<curve name=\"", "\""), between("<linked_source>", "<")].concat();
    for curve in &curves {
        assert!(numbers.contains(curve) || made.contains(curve), "plotjuggler.xml: no {curve} in a log");
    }
    assert!(curves.len() > 25, "{}", curves.len());
}

#[test]
fn the_layout_of_foxglove_shows_each_of_its_panels_once() {
    let foxglove = json(root().join("layouts/foxglove.json"));
    let mut shown = Vec::new();
    let mut rest = vec![&foxglove["layout"]];
    while let Some(node) = rest.pop() {
        match node.as_str() {
            Some(panel) => shown.push(panel.to_owned()),
            None => rest.extend([&node["first"], &node["second"]]),
        }
    }
    shown.sort();
    let mut panels: Vec<String> = foxglove["configById"].as_object().unwrap().keys().cloned().collect();
    panels.sort();
    assert_eq!(shown, panels);
}
