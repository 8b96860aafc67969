/// `CameraFromGround`: camera = linear · ground + offset, one row per axis; w of the first row is the height.
struct CameraFromGround {
    x: vec4<f32>,
    y: vec4<f32>,
    z: vec4<f32>,
}
