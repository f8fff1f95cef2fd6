//! Tells the program which source it is built from.

#[path = "src/source.rs"]
mod source;

use std::path::PathBuf;

fn main() {
    let root = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").expect("cargo says where the crate is"));
    let sources = source::SOURCES.into_iter().map(|name| root.join(name)).filter(|path| path.exists());
    for path in sources.chain(source::head(&root)) {
        println!("cargo::rerun-if-changed={}", path.display());
    }
    let hash = source::hash(&root).expect("the sources of the crate can be read");
    println!("cargo::rustc-env=STICTION_SOURCE_HASH={hash}");
    println!(
        "cargo::rustc-env=STICTION_SOURCE_REVISION={}",
        source::revision(&root).unwrap_or("unknown".to_owned())
    );
}
