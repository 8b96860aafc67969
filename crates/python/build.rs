//! Hashes the sources of the library: rows of studies are kept by it.

use std::{
    env, fs, io,
    path::{Path, PathBuf},
};

use sha2::{Digest, Sha256};

/// Crates that no study runs.
const OTHERS: [&str; 4] = ["c", "hidden", "python", "viewer"];

/// Characters of the hash: two builds of one version have the same ones once in 10¹⁴ pairs.
const CHARACTERS: usize = 12;

fn main() -> io::Result<()> {
    // Cargo sets it for every build script.
    let package = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let crates = package.join("..");
    let mut sources = vec![crates.join("../Cargo.lock"), package.join("python/reality_sim/studies")];
    for entry in fs::read_dir(&crates)? {
        let entry = entry?;
        if !OTHERS.iter().any(|other| entry.file_name() == *other) {
            sources.push(entry.path().join("src"));
        }
    }
    let mut files = Vec::new();
    for source in sources.iter().filter(|source| source.exists()) {
        println!("cargo:rerun-if-changed={}", source.display());
        collect(source, &mut files)?;
    }
    files.sort();
    let mut hash = Sha256::new();
    for file in files {
        let name = file.strip_prefix(&crates).unwrap_or(&file);
        hash.update(name.to_string_lossy().replace('\\', "/"));
        hash.update(Sha256::digest(fs::read(&file)?));
    }
    let hash: String = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    println!("cargo:rustc-env=REALITY_SIM_SOURCES={}", &hash[..CHARACTERS]);
    Ok(())
}

/// Finds all source files of a folder, or takes a file.
fn collect(path: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    if !path.is_dir() {
        files.push(path.to_path_buf());
        return Ok(());
    }
    for entry in fs::read_dir(path)? {
        let path = entry?.path();
        // Python keeps what it has compiled beside the sources.
        if path.file_name().is_none_or(|name| name != "__pycache__") {
            collect(&path, files)?;
        }
    }
    Ok(())
}
