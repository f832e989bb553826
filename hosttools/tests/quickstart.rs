//! The first command that anyone runs: everything is written, readable, and complete in itself.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use flangeway::ContactTable;

/// Figures in the report.
const FIGURES: usize = 7;

fn quickstart(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flangeway"));
    command.current_dir(folder).arg("quickstart").args(arguments).output().unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn writes_recipe_table_and_report() {
    let place = tempfile::tempdir().unwrap();
    let output = quickstart(place.path(), &[]);
    let (stdout, stderr) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let folder = place.path().join("quickstart");
    assert_eq!(names(&folder), ["report.html", "s1002_60e1_40.fwt", "s1002_60e1_40.toml"]);
    assert_eq!(fs::read_to_string(folder.join("s1002_60e1_40.toml")).unwrap(), flangeway_tables::S1002_60E1_40);

    let image = fs::read(folder.join("s1002_60e1_40.fwt")).unwrap();
    let table = ContactTable::new(&image).unwrap();
    assert_eq!(table.header().right.wheel, "s1002");

    // Three lines of heading, both wheels in five places, and no figure without a number.
    assert!(stdout.lines().count() >= 3 + 10, "{stdout}");
    assert!(["tread", "flange root", "flange "].iter().all(|slot| stdout.contains(slot)), "{stdout}");
    assert!(!stdout.contains("NaN") && !stderr.contains("NaN"));
    assert!(stderr.contains("flangeway compile") && stderr.contains("report.html"), "{stderr}");

    complete_in_itself(&fs::read_to_string(folder.join("report.html")).unwrap());
}

fn complete_in_itself(html: &str) {
    for mark in ["<svg", "</svg>", "<figcaption>"] {
        assert_eq!(html.matches(mark).count(), FIGURES, "{mark}");
    }
    assert!(html.ends_with("</html>\n"));
    assert!(!html.contains("NaN") && !html.contains("inf"));
    let own = html.replace("http://www.w3.org/2000/svg", "");
    for resource in ["http", "//", "src=", "href", "url(", "@import", "<script", "<link"] {
        assert!(!own.contains(resource), "{resource}");
    }
}

#[test]
fn refuses_a_folder_that_cannot_be_made() {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("taken"), "not a folder").unwrap();
    for folder in ["missing/quickstart", "taken", "taken/quickstart"] {
        let output = quickstart(place.path(), &["-o", folder]);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.lines().count() == 1 && stderr.starts_with(&format!("flangeway: {folder}: ")), "{stderr}");
        assert!(output.stdout.is_empty());
    }
    assert_eq!(names(place.path()), ["taken"]);
}
