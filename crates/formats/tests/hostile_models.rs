//! Damaged models: no panic, no hang, no allocation by a number that the file merely claims. `PROPTEST_CASES` sets how many.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use std::{fs, path::Path};

use common::{Grey, a_pose, cameras, field, posed};
use proptest::prelude::*;
use reality_sim_core::sequence::CameraSetup;
use reality_sim_formats::{
    ModelImport,
    colmap::{Encodings, read_colmap, read_colmap_as_sequence, write_colmap},
    frame_table::FrameTable,
    mapped_table::read_table_as_sequence,
    nerfstudio::{read_nerfstudio_as_sequence, write_nerfstudio},
};

const FILES: [&str; 5] = [
    "sparse/0/cameras.bin",
    "sparse/0/images.bin",
    "sparse/0/cameras.txt",
    "sparse/0/images.txt",
    "transforms.json",
];

/// A change of a file's bytes.
#[derive(Debug, Clone)]
enum Damage {
    Set(prop::sample::Index, u8),
    Cut(prop::sample::Index),
    Insert(prop::sample::Index, Vec<u8>),
    Huge(prop::sample::Index),
}

fn damage() -> impl Strategy<Value = Damage> {
    prop_oneof![
        (any::<prop::sample::Index>(), any::<u8>()).prop_map(|(at, byte)| Damage::Set(at, byte)),
        any::<prop::sample::Index>().prop_map(Damage::Cut),
        (any::<prop::sample::Index>(), prop::collection::vec(any::<u8>(), 1..12))
            .prop_map(|(at, bytes)| Damage::Insert(at, bytes)),
        any::<prop::sample::Index>().prop_map(Damage::Huge),
    ]
}

impl Damage {
    fn apply(&self, bytes: &mut Vec<u8>) {
        if bytes.is_empty() {
            return;
        }
        match self {
            Self::Set(at, byte) => {
                let at = at.index(bytes.len());
                bytes[at] = *byte;
            }
            Self::Cut(at) => bytes.truncate(at.index(bytes.len())),
            Self::Insert(at, more) => {
                let at = at.index(bytes.len());
                bytes.splice(at..at, more.iter().copied());
            }
            Self::Huge(at) => {
                let at = at.index(bytes.len());
                bytes[at..].iter_mut().take(8).for_each(|byte| *byte = 0xff);
            }
        }
    }
}

fn model(folder: &Path) {
    let pictures = posed(&cameras()[3], &[a_pose(), a_pose()]);
    let written = pictures.write_pictures(&Grey, folder, None, &mut |_| {}).unwrap();
    write_colmap(&written, folder, Encodings { text: true, binary: true }).unwrap();
    write_nerfstudio(&written, folder).unwrap();
}

thread_local! {
    static MODEL: tempfile::TempDir = {
        let folder = tempfile::tempdir().unwrap();
        model(folder.path());
        folder
    };
}

fn read_damaged(file: &str, damages: &[Damage]) {
    MODEL.with(|whole| {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join("sparse/0")).unwrap();
        for name in FILES {
            // Binary files would be preferred.
            if file.ends_with(".txt") && name.ends_with(".bin") {
                continue;
            }
            let mut bytes = fs::read(whole.path().join(name)).unwrap();
            if name == file {
                damages.iter().for_each(|damage| damage.apply(&mut bytes));
            }
            fs::write(folder.path().join(name), bytes).unwrap();
        }
        let options =
            ModelImport { images: Some(whole.path().join("images")), ..ModelImport::new("walk", field()) };
        let out = folder.path().join("out");
        // Both may succeed or fail; they must only return.
        let result = match file {
            "transforms.json" => read_nerfstudio_as_sequence(folder.path(), &out, &options),
            _ => read_colmap_as_sequence(folder.path(), &out, &options),
        };
        if let Err(error) = result {
            assert!(!error.to_string().contains('\n'), "{error}");
        }
    });
}

proptest! {
    #[test]
    fn damaged_models_are_read_or_refused(
        file in prop::sample::select(FILES.to_vec()),
        damages in prop::collection::vec(damage(), 1..5),
    ) {
        read_damaged(file, &damages);
    }

    #[test]
    fn damaged_tables_are_read_or_refused(damages in prop::collection::vec(damage(), 1..5)) {
        let mut bytes = b"timestamp_s,x_m,sure,particles,other\n0.1,1.5,true,800,a\n0.2,,false,,7\n".to_vec();
        damages.iter().for_each(|damage| damage.apply(&mut bytes));
        if let Ok(text) = String::from_utf8(bytes) {
            let _ = FrameTable::parse_details(Path::new("frames.csv"), &text);
        }
    }
}

const MAPPING: &[u8] =
    b"name = 'walk'\ntable = 'log.csv'\ncamera = 'camera.toml'\nfield = 'spl'\n[columns]\n\
timestamp_s = { column = 't', unit = 'ms' }\nimage = 'file'\npitch_rad = 'p'\nroll_rad = { value = 0 }\n";

const TABLE: &[u8] = b"t,file,p\n100,000000.png,0.3\n200,000001.png,0.4\n";

proptest! {
    #[test]
    fn damaged_mappings_and_their_tables_are_read_or_refused(
        of_table in any::<bool>(),
        damages in prop::collection::vec(damage(), 1..5),
    ) {
        MODEL.with(|whole| {
            let folder = tempfile::tempdir().unwrap();
            let (mut mapping, mut table) = (MAPPING.to_vec(), TABLE.to_vec());
            let damaged = if of_table { &mut table } else { &mut mapping };
            damages.iter().for_each(|damage| damage.apply(damaged));
            let setup = CameraSetup { camera: cameras()[3].clone(), mount_height_m: 0.5, photometry: None };
            let camera = setup.to_toml(Path::new("camera.toml")).unwrap();
            for (name, bytes) in [
                ("mapping.toml", mapping.as_slice()),
                ("log.csv", &table),
                ("camera.toml", camera.as_bytes()),
                ("000000.png", &fs::read(whole.path().join("images/000000.png")).unwrap()),
            ] {
                fs::write(folder.path().join(name), bytes).unwrap();
            }
            let result = read_table_as_sequence(&folder.path().join("mapping.toml"), &folder.path().join("out"));
            if let Err(error) = result {
                assert!(!error.to_string().contains('\n'), "{error}");
            }
        });
    }
}

#[test]
fn counts_that_the_file_cannot_hold_are_refused_before_anything_is_allocated() {
    let folder = tempfile::tempdir().unwrap();
    model(folder.path());
    for name in ["cameras.bin", "images.bin"] {
        let path = folder.path().join("sparse/0").join(name);
        let whole = fs::read(&path).unwrap();
        let mut claims = whole.clone();
        claims[..8].copy_from_slice(&(u64::MAX / 2).to_le_bytes());
        fs::write(&path, claims).unwrap();
        let error = read_colmap(folder.path()).unwrap_err().to_string();
        assert!(error.contains("more than its size allows"), "{error}");
        fs::write(&path, whole).unwrap();
    }
}

#[test]
fn names_that_lead_out_of_the_folder_are_refused() {
    for name in ["../secret.jpg", "/etc/passwd"] {
        let folder = tempfile::tempdir().unwrap();
        model(folder.path());
        fs::remove_file(folder.path().join("sparse/0/images.bin")).unwrap();
        for file in ["sparse/0/images.txt", "transforms.json"] {
            let path = folder.path().join(file);
            let text = fs::read_to_string(&path).unwrap();
            fs::write(&path, text.replace("images/000000.png", name).replace("000000.png", name)).unwrap();
        }
        let (out, options) = (folder.path().join("out"), ModelImport::new("walk", field()));
        for result in [
            read_colmap_as_sequence(folder.path(), &out, &options),
            read_nerfstudio_as_sequence(folder.path(), &out, &options),
        ] {
            let error = result.unwrap_err().to_string();
            assert!(error.contains("not a path inside"), "{error}");
        }
    }
}
