//! A folder to run the program in, and a small table.
#![allow(dead_code, unreachable_pub, reason = "each test uses a part of this")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;

use flangeway_host::compile::compile;
use flangeway_host::pair::Pair;
use flangeway_host::recipe::Recipe;

/// S1002 on 60E1 with few nodes, all built in. The lines are counted by tests that expect their numbers.
pub const RECIPE: &str = r#"[wheel]
profile = "s1002"
nominal_radius_m = 0.460
flange_back_spacing_m = 1.360
flange_back_position_m = -0.070

[rail]
profile = "60e1"
gauge_m = 1.435
cant_rad = 0.025

[material]
youngs_modulus_pa = 2.1e11
poisson_ratio = 0.28

[grid]
lateral_m = { range = [-0.010, 0.010], nodes = 21 }
yaw_rad = { range = [0.0, 0.024], nodes = 3 }
vertical_m = { range = [-5.0e-5, 1.5e-4], nodes = 3 }
roll_rad = { range = [-1.0e-3, 1.0e-3], nodes = 3 }
error_poses = 500
"#;

/// Three poses: centred and loaded, shifted and yawed, lifted off the rails.
pub const POSES: &str = "\
y_m,yaw_rad,z_m,roll_rad
0.0,0.0,2.3e-4,0.0
0.002,0.0048,2.0e-4,-1.128e-4
0.0,0.0,-5.0e-3,0.0
";

/// The table of [`RECIPE`], compiled once.
pub fn table() -> &'static [u8] {
    static TABLE: LazyLock<Vec<u8>> = LazyLock::new(|| {
        let recipe = Recipe::parse(RECIPE, Path::new("recipe.toml")).unwrap();
        compile(&recipe, &Pair::build(&recipe).unwrap(), None).unwrap().image
    });
    &TABLE
}

/// A temporary folder with `recipe.toml` and `poses.csv`, in which the program runs.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.write("recipe.toml", RECIPE);
        folder.write("poses.csv", POSES);
        folder
    }

    pub fn with_table() -> Self {
        let folder = Self::new();
        folder.write("table.fwt", table());
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), contents).unwrap();
    }

    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    /// Every file and folder in it with its bytes, sorted.
    pub fn contents(&self) -> Vec<(String, Vec<u8>)> {
        let entry = |e: std::io::Result<std::fs::DirEntry>| {
            let e = e.unwrap();
            (e.file_name().into_string().unwrap(), std::fs::read(e.path()).unwrap_or_default())
        };
        let mut all: Vec<_> = std::fs::read_dir(self.0.path()).unwrap().map(entry).collect();
        all.sort();
        all
    }

    /// Runs the program with these words as arguments.
    pub fn run(&self, words: &str) -> Output {
        self.run_into(words, Stdio::piped())
    }

    /// As [`Folder::run`], with stdout somewhere else.
    pub fn run_into(&self, words: &str, stdout: Stdio) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_flangeway"));
        command.args(words.split_whitespace()).current_dir(self.0.path()).stdin(Stdio::null()).stdout(stdout);
        command.stderr(Stdio::piped()).spawn().unwrap().wait_with_output().unwrap()
    }

    /// Runs the program and wants it to succeed; answers stdout.
    pub fn run_well(&self, words: &str) -> String {
        let output = self.run(words);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "flangeway {words}: {said}");
        String::from_utf8(output.stdout).unwrap()
    }
}

/// Columns and rows of a CSV file.
pub struct Csv {
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Csv {
    pub fn read(folder: &Folder, name: &str) -> Self {
        let mut reader = csv::Reader::from_path(folder.path(name)).unwrap();
        let words = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect::<Vec<_>>();
        let columns = words(reader.headers().unwrap());
        Self { columns, rows: reader.records().map(|r| words(&r.unwrap())).collect() }
    }

    pub fn len(&self) -> usize {
        self.rows.len()
    }

    pub fn text(&self, row: usize, column: &str) -> &str {
        let index = self.columns.iter().position(|c| c == column).unwrap_or_else(|| panic!("no column {column}"));
        &self.rows[row][index]
    }

    pub fn number(&self, row: usize, column: &str) -> f64 {
        self.text(row, column).parse().unwrap()
    }
}
