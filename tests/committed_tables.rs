//! The committed tables: their recipes give them again to the last byte, and the kernel looks contacts up in them.

use std::path::Path;
use std::time::Instant;

use flangeway::{AxisName, ContactTable, Coordinates, Pose, Side};
use flangeway_host::compile::compile;
use flangeway_host::pair::Pair;
use flangeway_host::profile_noise;
use flangeway_host::recipe::Recipe;
use flangeway_tables::{ALL, Committed, SMALL_BYTES};

fn recipe(table: &Committed) -> Recipe {
    let mut recipe = Recipe::parse(table.recipe, Path::new(table.name)).unwrap();
    recipe.grid.max_bytes = SMALL_BYTES;
    recipe
}

#[test]
fn recipes_give_the_committed_bytes() {
    if cfg!(debug_assertions) {
        println!("skipped: takes minutes without --release");
        return;
    }
    let mut stale = Vec::new();
    for table in &ALL {
        let start = Instant::now();
        let recipe = recipe(table);
        let pair = Pair::build(&recipe).unwrap();
        assert_eq!(profile_noise::warnings(&recipe, &pair).unwrap(), [] as [String; 0], "{}", table.name);
        let image = compile(&recipe, &pair, None).unwrap().image;
        println!("{}: {} bytes, {:.1} s", table.name, image.len(), start.elapsed().as_secs_f64());
        if image != table.image {
            let differs = image.iter().zip(table.image).position(|(a, b)| a != b);
            stale.push(format!("{}: {} bytes again, the first to differ {differs:?}", table.name, image.len()));
        }
    }
    assert!(stale.is_empty(), "tables/regenerate.sh rewrites what is stale: {stale:#?}");
}

#[test]
fn the_kernel_takes_them_and_finds_contacts() {
    for Committed { name, image, .. } in &ALL {
        assert!(image.len() as u64 <= SMALL_BYTES, "{name}: {} bytes", image.len());
        assert_eq!(image.as_ptr().addr() % 64, 0, "{name}");
        let table = ContactTable::new(image).unwrap();
        let geometry = table.header().side(Side::Right).geometry;
        let (first, last) = table.axis(AxisName::Lateral).range();
        let mut most = 0;
        for i in 0..=2000 {
            let lateral = first + (last - first) * f64::from(i) / 2000.0;
            // Where the rigid contact jumps within the roll offsets, the map is a straight line and touching up to some tens
            // of µm beyond it.
            let at = Coordinates { lateral, yaw: 0.002, roll_offset: 0.0, vertical: 9e-5 };
            let pose = table.rigid(Side::Right).pose(&geometry, &at);
            let found = table.contacts(Side::Right, &pose);
            assert!(found.flags.is_empty(), "{name} at {lateral}: {:?}", found.flags);
            let force = found.total_normal_force();
            // Least where the contact leaves the flange root for the flange: the solver itself has 675 N there on 54E1.
            assert!((200.0..200e3).contains(&force), "{name} at {lateral}: {force} N");
            let mirrored = Pose { lateral: -pose.lateral, yaw: -pose.yaw, roll: -pose.roll, ..pose };
            assert_eq!(table.contacts(Side::Left, &mirrored).total_normal_force(), force, "{name}");
            most = most.max(found.list.len());
        }
        println!("{name}: {} bytes, at most {most} contacts over its lateral range", image.len());
        assert!(most >= 2, "{name}");
    }
}

#[test]
fn they_report_their_errors() {
    for table in &ALL {
        let errors = ContactTable::new(table.image).unwrap().header().errors;
        println!("{}: {errors:?}", table.name);
        assert!(errors.samples > 3900, "{}", table.name);
        assert!(errors.force_median < 0.015 && errors.force_p95 < 0.15, "{}", table.name);
        assert!(errors.continuity < 0.02, "{}", table.name);
    }
}
