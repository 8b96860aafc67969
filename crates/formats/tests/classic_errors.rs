//! The four classic errors of exports: a flipped axis, half a pixel, the quaternion's order, the inverse pose. The files are
//! read, and points projected, by code that is written out here and shares nothing with the package; each error, put into
//! the file's numbers, must be seen.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use std::fs;

use common::{Grey, a_pose, cameras, known_points, posed};
use glam::{DVec2, DVec3};
use reality_sim_core::{
    camera::Camera,
    sequence::{StampedPose, write_tum},
};
use reality_sim_formats::{
    colmap::{Encodings, write_colmap},
    nerfstudio::write_nerfstudio,
};
use serde_json::Value;

/// Largest error of an exact export, pixels.
const EXACT_PX: f64 = 1e-6;

/// An error that is put in must be at least this large, pixels: half a pixel is 0.7 along the diagonal.
const SEEN_PX: f64 = 0.4;

/// Lens and pose as a file has them: numbers, with the camera's axes from the world's as rows.
#[derive(Debug, Clone)]
struct Exported {
    model: String,
    focal: [f64; 2],
    /// In pixels whose first one has its centre at (0.5, 0.5).
    center: [f64; 2],
    terms: Vec<f64>,
    rows: [[f64; 3]; 3],
    translation: [f64; 3],
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The rotation matrix of a unit quaternion (Shoemake 1985).
fn rows_of([w, x, y, z]: [f64; 4]) -> [[f64; 3]; 3] {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

fn transposed(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|row| [0, 1, 2].map(|column| m[column][row]))
}

impl Exported {
    /// Projects a point as the format's own documentation has it, to pixels whose first one has its centre at (0, 0).
    fn project(&self, point: DVec3) -> Option<DVec2> {
        let [x, y, z] = [0, 1, 2].map(|row| dot(self.rows[row], point.to_array()) + self.translation[row]);
        let k = |index: usize| self.terms.get(index).copied().unwrap_or(0.0);
        let (a, b) = if self.model == "OPENCV_FISHEYE" {
            let r = (x * x + y * y).sqrt();
            let t = r.atan2(z);
            let bent = t + k(0) * t.powi(3) + k(1) * t.powi(5) + k(2) * t.powi(7) + k(3) * t.powi(9);
            (bent * x / r, bent * y / r)
        } else {
            if z <= 0.0 {
                return None;
            }
            let (u, v) = (x / z, y / z);
            let r2 = u * u + v * v;
            let radial = 1.0 + k(0) * r2 + k(1) * r2 * r2 + k(4) * r2 * r2 * r2;
            (
                u * radial + 2.0 * k(2) * u * v + k(3) * (r2 + 2.0 * u * u),
                v * radial + 2.0 * k(3) * u * v + k(2) * (r2 + 2.0 * v * v),
            )
        };
        Some(DVec2::new(self.focal[0] * a + self.center[0] - 0.5, self.focal[1] * b + self.center[1] - 0.5))
    }

    /// Returns the largest distance from the core's pixels; a point that is not seen at all is far.
    fn error_px(&self, camera: &Camera) -> f64 {
        let points = known_points(camera, a_pose());
        let distance = |(point, pixel): &(DVec3, DVec2)| {
            self.project(*point).map_or(f64::INFINITY, |found| found.distance(*pixel))
        };
        points.iter().map(distance).fold(0.0, f64::max)
    }
}

/// Numbers of a COLMAP text model, from its two files.
fn read_colmap(folder: &std::path::Path) -> (Vec<String>, Vec<f64>) {
    let first = |name: &str| {
        let text = fs::read_to_string(folder.join("sparse/0").join(name)).unwrap();
        text.lines().find(|line| !line.starts_with('#')).unwrap().to_owned()
    };
    let camera: Vec<String> = first("cameras.txt").split(' ').map(str::to_owned).collect();
    let image = first("images.txt");
    (camera, image.split(' ').take(9).map(|field| field.parse().unwrap()).collect())
}

fn of_colmap((camera, image): &(Vec<String>, Vec<f64>)) -> Exported {
    let parameters: Vec<f64> = camera[4..].iter().map(|field| field.parse().unwrap()).collect();
    Exported {
        model: camera[1].clone(),
        focal: [parameters[0], parameters[1]],
        center: [parameters[2], parameters[3]],
        terms: parameters[4..].to_vec(),
        rows: rows_of([image[1], image[2], image[3], image[4]]),
        translation: [image[5], image[6], image[7]],
    }
}

#[test]
fn colmap_projects_as_the_core_does_and_every_classic_error_is_seen() {
    for camera in cameras() {
        let folder = tempfile::tempdir().unwrap();
        let pictures = posed(&camera, &[a_pose()]);
        let written = pictures.write_pictures(&Grey, folder.path(), None, &mut |_| {}).unwrap();
        write_colmap(&written, folder.path(), Encodings { text: true, binary: false }).unwrap();
        let file = read_colmap(folder.path());
        let exact = of_colmap(&file).error_px(&camera);
        assert!(exact < EXACT_PX, "{camera:?}: {exact} px");

        let mutated = |mutate: &dyn Fn(&mut Vec<String>, &mut Vec<f64>)| {
            let (mut lens, mut image) = file.clone();
            mutate(&mut lens, &mut image);
            of_colmap(&(lens, image)).error_px(&camera)
        };
        let half = |lens: &mut Vec<String>, _: &mut Vec<f64>| {
            for field in &mut lens[6..8] {
                *field = (field.parse::<f64>().unwrap() - 0.5).to_string();
            }
        };
        let order = |_: &mut Vec<String>, image: &mut Vec<f64>| image[1..5].rotate_left(1);
        let flip = |_: &mut Vec<String>, image: &mut Vec<f64>| {
            // A turn by 180° about the camera's x axis: OpenGL's axes for OpenCV's. (0, 1, 0, 0) · q.
            let [w, x, y, z] = [image[1], image[2], image[3], image[4]];
            image[1..5].copy_from_slice(&[-x, w, -z, y]);
            image[6] = -image[6];
            image[7] = -image[7];
        };
        let inverse = |_: &mut Vec<String>, image: &mut Vec<f64>| {
            let rows = rows_of([image[1], image[2], image[3], image[4]]);
            let t = [image[5], image[6], image[7]];
            image[5..8].copy_from_slice(&transposed(rows).map(|row| -dot(row, t)));
            image[2..5].iter_mut().for_each(|part| *part = -*part);
        };
        for (name, error) in [
            ("half a pixel", mutated(&half)),
            ("quaternion order", mutated(&order)),
            ("axis flip", mutated(&flip)),
            ("inverse pose", mutated(&inverse)),
        ] {
            assert!(error > SEEN_PX, "{name}: {error} px");
        }
    }
}

fn of_nerfstudio(file: &Value) -> Exported {
    let number = |key: &str| file[key].as_f64().unwrap_or(0.0);
    let fisheye = ["k1", "k2", "k3", "k4"].map(number).to_vec();
    let brown = ["k1", "k2", "p1", "p2", "k3"].map(number).to_vec();
    let model = file["camera_model"].as_str().unwrap().to_owned();
    let matrix = &file["frames"][0]["transform_matrix"];
    let at = |row: usize, column: usize| matrix[row][column].as_f64().unwrap();
    // The columns are the camera's x, y (up) and z (backwards) in the world.
    let axis = |column: usize, sign: f64| [0, 1, 2].map(|row| sign * at(row, column));
    let rows = [axis(0, 1.0), axis(1, -1.0), axis(2, -1.0)];
    let place = axis(3, 1.0);
    Exported {
        terms: if model == "OPENCV_FISHEYE" { fisheye } else { brown },
        model,
        focal: [number("fl_x"), number("fl_y")],
        center: [number("cx"), number("cy")],
        rows,
        translation: rows.map(|row| -dot(row, place)),
    }
}

#[test]
fn nerfstudio_projects_as_the_core_does_and_every_classic_error_is_seen() {
    for camera in cameras() {
        let folder = tempfile::tempdir().unwrap();
        let pictures = posed(&camera, &[a_pose()]);
        let written = pictures.write_pictures(&Grey, folder.path(), None, &mut |_| {}).unwrap();
        write_nerfstudio(&written, folder.path()).unwrap();
        let text = fs::read_to_string(folder.path().join("transforms.json")).unwrap();
        let file: Value = serde_json::from_str(&text).unwrap();
        let exact = of_nerfstudio(&file).error_px(&camera);
        assert!(exact < EXACT_PX, "{camera:?}: {exact} px");

        let matrix_of = |file: &Value| -> Vec<Vec<f64>> {
            serde_json::from_value(file["frames"][0]["transform_matrix"].clone()).unwrap()
        };
        let with_matrix = |matrix: Vec<Vec<f64>>| {
            let mut file = file.clone();
            file["frames"][0]["transform_matrix"] = serde_json::to_value(matrix).unwrap();
            of_nerfstudio(&file).error_px(&camera)
        };
        let mut half = file.clone();
        half["cx"] = (file["cx"].as_f64().unwrap() - 0.5).into();
        half["cy"] = (file["cy"].as_f64().unwrap() - 0.5).into();
        let mut flipped = matrix_of(&file);
        for row in &mut flipped[..3] {
            row[1] = -row[1];
            row[2] = -row[2];
        }
        let matrix = matrix_of(&file);
        let mut inverse = matrix.clone();
        for row in 0..3 {
            for column in 0..3 {
                inverse[row][column] = matrix[column][row];
            }
            inverse[row][3] = -(0..3).map(|other| matrix[other][row] * matrix[other][3]).sum::<f64>();
        }
        // A matrix has no quaternion: reading it column by column is the same mistake.
        let mut order = matrix.clone();
        for row in 0..3 {
            for column in 0..3 {
                order[row][column] = matrix[column][row];
            }
        }
        for (name, error) in [
            ("half a pixel", of_nerfstudio(&half).error_px(&camera)),
            ("axis flip", with_matrix(flipped)),
            ("inverse pose", with_matrix(inverse)),
            ("order of the matrix", with_matrix(order)),
        ] {
            assert!(error > SEEN_PX, "{name}: {error} px");
        }
    }
}

/// A TUM file has no lens: the test's own, at the camera's numbers.
fn of_tum(row: &[f64], camera: &Camera) -> Exported {
    let world_from_camera = rows_of([row[7], row[4], row[5], row[6]]);
    let rows = transposed(world_from_camera);
    Exported {
        model: camera.distortion.colmap_name().to_owned(),
        focal: [camera.fx, camera.fy],
        center: [camera.cx + 0.5, camera.cy + 0.5],
        terms: camera.distortion.parameters(),
        rows,
        translation: rows.map(|axis| -dot(axis, [row[1], row[2], row[3]])),
    }
}

#[test]
fn tum_projects_as_the_core_does_and_every_classic_error_is_seen() {
    let camera = &cameras()[3];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("poses.tum");
    write_tum(&path, &[StampedPose { timestamp_s: 1.5, pose: a_pose() }]).unwrap();
    let text = fs::read_to_string(path).unwrap();
    let line = text.lines().find(|line| !line.starts_with('#')).unwrap();
    let row: Vec<f64> = line.split(' ').map(|field| field.parse().unwrap()).collect();
    let exact = of_tum(&row, camera).error_px(camera);
    assert!(exact < EXACT_PX, "{exact} px");

    let mutated = |mutate: &dyn Fn(&mut Vec<f64>)| {
        let mut row = row.clone();
        mutate(&mut row);
        of_tum(&row, camera).error_px(camera)
    };
    let order = mutated(&|row| row[4..8].rotate_right(1));
    // q · (0, 1, 0, 0): a turn about the camera's own x axis, with w last.
    let flip = mutated(&|row| {
        let [x, y, z, w] = [row[4], row[5], row[6], row[7]];
        row[4..8].copy_from_slice(&[w, z, -y, -x]);
    });
    let inverse = mutated(&|row| {
        let rows = transposed(rows_of([row[7], row[4], row[5], row[6]]));
        let place = [row[1], row[2], row[3]];
        row[1..4].copy_from_slice(&rows.map(|axis| -dot(axis, place)));
        row[4..7].iter_mut().for_each(|part| *part = -*part);
    });
    for (name, error) in [("quaternion order", order), ("axis flip", flip), ("inverse pose", inverse)] {
        assert!(error > SEEN_PX, "{name}: {error} px");
    }
}
