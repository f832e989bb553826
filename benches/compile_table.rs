//! How long tables take to compile: uniform grids of growing size, and the adaptive search under a byte budget.

mod common;

use std::time::Instant;

use flangeway_host::compile::{Uniform, compile};

fn main() {
    let (mut recipe, pair) = common::pair();
    println!("grid or budget, bytes, seconds, records a second");
    for counts in [[31, 5, 3, 3], [61, 9, 3, 3], [121, 9, 5, 3]] {
        let start = Instant::now();
        let bytes = compile(&recipe, &pair, Some(Uniform { counts })).expect("a table").image.len();
        let seconds = start.elapsed().as_secs_f64();
        let records = counts.iter().product::<usize>() as f64;
        println!("{counts:?}, {bytes}, {seconds:.2}, {:.0}", records / seconds);
    }
    recipe.grid.max_bytes = flangeway_tables::SMALL_BYTES;
    let start = Instant::now();
    let bytes = compile(&recipe, &pair, None).expect("a table").image.len();
    println!("auto within {}, {bytes}, {:.2}", flangeway_tables::SMALL_BYTES, start.elapsed().as_secs_f64());
}
