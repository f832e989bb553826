//! The packed unit: a zip file of library, description, table and a page of documentation, the same bytes every time.

use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::{Mode, description};
use crate::error::{Error, Result};

/// Name of the packed table in the resources.
pub const TABLE: &str = "table.fwt";

/// FMI's name of this platform and how its libraries end; none where FMI 2.0 has no name.
fn platform() -> Option<(&'static str, &'static str)> {
    match (std::env::consts::OS, usize::BITS) {
        ("linux", 64) => Some(("linux64", "so")),
        ("linux", 32) => Some(("linux32", "so")),
        ("windows", 64) => Some(("win64", "dll")),
        ("windows", 32) => Some(("win32", "dll")),
        ("macos", 64) => Some(("darwin64", "dylib")),
        _ => None,
    }
}

/// The library that cargo builds beside the program.
///
/// # Errors
/// When it is not there: the message says how to build it.
pub fn library_beside_program() -> Result<PathBuf> {
    let program = std::env::current_exe().map_err(|e| Error::file("", format!("this program's place: {e}")))?;
    let name = format!("{}flangeway_fmu{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let library = program.with_file_name(name);
    if library.is_file() {
        Ok(library)
    } else {
        let message = "is missing: build it with `cargo build --release -p flangeway-fmu`, or name one by --library";
        Err(Error::file(library, message))
    }
}

/// Packs a unit. The contents follow from mode, library and table alone.
///
/// # Errors
/// When the library cannot be read, or this platform has no name in FMI 2.0.
pub fn pack(mode: Mode, library: &Path, table: &[u8]) -> Result<Vec<u8>> {
    let Some((folder, ending)) = platform() else {
        return Err(Error::file(library, "FMI 2.0 has no name for this platform"));
    };
    let code = std::fs::read(library).map_err(|e| Error::file(library, e.to_string()))?;
    let identifier = mode.identifier();
    let parts = [
        ("modelDescription.xml".into(), description::xml(mode).into_bytes()),
        (format!("binaries/{folder}/{identifier}.{ending}"), code),
        (format!("resources/{TABLE}"), table.to_vec()),
        ("documentation/index.html".into(), page(mode).into_bytes()),
    ];
    let failed = |e: &dyn std::fmt::Display| Error::file(library, format!("cannot be packed: {e}"));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in parts {
        zip.start_file(name, options).map_err(|e| failed(&e))?;
        zip.write_all(&bytes).map_err(|e| failed(&e))?;
    }
    Ok(zip.finish().map_err(|e| failed(&e))?.into_inner())
}

/// The documentation.
fn page(mode: Mode) -> String {
    let (identifier, description, version) = (mode.identifier(), mode.description(), env!("CARGO_PKG_VERSION"));
    format!(
        "<!DOCTYPE html>
<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{identifier}</title></head><body>
<h1>{identifier}</h1>
<p>{description}</p>
<p>Every variable is described, with unit and range, in modelDescription.xml. A value out of its range, a missing or \
damaged table and a step that fails are FMI errors with a message in the log. Parameters are fixed once initialization \
is over. The unit's state can be kept and restored, within the same instance. Written by flangeway {version}; packed \
with it: resources/{TABLE}.</p>
</body></html>
"
    )
}
