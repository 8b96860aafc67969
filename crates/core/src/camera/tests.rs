use super::Camera as _Camera;
#[test]
fn x() {}
