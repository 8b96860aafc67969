//! Model by which a camera was corrected: `[corrected]`, a table of its own behind the camera's text, so that nobody corrects it
//! twice.

/// Name of the table, and of its key.
const TABLE: &str = "corrected";
const MODEL: &str = "model";

/// Returns the text of a camera's file with the text of the model by which the camera was corrected.
pub fn camera_with_model(camera: &str, model: &str) -> String {
    format!("{camera}\n[{TABLE}]\n{MODEL} = {}\n", toml::Value::String(model.to_owned()))
}

/// Returns the text of the model in the text of a camera's file, if there is one.
pub fn model_of_camera(camera: &str) -> Option<String> {
    let table: toml::Table = camera.parse().ok()?;
    Some(table.get(TABLE)?.get(MODEL)?.as_str()?.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_of_several_lines_is_read_back() {
        let model = "# effects\n[[effect]]\nid = \"mount_pitch\"  # \"quoted\"\npitch_rad = 0.01\n";
        let camera = camera_with_model("fx = 1.0\n[mount]\nheight_m = 0.5\n", model);
        assert_eq!(model_of_camera(&camera).as_deref(), Some(model));
        assert_eq!(model_of_camera("fx = 1.0\n"), None);
    }
}
