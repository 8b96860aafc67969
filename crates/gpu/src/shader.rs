//! Source of the shaders in `shaders/`, a link to the workspace's folder of that name. Lines `#import shared/….wgsl` are
//! replaced by the files that they name.

/// Lists the files in `shaders/`; a test ensures that the list is complete.
macro_rules! files {
    ($($name:literal),+ $(,)?) => {
        &[$(($name, include_str!(concat!("../shaders/", $name)))),+]
    };
}

/// Every file in `shaders/`, by its path relative to that folder.
pub(crate) const FILES: &[(&str, &str)] = files![
    "alternatives.wgsl",
    "blend.wgsl",
    "blur_columns.wgsl",
    "blur_rows.wgsl",
    "camera_from_ground.wgsl",
    "complete.wgsl",
    "contrast_along_lines.wgsl",
    "cumulate.wgsl",
    "diffuse.wgsl",
    "distance_columns.wgsl",
    "distance_rows.wgsl",
    "half_size.wgsl",
    "halved.wgsl",
    "log_weights.wgsl",
    "luma.wgsl",
    "mask.wgsl",
    "nearness.wgsl",
    "normalise.wgsl",
    "pack.wgsl",
    "predict.wgsl",
    "resample.wgsl",
    "shared/angles.wgsl",
    "shared/blocks.wgsl",
    "shared/camera.wgsl",
    "shared/color.wgsl",
    "shared/filter.wgsl",
    "shared/ground.wgsl",
    "shared/proxy_geometry.wgsl",
    "shared/largest.wgsl",
    "shared/levels.wgsl",
    "shared/picture.wgsl",
    "shared/pose.wgsl",
    "shared/product.wgsl",
    "shared/random.wgsl",
    "shared/scoring.wgsl",
    "shared/texture.wgsl",
    "shared/total.wgsl",
    "sum_along_lines.wgsl",
    "summarise.wgsl",
    "take_unknown.wgsl",
    "whiteness.wgsl",
];

/// Returns a shader with its imports, each included once; `None` if it or one of them does not exist.
pub(crate) fn source(path: &str) -> Option<String> {
    let mut source = String::new();
    import(path, &mut Vec::new(), &mut source)?;
    Some(source)
}

fn import<'a>(path: &'a str, known: &mut Vec<&'a str>, source: &mut String) -> Option<()> {
    if known.contains(&path) {
        return Some(());
    }
    known.push(path);
    let (_, text) = FILES.iter().find(|(name, _)| *name == path)?;
    for line in text.lines() {
        match line.strip_prefix("#import ") {
            Some(imported) => import(imported.trim(), known, source)?,
            None => {
                source.push_str(line);
                source.push('\n');
            }
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeSet, path::Path};

    use naga::valid::{Capabilities, ValidationFlags, Validator};

    use super::*;

    fn files_in(folder: &Path, prefix: &str) -> BTreeSet<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let paths = entries.map(|entry| entry.unwrap().path());
        let (folders, files): (Vec<_>, Vec<_>) = paths.partition(|path| path.is_dir());
        let name = |path: &Path| format!("{prefix}{}", path.file_name().unwrap().to_string_lossy());
        let inner = folders.iter().flat_map(|path| files_in(path, &format!("{}/", name(path))));
        inner.chain(files.iter().map(|path| name(path))).collect()
    }

    #[test]
    fn the_list_of_files_is_complete() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
        let listed: BTreeSet<String> = FILES.iter().map(|(name, _)| (*name).to_owned()).collect();
        assert_eq!(listed, files_in(&folder, ""));
    }

    /// Checks that every header names a function that exists in the file it names.
    #[test]
    fn every_shader_has_a_twin_on_the_cpu() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        for (path, text) in FILES.iter().filter(|(path, _)| !path.starts_with("shared/")) {
            let header: Vec<&str> = text.lines().map_while(|line| line.strip_prefix("//")).collect();
            let words: Vec<&str> = header.iter().flat_map(|line| line.split_whitespace()).collect();
            let file = words.iter().rfind(|word| word.starts_with("crates/")).expect(path);
            let twin = words.iter().rfind(|word| word.starts_with('`')).expect(path);
            let name = twin.trim_matches('`').rsplit("::").next().unwrap();
            let code = std::fs::read_to_string(root.join(file.trim_end_matches('.'))).expect(path);
            assert!(code.contains(&format!("fn {name}(")), "{path}: there is no {twin} in {file}");
            let stem = path.trim_end_matches(".wgsl");
            assert!(
                name == stem || code.to_lowercase().contains(&stem.replace('_', "")),
                "{path}: its twin is {twin}"
            );
        }
    }

    /// Reports all failures at once, each with its path.
    #[test]
    fn every_shader_is_valid_and_has_one_entry_point_of_its_own_name() {
        let mut failures = Vec::new();
        for (path, _) in FILES.iter().filter(|(path, _)| !path.starts_with("shared/")) {
            let source = source(path).unwrap();
            let stem = path.trim_end_matches(".wgsl");
            match naga::front::wgsl::parse_str(&source) {
                Err(error) => failures.push(format!("{path}: {}", error.emit_to_string(&source))),
                Ok(module) => {
                    let names: Vec<&str> =
                        module.entry_points.iter().map(|entry| entry.name.as_str()).collect();
                    if names != [stem] {
                        failures.push(format!("{path}: its entry points are {names:?}"));
                    }
                    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::default());
                    if let Err(error) = validator.validate(&module) {
                        failures.push(format!("{path}: {}", error.emit_to_string(&source)));
                    }
                }
            }
        }
        assert!(failures.is_empty(), "{}", failures.join("\n"));
    }
}
