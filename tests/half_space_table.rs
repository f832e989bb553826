//! Half-space tables: an interrupted compilation goes on to the same bytes.

mod common;

use std::path::Path;

use flangeway::ContactTable;
use flangeway_host::compile::{Checkpoint, Uniform, checkpoint_key, compile_from};
use flangeway_host::pair::Pair;
use flangeway_host::recipe::{NodeValues, Recipe};

fn recipe() -> Recipe {
    let text = format!("{}\n[solver]\nnormal = \"half-space\"\n", flangeway_tables::S1002_60E1_40);
    let mut recipe = common::recipe(&text);
    recipe.grid.node_values = NodeValues::Sampled;
    recipe.grid.lateral_m.range = [-4e-3, 0.0];
    recipe.grid.yaw_rad.range = [0.0, 4e-3];
    recipe
}

/// The image, and the checkpoint as it stood before the end.
fn compiled(recipe: &Recipe, pair: &Pair, path: &Path) -> (Vec<u8>, Vec<u8>) {
    let uniform: Uniform = "5x2x3x2".parse().unwrap();
    let mut checkpoint = Checkpoint::open(path, checkpoint_key(recipe, pair, Some(uniform))).unwrap();
    let image = compile_from(recipe, pair, Some(uniform), &mut checkpoint).unwrap().image;
    let kept = std::fs::read(path).unwrap();
    checkpoint.finish().unwrap();
    assert!(!path.exists(), "a finished table needs no checkpoint");
    (image, kept)
}

#[test]
fn an_interrupted_compilation_goes_on_to_the_same_bytes() {
    let recipe = recipe();
    let pair = Pair::build(&recipe).unwrap();
    let folder = std::env::temp_dir().join(format!("flangeway-checkpoint-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("table.fwt.partial");
    let (whole, checkpoint) = compiled(&recipe, &pair, &path);
    let table = ContactTable::new(&whole).unwrap();
    assert!(table.header().solver.starts_with("half-space"));
    // Cut off inside the last block, as by a crash while it was written.
    std::fs::write(&path, &checkpoint[..checkpoint.len() - 7]).unwrap();
    assert_eq!(compiled(&recipe, &pair, &path).0, whole);
    std::fs::remove_dir_all(&folder).unwrap();
}
