//! Compares the camera models with OpenCV's own projections.

use glam::{DVec2, DVec3};
use reality_sim_core::camera::{Camera, Distortion, Opencv, OpencvFisheye};

/// Both sides compute in double precision with pixels of a few hundred: only rounding errors remain.
const TOLERANCE_PX: f64 = 1e-9;

struct Row {
    camera: Camera,
    point_in_camera: DVec3,
    pixel: DVec2,
}

fn row(line: &str) -> Row {
    let fields: Vec<&str> = line.split(',').collect();
    let numbers: Vec<f64> = fields[2..].iter().map(|field| field.parse().expect("a number")).collect();
    let [fx, fy, cx, cy, d1, d2, d3, d4, d5, x, y, z, u, v] = numbers[..] else {
        panic!("14 numbers expected in {line}");
    };
    let distortion = match fields[1] {
        "PINHOLE" => Distortion::Pinhole,
        "OPENCV" => Distortion::Opencv(Opencv { k1: d1, k2: d2, p1: d3, p2: d4, k3: d5 }),
        "OPENCV_FISHEYE" => Distortion::OpencvFisheye(OpencvFisheye { k: [d1, d2, d3, d4] }),
        other => panic!("unknown model {other}"),
    };
    Row {
        camera: Camera::new([640, 480], [fx, fy, cx, cy], distortion).expect("a valid camera"),
        point_in_camera: DVec3::new(x, y, z),
        pixel: DVec2::new(u, v),
    }
}

fn rows() -> Vec<Row> {
    let table = include_str!("data/opencv_camera.csv");
    table.lines().filter(|line| !line.starts_with('#')).skip(1).map(row).collect()
}

#[test]
fn projections_are_opencvs() {
    let rows = rows();
    assert_eq!(rows.len(), 700);
    for Row { camera, point_in_camera, pixel } in rows {
        let ours = camera.project_unbounded(point_in_camera).unwrap();
        let error_px = ours.distance(pixel);
        assert!(error_px < TOLERANCE_PX, "{camera:?} at {point_in_camera}: {ours}, OpenCV {pixel}");
    }
}

#[test]
fn opencvs_pixels_lead_back_to_its_points() {
    for Row { camera, point_in_camera, pixel } in rows() {
        let ray = camera.unproject(pixel).unwrap();
        assert!(ray.distance(point_in_camera.normalize_or_zero()) < 1e-9, "{camera:?} at {point_in_camera}");
    }
}
