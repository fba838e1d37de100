//! HPF's own messages. `hpf.proto` is their definition: the descriptor in the log is read from it, and a test holds
//! the structs below to its names and numbers.
//!
//! foxglove's `Encode` derive numbers fields by their order, which is no promise to old logs; here numbers are written.

use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet};

/// The definition.
const DEFINITION: &str = include_str!("hpf.proto");

/// `hpf.State`
#[derive(Clone, PartialEq, prost::Message)]
pub struct State {
    #[prost(double, tag = "1")]
    pub time_s: f64,
    #[prost(double, tag = "2")]
    pub phase: f64,
    #[prost(message, repeated, tag = "3")]
    pub linear_axes: Vec<LinearAxis>,
    #[prost(message, repeated, tag = "4")]
    pub rotary_axes: Vec<RotaryAxis>,
    #[prost(message, optional, tag = "5")]
    pub contact: Option<Contact>,
}

/// `hpf.LinearAxis`
#[derive(Clone, PartialEq, prost::Message)]
pub struct LinearAxis {
    #[prost(string, tag = "1")]
    pub name: String,
    #[prost(double, tag = "2")]
    pub reference_position_m: f64,
    #[prost(double, tag = "3")]
    pub reference_velocity_m_per_s: f64,
    #[prost(double, tag = "4")]
    pub position_m: f64,
    #[prost(double, tag = "5")]
    pub velocity_m_per_s: f64,
    #[prost(double, tag = "6")]
    pub force_n: f64,
    #[prost(double, tag = "7")]
    pub stiffness_n_per_m: f64,
    #[prost(double, tag = "8")]
    pub damping_n_s_per_m: f64,
}

/// `hpf.RotaryAxis`
#[derive(Clone, PartialEq, prost::Message)]
pub struct RotaryAxis {
    #[prost(string, tag = "1")]
    pub name: String,
    #[prost(double, tag = "2")]
    pub reference_position_rad: f64,
    #[prost(double, tag = "3")]
    pub reference_velocity_rad_per_s: f64,
    #[prost(double, tag = "4")]
    pub position_rad: f64,
    #[prost(double, tag = "5")]
    pub velocity_rad_per_s: f64,
    #[prost(double, tag = "6")]
    pub torque_n_m: f64,
    #[prost(double, tag = "7")]
    pub stiffness_n_m_per_rad: f64,
    #[prost(double, tag = "8")]
    pub damping_n_m_s_per_rad: f64,
}

/// `hpf.Contact`
#[derive(Clone, PartialEq, prost::Message)]
pub struct Contact {
    #[prost(string, tag = "1")]
    pub axis: String,
    #[prost(double, tag = "2")]
    pub travel_m: f64,
    #[prost(double, tag = "3")]
    pub deflection_m: f64,
    #[prost(double, tag = "4")]
    pub deviation_m: f64,
    #[prost(double, tag = "5")]
    pub contact_force_n: f64,
    #[prost(double, tag = "6")]
    pub set_point_force_n: f64,
}

/// `hpf.Update`
#[derive(Clone, PartialEq, prost::Message)]
pub struct Update {
    #[prost(uint64, tag = "1")]
    pub update: u64,
    #[prost(uint64, tag = "2")]
    pub rollouts: u64,
    #[prost(double, tag = "3")]
    pub total_cost: f64,
    #[prost(double, tag = "4")]
    pub exploration: f64,
    #[prost(double, tag = "5")]
    pub goal_cost: f64,
    #[prost(double, tag = "6")]
    pub end_velocity_cost: f64,
    #[prost(double, tag = "7")]
    pub via_point_cost: f64,
    #[prost(double, tag = "8")]
    pub tracking_cost: f64,
    #[prost(double, tag = "9")]
    pub contact_force_cost: f64,
    #[prost(double, tag = "10")]
    pub acceleration_cost: f64,
    #[prost(double, tag = "11")]
    pub stiffness_cost: f64,
    #[prost(double, tag = "12")]
    pub damping_cost: f64,
    #[prost(double, tag = "13")]
    pub rest_cost: f64,
}

/// The descriptor of every message, as a log carries it.
pub fn descriptor() -> FileDescriptorSet {
    let text: String =
        DEFINITION.lines().flat_map(|line| [line.split("//").next().unwrap_or_default(), "\n"]).collect();
    let mut file = FileDescriptorProto { name: Some("hpf.proto".into()), ..Default::default() };
    for statement in text.split_inclusive([';', '{', '}']) {
        let words: Vec<&str> = statement.split(|c: char| c.is_whitespace() || "=;{\"".contains(c)).collect();
        let words: Vec<&str> = words.into_iter().filter(|word| !word.is_empty()).collect();
        match *words {
            ["syntax", syntax] => file.syntax = Some(syntax.into()),
            ["package", package] => file.package = Some(package.into()),
            ["message", name] => {
                file.message_type.push(DescriptorProto { name: Some(name.into()), ..Default::default() });
            }
            ["repeated", kind, name, number] => add_field(&mut file, Label::Repeated, kind, name, number),
            [kind, name, number] => add_field(&mut file, Label::Optional, kind, name, number),
            _ => {}
        }
    }
    FileDescriptorSet { file: vec![file] }
}

fn add_field(file: &mut FileDescriptorProto, label: Label, kind: &str, name: &str, number: &str) {
    let package = file.package().to_owned();
    let (kind, message) = match kind {
        "double" => (Type::Double, None),
        "uint64" => (Type::Uint64, None),
        "string" => (Type::String, None),
        message => (Type::Message, Some(format!(".{package}.{message}"))),
    };
    let message_type = file.message_type.last_mut().expect("hpf.proto has fields in messages only");
    message_type.field.push(FieldDescriptorProto {
        name: Some(name.into()),
        number: Some(number.parse().expect("hpf.proto numbers every field")),
        label: Some(label.into()),
        r#type: Some(kind.into()),
        type_name: message,
        ..Default::default()
    });
}

#[cfg(test)]
mod tests {
    use hpf_sim::cost::Term;
    use prost::Message;
    use prost::encoding::{WireType, encode_key, encode_varint};

    use super::*;

    fn message(name: &str) -> DescriptorProto {
        let [file] = descriptor().file.try_into().unwrap();
        file.message_type.into_iter().find(|message| message.name() == name).unwrap()
    }

    /// A message made from the definition, where every field holds its own number, reads into the struct by name.
    fn check<M: Message + Default + core::fmt::Debug>(name: &str) {
        let (mut bytes, mut expected) = (Vec::new(), Vec::new());
        for field in message(name).field {
            let number = field.number() as u32;
            match field.r#type() {
                Type::Double => {
                    encode_key(number, WireType::SixtyFourBit, &mut bytes);
                    bytes.extend(f64::from(number).to_le_bytes());
                    expected.push(format!("{}: {number}.0", field.name()));
                }
                Type::Uint64 => {
                    encode_key(number, WireType::Varint, &mut bytes);
                    encode_varint(number.into(), &mut bytes);
                    expected.push(format!("{}: {number}", field.name()));
                }
                Type::String => {
                    encode_key(number, WireType::LengthDelimited, &mut bytes);
                    bytes.extend([1, b'a']);
                    expected.push(format!("{}: \"a\"", field.name()));
                }
                _ => {
                    let inner = field.type_name().trim_start_matches(".hpf.");
                    assert!(!message(inner).field.is_empty());
                    encode_key(number, WireType::LengthDelimited, &mut bytes);
                    bytes.push(0);
                    let default = match inner {
                        "LinearAxis" => format!("{:?}", LinearAxis::default()),
                        "RotaryAxis" => format!("{:?}", RotaryAxis::default()),
                        _ => format!("{:?}", Contact::default()),
                    };
                    expected.push(match field.label() {
                        Label::Repeated => format!("{}: [{default}]", field.name()),
                        _ => format!("{}: Some({default})", field.name()),
                    });
                }
            }
        }
        let read = M::decode(bytes.as_slice()).unwrap();
        assert_eq!(format!("{read:?}"), format!("{name} {{ {} }}", expected.join(", ")));
        assert_eq!(read.encode_to_vec(), bytes, "no field of the struct is missing in the definition");
    }

    #[test]
    fn structs_agree_with_the_definition() {
        check::<State>("State");
        check::<LinearAxis>("LinearAxis");
        check::<RotaryAxis>("RotaryAxis");
        check::<Contact>("Contact");
        check::<Update>("Update");
    }

    #[test]
    fn every_cost_term_has_its_field() {
        let fields: Vec<String> = message("Update").field.into_iter().map(|field| field.name().to_owned()).collect();
        let terms: Vec<String> = Term::NAMES.iter().map(|term| format!("{term}_cost")).collect();
        assert_eq!(fields[4..], terms);
    }

    #[test]
    fn the_descriptor_says_what_it_is() {
        let file = &descriptor().file[0];
        assert_eq!((file.syntax(), file.package(), file.message_type.len()), ("proto3", "hpf", 5));
        assert_eq!(message("State").field[2].type_name(), ".hpf.LinearAxis");
    }
}
