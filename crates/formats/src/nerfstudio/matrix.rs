//! Poses as nerfstudio's matrices.

use glam::{DMat3, DMat4, DQuat, DVec3, DVec4};
use reality_sim_core::pose::CameraPose;

/// Largest deviation of a rotation's columns from unit length and right angles: files may be rounded to four digits.
const ROTATION_TOLERANCE: f64 = 1e-3;

/// Returns the world's axes from OpenGL's camera axes, row by row.
pub(super) fn rows_of_pose(pose: CameraPose) -> Vec<Vec<f64>> {
    let rotation = pose.rotation_world_from_camera();
    // x right, y up, z backwards; ours are x right, y down, z forwards.
    let (right, up, back) = (rotation.x_axis, -rotation.y_axis, -rotation.z_axis);
    let position = pose.position_in_world();
    let row = |axis: usize| vec![right[axis], up[axis], back[axis], position[axis]];
    vec![row(0), row(1), row(2), vec![0.0, 0.0, 0.0, 1.0]]
}

/// Returns the matrix of three or four rows of four numbers.
pub(super) fn matrix(rows: &[Vec<f64>]) -> Option<DMat4> {
    let mut values = [[0.0; 4], [0.0; 4], [0.0; 4], [0.0, 0.0, 0.0, 1.0]];
    if !(3..=4).contains(&rows.len()) {
        return None;
    }
    for (value, row) in values.iter_mut().zip(rows) {
        *value = row.as_slice().try_into().ok()?;
    }
    let matrix = DMat4::from_cols_array_2d(&values).transpose();
    let is_affine = matrix.is_finite() && values[3] == [0.0, 0.0, 0.0, 1.0];
    is_affine.then_some(matrix)
}

/// Returns the pose of a camera with these OpenGL axes; `None` if the axes are no rotation.
pub(super) fn pose_of_matrix(world_from_opengl: &DMat4) -> Option<CameraPose> {
    let [right, up, back] =
        [world_from_opengl.x_axis, world_from_opengl.y_axis, world_from_opengl.z_axis].map(DVec4::truncate);
    let rotation = DMat3::from_cols(right, -up, -back);
    let deviation = rotation.transpose() * rotation - DMat3::IDENTITY;
    let is_rotation = deviation.to_cols_array().iter().all(|value| value.abs() < ROTATION_TOLERANCE);
    if !is_rotation || rotation.determinant() < 0.0 {
        return None;
    }
    let position: DVec3 = world_from_opengl.w_axis.truncate();
    Some(CameraPose::from_world_from_camera(position, DQuat::from_mat3(&rotation).normalize()))
}
