//! The list of modules in a test program's `main.rs`.
#![allow(unreachable_pub, reason = "two packages use it")]

use std::path::Path;

/// A file that is named nowhere would never be compiled: holds a package's tests against the text of their `main.rs`.
pub fn name_every_file(package: &str, main: &str) {
    for path in std::fs::read_dir(Path::new(package).join("tests")).unwrap().map(|entry| entry.unwrap().path()) {
        let module = path.file_stem().unwrap().to_str().unwrap();
        let is_one = path.join("mod.rs").exists() || path.extension().is_some_and(|e| e == "rs") && module != "main";
        let named = main.lines().any(|line| line == format!("mod {module};"));
        assert_eq!(named, is_one, "{}", path.display());
    }
}
