//! Foxglove's schemas, in JSON, protobuf and CDR.

use serde_json::{Value as Json, json};

use super::{
    Ros, assert_like,
    cdr::{Value, text},
    foxglove_logs::{json_log, protobuf_log},
    import,
    log_writer::Kind,
    options,
    robot::{self, SIZE, walk},
};
use reality_sim_formats::import::ImportOptions;

#[test]
fn json_is_read_with_its_schema_and_by_its_name() {
    let walk = walk(10);
    for with_schemas in [true, false] {
        let imported =
            import(&json_log(&walk, with_schemas), &ImportOptions { height_m: None, ..options() }).unwrap();
        assert_like(&imported, &walk);
        assert_eq!(imported.report.camera_model, Some("OPENCV_FISHEYE"));
        assert_eq!(imported.sequence.setup.mount_height_m, 0.5);
        assert_eq!(std::fs::read(imported.sequence.image_path(3).unwrap()).unwrap(), robot::jpeg(3));
    }
}

#[test]
fn protobuf_is_read_by_its_descriptors() {
    let walk = walk(10);
    let imported = import(&protobuf_log(&walk), &ImportOptions { height_m: None, ..options() }).unwrap();
    assert_like(&imported, &walk);
    assert_eq!(imported.sequence.setup.camera.distortion.parameters()[0], 0.1);
}

#[test]
fn foxglove_s_schemas_are_read_in_cdr() {
    let walk = walk(5);
    let definition = "builtin_interfaces/Time timestamp\nstring frame_id\nuint8[] data\nstring format\n\
        ================================================================================\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec";
    let mut messages = super::with_imu(&walk);
    for (index, truth) in walk.iter().enumerate() {
        let picture = Value::All(vec![
            robot::header(truth.time_ns, "camera"),
            Value::Bytes(robot::jpeg(index)),
            text("jpeg"),
        ]);
        messages.ros("/fox", "foxglove_msgs/msg/CompressedImage", definition, truth.time_ns, &picture);
    }
    assert_like(
        &import(&messages, &ImportOptions { image: Some("/fox".to_owned()), ..options() }).unwrap(),
        &walk,
    );
}

#[test]
fn recordings_of_hulks_are_read_by_their_definitions() {
    let walk = walk(5);
    let string = json!({"kind": "string"});
    let number = |name: &str| json!({"kind": "primitive", "name": name});
    let named = |name: &str| json!({"kind": "struct_ref", "type": name});
    let bytes = json!({"kind": "sequence", "length": {"kind": "dynamic"}, "element": number("u8")});
    let structure = |fields: &[(&str, Json)]| json!({"kind": "struct", "fields": fields.iter().map(|(name, shape)| json!({"name": name, "shape": shape})).collect::<Vec<_>>()});
    let definition = json!({"root": named("types::StereoImagePair"), "definitions": {
        "types::StereoImagePair": structure(&[("frame_identifier", number("u32")), ("left", named("ros2::Image")), ("right", named("ros2::Image"))]),
        "ros2::Image": structure(&[("header", named("ros2::Header")), ("height", number("u32")), ("width", number("u32")),
            ("encoding", string), ("is_bigendian", number("u8")), ("step", number("u32")), ("data", bytes)]),
        "ros2::Header": structure(&[("stamp", named("ros2::Time")), ("frame_id", json!({"kind": "string"}))]),
        "ros2::Time": structure(&[("sec", number("i32")), ("nanosec", number("u32"))]),
    }});
    let kind = Kind {
        type_name: "types::StereoImagePair",
        message_encoding: "ros-z-cdr",
        schema_encoding: "ros-z-schema-json",
        schema: definition.to_string().into_bytes(),
    };
    let mut messages = super::with_imu(&walk);
    for (index, truth) in walk.iter().enumerate() {
        let grey = |value: u8| {
            robot::raw(truth, "camera", "mono8", SIZE[0], vec![value; (SIZE[0] * SIZE[1]) as usize])
        };
        let pair = Value::All(vec![Value::U32(index as u32), grey(40 + index as u8), grey(200)]);
        messages.add("inputs/stereo_image_pair", &kind, truth.time_ns, super::encode(&pair, false));
    }
    let options = ImportOptions { image: Some("inputs/stereo_image_pair".to_owned()), ..options() };
    let imported = import(&messages, &options).unwrap();
    assert_like(&imported, &walk);
    assert_eq!(imported.sequence.load_image(2).unwrap().get_pixel(5, 5).0, [42; 3]);
}
