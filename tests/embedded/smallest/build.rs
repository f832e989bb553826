//! Tells the linker where memory lies.

fn main() {
    println!("cargo:rustc-link-search={}/../template", env!("CARGO_MANIFEST_DIR"));
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rerun-if-changed=../template/memory.x");
}
