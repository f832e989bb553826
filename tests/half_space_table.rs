//! Half-space tables: an interrupted compilation goes on to the same bytes, and shards make up the same.

use std::path::Path;

use crate::common;
use flangeway::ContactTable;
use flangeway_host::compile::{Checkpoint, Settled, Shard, Uniform, compile_from, merge};
use flangeway_host::pair::Pair;
use flangeway_host::recipe::{NodeValues, Recipe};

fn recipe() -> Recipe {
    let text = flangeway_tables::S1002_60E1_40
        .replace("[-0.010, 0.010]", "[-0.004, 0.0]")
        .replace("[0.0, 0.024]", "[0.0, 0.004]")
        .replace("max_bytes", "node_values = \"sampled\"\nerror_poses = 300\nmax_bytes");
    let recipe = common::recipe(&format!("{text}\n[solver]\nnormal = \"half-space\"\n"));
    assert!(recipe.grid.node_values == NodeValues::Sampled && recipe.grid.lateral_m.range == [-4e-3, 0.0]);
    recipe
}

fn uniform() -> Uniform {
    "5x2x3x2".parse().unwrap()
}

/// The image, and the checkpoint as it stood before the end.
fn compiled(recipe: &Recipe, pair: &Pair, table: &Path) -> (Vec<u8>, Vec<u8>) {
    let mut checkpoint = Checkpoint::of_table(table, recipe, pair, Some(uniform()), None).unwrap();
    let path = checkpoint.path().unwrap().to_owned();
    assert_eq!(checkpoint.resumes(), path.exists());
    let image = compile_from(recipe, pair, Some(uniform()), &mut checkpoint).unwrap().image;
    let kept = std::fs::read(&path).unwrap();
    checkpoint.finish().unwrap();
    assert!(!path.exists(), "a finished table needs no checkpoint");
    (image, kept)
}

#[test]
fn an_interrupted_compilation_and_shards_give_the_same_bytes() {
    let recipe = recipe();
    let pair = Pair::build(&recipe).unwrap();
    let folder = std::env::temp_dir().join(format!("flangeway-checkpoint-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("table.fwt");
    let (whole, checkpoint) = compiled(&recipe, &pair, &path);
    let table = ContactTable::new(&whole).unwrap();
    assert!(table.header().solver.starts_with("half-space"));
    // Cut off inside the last block, as by a crash while it was written.
    std::fs::write(folder.join("table.fwt.partial"), &checkpoint[..checkpoint.len() - 7]).unwrap();
    assert_eq!(compiled(&recipe, &pair, &path).0, whole);
    let settled = Settled::new(&recipe, &pair, Some(uniform())).unwrap();
    let shards = ["1/2", "2/2"].map(|part| {
        let path = folder.join(part.replace('/', "of"));
        Shard::new(&recipe, &pair, settled.clone(), part.parse().unwrap()).unwrap().write(&path).unwrap();
        path
    });
    assert_eq!(merge(&shards).unwrap().1.image, whole);
    std::fs::remove_dir_all(&folder).unwrap();
}
