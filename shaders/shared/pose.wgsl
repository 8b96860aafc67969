/// `CameraFromGround`: camera = linear · ground + offset, a row an axis; w of the first row is the height.
struct CameraFromGround {
    x: vec4<f32>,
    y: vec4<f32>,
    z: vec4<f32>,
}
