//! Logs in Foxglove's schemas.

use base64::{Engine, engine::general_purpose::STANDARD};
use serde_json::{Value as Json, json};

use super::{
    log_writer::{Kind, Messages},
    robot::{self, MATRIX, SIZE, Truth},
};

fn time(time_ns: i64) -> Json {
    json!({"sec": time_ns / 1_000_000_000, "nsec": time_ns % 1_000_000_000})
}

fn schema(properties: &[&str]) -> String {
    let properties: serde_json::Map<String, Json> =
        properties.iter().map(|name| ((*name).to_owned(), json!({}))).collect();
    json!({"type": "object", "properties": properties}).to_string()
}

/// Returns a walk in JSON.
pub fn json_log(walk: &[Truth], with_schemas: bool) -> Messages {
    let mut messages = Messages::default();
    let kind = |name, properties: &[&str]| {
        Kind::json(name, &if with_schemas { schema(properties) } else { String::new() })
    };
    let picture = kind("foxglove.CompressedImage", &["timestamp", "frame_id", "data", "format"]);
    let lens = kind(
        "foxglove.CameraCalibration",
        &["timestamp", "frame_id", "width", "height", "distortion_model", "D", "K", "R", "P"],
    );
    let vector = json!({"properties": {"x": {}, "y": {}, "z": {}, "w": {}}});
    let properties = json!({"timestamp": {}, "parent_frame_id": {}, "child_frame_id": {}, "translation": vector, "rotation": vector});
    let transforms = json!({"properties": {"transforms": {"items": {"properties": properties}}}}).to_string();
    let frames = Kind::json("foxglove.FrameTransforms", if with_schemas { &transforms } else { "" });
    for (index, truth) in walk.iter().enumerate() {
        let stamp = time(truth.time_ns);
        let data = STANDARD.encode(robot::jpeg(index));
        let json = json!({"timestamp": stamp, "frame_id": "camera", "data": data, "format": "jpeg"});
        messages.add("/camera", &picture, truth.time_ns, json.to_string().into_bytes());
        let json = json!({"timestamp": stamp, "frame_id": "camera", "width": SIZE[0], "height": SIZE[1],
            "distortion_model": "fisheye", "D": [0.1, 0.02, 0.0, 0.0], "K": MATRIX, "R": [], "P": []});
        messages.add("/calibration", &lens, truth.time_ns, json.to_string().into_bytes());
        let turn = truth.level_from_optical(truth.yaw_rad);
        let json = json!({"transforms": [{"timestamp": stamp, "parent_frame_id": "odom", "child_frame_id": "camera",
            "translation": {"x": truth.x_m, "y": truth.y_m, "z": 0.5},
            "rotation": {"x": turn.x, "y": turn.y, "z": turn.z, "w": turn.w}}]});
        messages.add("/tf", &frames, truth.time_ns, json.to_string().into_bytes());
    }
    messages
}

/// Field of a message in protobuf's wire format.
fn field(number: u64, wire: u64, body: &[u8]) -> Vec<u8> {
    let mut bytes = varint(number << 3 | wire);
    if wire == 2 {
        bytes.extend(varint(body.len() as u64));
    }
    bytes.extend(body);
    bytes
}

fn varint(mut value: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
    bytes
}

/// Descriptor of a field: name, number, type, whether it is repeated, name of its message.
type FieldOf<'a> = (&'a str, u64, u64, bool, &'a str);

fn message(name: &str, fields: &[FieldOf<'_>]) -> Vec<u8> {
    let mut bytes = field(1, 2, name.as_bytes());
    for (name, number, kind, is_repeated, of) in fields {
        let label = if *is_repeated { 3 } else { 1 };
        let mut descriptor = [
            field(1, 2, name.as_bytes()),
            field(3, 0, &varint(*number)),
            field(4, 0, &varint(label)),
            field(5, 0, &varint(*kind)),
        ]
        .concat();
        if !of.is_empty() {
            descriptor.extend(field(6, 2, of.as_bytes()));
        }
        bytes.extend(field(2, 2, &descriptor));
    }
    field(4, 2, &bytes)
}

/// Numbers of types in descriptors.
const DOUBLE: u64 = 1;
const INT64: u64 = 3;
const INT32: u64 = 5;
const FIXED32: u64 = 7;
const TEXT: u64 = 9;
const MESSAGE: u64 = 11;
const BYTES: u64 = 12;

fn descriptors() -> Vec<u8> {
    let stamp = ".google.protobuf.Timestamp";
    let google = [
        field(2, 2, b"google.protobuf"),
        message("Timestamp", &[("seconds", 1, INT64, false, ""), ("nanos", 2, INT32, false, "")]),
    ];
    let vector = |name| {
        message(
            name,
            &[("x", 1, DOUBLE, false, ""), ("y", 2, DOUBLE, false, ""), ("z", 3, DOUBLE, false, "")],
        )
    };
    let foxglove = [
        field(2, 2, b"foxglove"),
        vector("Vector3"),
        message(
            "Quaternion",
            &[
                ("x", 1, DOUBLE, false, ""),
                ("y", 2, DOUBLE, false, ""),
                ("z", 3, DOUBLE, false, ""),
                ("w", 4, DOUBLE, false, ""),
            ],
        ),
        message(
            "CompressedImage",
            &[
                ("timestamp", 1, MESSAGE, false, stamp),
                ("frame_id", 4, TEXT, false, ""),
                ("data", 2, BYTES, false, ""),
                ("format", 3, TEXT, false, ""),
            ],
        ),
        message(
            "CameraCalibration",
            &[
                ("timestamp", 1, MESSAGE, false, stamp),
                ("frame_id", 9, TEXT, false, ""),
                ("width", 2, FIXED32, false, ""),
                ("height", 3, FIXED32, false, ""),
                ("distortion_model", 4, TEXT, false, ""),
                ("D", 5, DOUBLE, true, ""),
                ("K", 6, DOUBLE, true, ""),
            ],
        ),
        message(
            "FrameTransform",
            &[
                ("timestamp", 1, MESSAGE, false, stamp),
                ("parent_frame_id", 2, TEXT, false, ""),
                ("child_frame_id", 3, TEXT, false, ""),
                ("translation", 4, MESSAGE, false, ".foxglove.Vector3"),
                ("rotation", 5, MESSAGE, false, ".foxglove.Quaternion"),
            ],
        ),
    ];
    [field(1, 2, &google.concat()), field(1, 2, &foxglove.concat())].concat()
}

fn double(number: u64, value: f64) -> Vec<u8> {
    field(number, 1, &value.to_le_bytes())
}

fn packed(number: u64, values: &[f64]) -> Vec<u8> {
    field(number, 2, &values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>())
}

/// Returns a walk in protobuf.
pub fn protobuf_log(walk: &[Truth]) -> Messages {
    let mut messages = Messages::default();
    let kind = |type_name| Kind {
        type_name,
        message_encoding: "protobuf",
        schema_encoding: "protobuf",
        schema: descriptors(),
    };
    for (index, truth) in walk.iter().enumerate() {
        let stamp = [
            field(1, 0, &varint(truth.time_ns as u64 / 1_000_000_000)),
            field(2, 0, &varint(truth.time_ns as u64 % 1_000_000_000)),
        ];
        let stamp = field(1, 2, &stamp.concat());
        let picture =
            [stamp.clone(), field(4, 2, b"camera"), field(2, 2, &robot::jpeg(index)), field(3, 2, b"jpeg")];
        messages.add("/camera", &kind("foxglove.CompressedImage"), truth.time_ns, picture.concat());
        // One list of numbers packed, one not: both are allowed.
        let lens = [
            stamp.clone(),
            field(2, 5, &SIZE[0].to_le_bytes()),
            field(3, 5, &SIZE[1].to_le_bytes()),
            field(4, 2, b"plumb_bob"),
            packed(6, &MATRIX),
            [0.1, 0.0, 0.0, 0.0, 0.0].map(|value| double(5, value)).concat(),
        ];
        messages.add("/calibration", &kind("foxglove.CameraCalibration"), truth.time_ns, lens.concat());
        let turn = truth.level_from_optical(truth.yaw_rad);
        let transform = [
            stamp,
            field(2, 2, b"odom"),
            field(3, 2, b"camera"),
            field(4, 2, &[double(1, truth.x_m), double(2, truth.y_m), double(3, 0.5)].concat()),
            field(
                5,
                2,
                &[double(1, turn.x), double(2, turn.y), double(3, turn.z), double(4, turn.w)].concat(),
            ),
        ];
        messages.add("/tf", &kind("foxglove.FrameTransform"), truth.time_ns, transform.concat());
    }
    messages
}
