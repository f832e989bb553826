//! Shards and campaigns by the program: the same bytes however the work is divided, and nothing lost or mistaken.

use std::path::Path;

use crate::common::{Folder, RECIPE};
use flangeway_host::campaign::conicity::RadiusDifference;
use flangeway_host::campaign::{Manifest, Planned, expand};
use flangeway_host::pair::Pair;
use flangeway_host::recipe::Recipe;
use flangeway_host::rigid::two_wheels;

/// The small recipe with axes left to the compiler: the search and the fit are part of what must not change.
fn adaptive() -> String {
    RECIPE.replace("nodes = 21", "nodes = \"auto\"").replace("nodes = 3", "nodes = \"auto\"") + "max_bytes = 40_000\n"
}

/// Another wheel on the left, so that there are two sides.
fn two_sided() -> String {
    RECIPE.replace("[rail]", "[wheel.left]\nprofile = \"cone:1/20\"\n\n[rail]")
}

fn bytes(folder: &Folder, name: &str) -> Vec<u8> {
    std::fs::read(folder.path(name)).unwrap()
}

/// Exit status 2, one line on stderr with these words.
fn refused(folder: &Folder, command: &str, says: &[&str]) {
    let output = folder.run(command);
    let said = String::from_utf8_lossy(&output.stderr);
    println!("{command}: {}", said.trim_end());
    assert_eq!((output.status.code(), said.lines().count()), (Some(2), 1), "{command}: {said}");
    assert!(says.iter().all(|word| said.contains(word)), "{command}: {said}");
}

#[test]
fn shards_make_the_table_of_a_single_compilation() {
    for (what, recipe, axes_first) in [("adaptive", adaptive(), true), ("two sides", two_sided(), false)] {
        let folder = Folder::new();
        folder.write("recipe.toml", recipe);
        folder.run_well("compile recipe.toml -o whole.fwt --jobs 2");
        let axes = if axes_first {
            folder.run_well("compile recipe.toml --axes-only -o axes");
            "--axes axes"
        } else {
            ""
        };
        for i in 1..=3 {
            folder.run_well(&format!("compile recipe.toml {axes} --shard {i}/3 --jobs {i} -o shard{i}"));
        }
        folder.run_well("merge shard2 shard3 shard1 -o merged.fwt");
        assert!(bytes(&folder, "whole.fwt") == bytes(&folder, "merged.fwt"), "{what}: other bytes");
        if axes_first {
            folder.run_well("compile recipe.toml --axes axes -o again.fwt");
            assert!(bytes(&folder, "whole.fwt") == bytes(&folder, "again.fwt"), "{what}: other bytes by given axes");
        }
        println!("{what}: {} bytes, the same by three shards", bytes(&folder, "merged.fwt").len());
    }
}

#[test]
fn what_is_no_set_of_shards_is_refused() {
    let folder = Folder::new();
    let recipe = RECIPE.replace("nodes = 21", "nodes = 7");
    folder.write("recipe.toml", &recipe);
    folder.write("other.toml", recipe.replace("1.435", "1.440"));
    for i in 1..=2 {
        folder.run_well(&format!("compile recipe.toml --shard {i}/2 -o shard{i}"));
    }
    folder.run_well("compile other.toml --shard 2/2 -o foreign");
    folder.run_well("compile recipe.toml --shard 2/3 -o third");
    folder.run_well("compile recipe.toml --axes-only -o axes");
    let whole = bytes(&folder, "shard2");
    folder.write("short", &whole[..whole.len() - 1]);
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 4;
    folder.write("flipped", flipped);
    let before = folder.contents();
    let merge = |shards: &str, says: &[&str]| refused(&folder, &format!("merge {shards} -o out.fwt"), says);
    merge("shard1", &["shard1: shard 2/2 is missing"]);
    merge("shard2 shard2", &["shard2: is shard 2/2, and so is shard2"]);
    merge("shard1 foreign", &["foreign: ", "another table than shard1"]);
    merge("shard1 third", &["third: is shard 2/3"]);
    merge("shard1 short", &["short: is damaged"]);
    merge("shard1 flipped", &["flipped: is damaged"]);
    merge("shard1 recipe.toml", &["recipe.toml: is not a shard"]);
    merge("shard1 nothing", &["nothing: ", "No such file"]);
    refused(&folder, "compile other.toml --axes axes -o out.fwt", &["axes: the axes are of another recipe"]);
    refused(&folder, "compile recipe.toml --axes shard1 -o out.fwt", &["shard1: is not a file of settled axes"]);
    assert_eq!(folder.run("compile recipe.toml --shard 3/2 -o out").status.code(), Some(2));
    assert!(before == folder.contents(), "something was left behind");
}

/// A measured profile as text: the built-in 60E1's head, coarse, in millimetres.
fn rail_file(shift: f64) -> String {
    let profile = flangeway_host::profile::Profile::load("60e1", Path::new(""), None, &Default::default()).unwrap();
    let points = profile.points.iter().step_by(4);
    points.map(|[y, z]| format!("{:.4} {:.4}\n", 1e3 * y + shift, 1e3 * z)).collect()
}

/// The small recipe as a campaign: a cone, which is compiled quickly, two gauges, rails by a pattern.
fn campaign() -> String {
    RECIPE
        .replace("\"s1002\"", "\"cone:1/20\"")
        .replace("nodes = 21", "nodes = 5")
        .replace("gauge_m = 1.435", "gauge_m = [1.435, 1.440]\nlength_unit = \"mm\"\nsmoothing_m = 1e-5")
        .replace("\"60e1\"", "[\"rails/*.txt\"]")
}

fn with_rails(names: &[&str]) -> Folder {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("rails")).unwrap();
    for name in names {
        folder.write(&format!("rails/{name}"), rail_file(0.0));
    }
    folder.write("campaign.toml", campaign());
    folder
}

fn ids(manifest: &Manifest) -> Vec<String> {
    manifest.tables().map(|entry| entry.id.clone()).collect()
}

#[test]
fn identifiers_depend_on_what_determines_the_bytes_and_on_nothing_else() {
    let folder = with_rails(&["a.txt", "b.txt"]);
    let of = |text: &str| {
        folder.write("campaign.toml", text);
        let (manifest, _) = expand(&folder.path("campaign.toml")).unwrap();
        ids(&manifest)
    };
    let text = campaign();
    let first = of(&text);
    assert_eq!(first.len(), 4);
    assert!(first.iter().all(|id| id.len() == 32));
    // The order of lists, the spelling of numbers, comments, another folder.
    let mut turned = of(&text.replace("[1.435, 1.440]", "[1.44, 1.4350] # gauges"));
    assert_ne!(first, turned);
    let mut sorted = first.clone();
    sorted.sort();
    turned.sort();
    assert_eq!(sorted, turned);
    std::fs::rename(folder.path("rails"), folder.path("elsewhere")).unwrap();
    assert_eq!(first, of(&text.replace("rails/*", "elsewhere/*")));
    // Named twice, there once.
    assert_eq!(first, of(&text.replace("\"rails/*.txt\"", "\"elsewhere/*.txt\", \"elsewhere/a.txt\"")));
    // A profile's contents, a setting.
    folder.write("elsewhere/b.txt", rail_file(0.01));
    let changed = of(&text.replace("rails/*", "elsewhere/*"));
    assert_eq!(first.iter().filter(|id| changed.contains(id)).count(), 2);
    let other = of(&text.replace("rails/*", "elsewhere/*").replace("0.28", "0.29"));
    assert!(other.iter().all(|id| !first.contains(id) && !changed.contains(id)));
}

#[test]
fn a_campaign_with_broken_profiles_completes_the_others_and_resumes_what_is_lost() {
    let folder = with_rails(&["a.txt", "b.txt"]);
    folder.write("rails/broken.txt", "no numbers at all\n");
    folder.write("campaign.toml", campaign().replace("\"rails/*.txt\"", "\"rails/*.txt\", \"rails/absent.txt\""));
    let output = folder.run("campaign run campaign.toml -o out --jobs 2");
    let said = String::from_utf8_lossy(&output.stderr);
    println!("{said}");
    assert_eq!(output.status.code(), Some(1), "{said}");
    let line =
        |words: [&str; 2]| said.lines().any(|l| l.starts_with("broken: ") && words.iter().all(|w| l.contains(w)));
    assert!(line(["broken.txt", "rails/broken.txt"]) && line(["absent.txt", "No such file"]), "{said}");
    assert!(said.contains("4 compiled, 0 there already, 0 failed"), "{said}");
    let manifest = Manifest::read(&folder.path("out/manifest.jsonl")).unwrap();
    let broken = manifest.entries.iter().filter(|planned| matches!(planned, Planned::Broken { .. })).count();
    assert_eq!((manifest.tables().count(), broken), (4, 4));
    let table = |id: &str| folder.path(&format!("out/tables/{id}.fwt"));
    let before: Vec<Vec<u8>> = ids(&manifest).iter().map(|id| std::fs::read(table(id)).unwrap()).collect();

    // One is lost, one cut short, one is the table of another entry, under a wrong name.
    let [a, b, c, d] = ids(&manifest).try_into().unwrap();
    std::fs::remove_file(table(&a)).unwrap();
    std::fs::write(table(&b), &before[1][..before[1].len() - 64]).unwrap();
    std::fs::copy(table(&d), table(&c)).unwrap();
    let status = folder.run("campaign status out --json");
    assert_eq!(status.status.code(), Some(1));
    let json: serde_json::Value = serde_json::from_slice(&status.stdout).unwrap();
    assert_eq!((json["whole"].as_u64(), json["missing"].as_u64()), (Some(1), Some(1)));
    assert_eq!(json["damaged"].as_array().map(Vec::len), Some(2));
    let said = folder.run("campaign resume out --jobs 1");
    assert!(String::from_utf8_lossy(&said.stderr).contains("3 compiled, 1 there already"));
    for (id, before) in [&a, &b, &c, &d].into_iter().zip(&before) {
        assert!(std::fs::read(table(id)).unwrap() == *before, "{id}: other bytes");
    }

    // Two processes on the same table at once: whole, the same, nothing beside it.
    std::fs::remove_file(table(&a)).unwrap();
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| folder.run_well(&format!("campaign task out {a} --jobs 1")));
        }
    });
    assert!(std::fs::read(table(&a)).unwrap() == before[0]);
    assert_eq!(std::fs::read_dir(folder.path("out/tables")).unwrap().count(), 4);

    folder.run_well("campaign report out");
    let page = folder.read("out/report.html");
    assert!(page.matches("<svg").count() == 4 && page.contains("rails/broken.txt") && !page.contains("src="));
    assert!(page.contains(&format!("href=\"tables/{d}.fwt\"")));
}

#[test]
fn a_table_that_cannot_be_compiled_is_listed_and_the_others_are_there() {
    let folder = Folder::new();
    // With flange backs so far apart the wheel misses the rail.
    let text = RECIPE.replace("nodes = 21", "nodes = 5").replace("1.360", "[1.360, 1.90]");
    folder.write("campaign.toml", text);
    let output = folder.run("campaign run campaign.toml -o out");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("failed: s1002 on 60e1, wheel.flange_back_spacing_m = 1.9: "), "{said}");
    assert!(said.contains("cannot reach the rail"), "{said}");
    assert_eq!(std::fs::read_dir(folder.path("out/tables")).unwrap().count(), 1);
}

#[test]
fn bad_campaigns_are_refused_in_one_line() {
    let folder = Folder::new();
    let plan = |text: String, says: &[&str]| {
        folder.write("campaign.toml", text);
        refused(&folder, "campaign plan campaign.toml -o out", says);
        assert!(!folder.path("out").exists(), "something was written");
    };
    plan(RECIPE.replace("[rail]", "[rail"), &["campaign.toml:7: "]);
    plan(RECIPE.replace("gauge_m", "guage_m"), &["campaign.toml: ", "guage_m = 1.435", "unknown field"]);
    plan(RECIPE.replace("1.435", "[]"), &["campaign.toml: rail.gauge_m: an empty list"]);
    plan(RECIPE.replace("1.435", "[1.435, 14.35]"), &["campaign.toml: rail.gauge_m: 14.35", "rail.gauge_m = 14.35"]);
    plan(RECIPE.replace("\"60e1\"", "\"rails/*.prr\""), &["rail.profile: \"rails/*.prr\": matches no file"]);
    plan(RECIPE.to_owned() + "[slurm]\nqueue = 1\n", &["campaign.toml: slurm: unknown field `queue`"]);
    refused(&folder, "campaign resume out", &["manifest.jsonl", "No such file"]);
}

#[test]
fn tasks_of_an_array_cover_every_table_once() {
    let folder = Folder::new();
    let text =
        RECIPE.replace("1.435", "[1.432, 1.433, 1.434, 1.435, 1.436]") + "[slurm]\ntasks = 3\naccount = \"rail\"\n";
    folder.write("campaign.toml", text);
    let calls = folder.run_well("campaign slurm campaign.toml -o out --dry-run");
    assert_eq!(calls.lines().count(), 1);
    assert!(calls.starts_with("sbatch --parsable --array=0-2 out/slurm/job-1.sh 0"), "{calls}");
    assert!(folder.read("out/slurm/job-1.sh").contains("#SBATCH --account=rail"));
    let manifest = Manifest::read(&folder.path("out/manifest.jsonl")).unwrap();
    let mut listed: Vec<String> = Vec::new();
    for line in folder.read("out/slurm/tasks-1.jsonl").lines() {
        listed.extend(serde_json::from_str::<Vec<String>>(line).unwrap());
    }
    let mut planned = ids(&manifest);
    listed.sort();
    planned.sort();
    assert_eq!(listed, planned);
    // The template is the user's.
    folder.write("out/slurm/template.sh", "#!/bin/sh\n# mine\n{{program}} {{list}}\n");
    folder.run_well("campaign slurm campaign.toml -o out --dry-run");
    assert!(folder.read("out/slurm/job-2.sh").starts_with("#!/bin/sh\n# mine\n'/"));
    refused(&folder, "campaign task out --list out/slurm/tasks-1.jsonl --task 9", &["tasks-1.jsonl: has 3 tasks"]);
}

/// Half a wavelength (m) of the kinematic motion y″ = -Δr(y) / (e r₀) that is let go at `y` (m) without slope, and where
/// it ends on the other side: small steps along the track (velocity Verlet), the rigid contact solved anew at each.
fn half_a_wave(pair: &Pair, mut y: f64) -> (f64, f64) {
    let (spacing, radius, step) = (1.5, 0.46, 0.01);
    let bend = |y: f64| {
        let rigid = two_wheels(pair, y, 0.0).unwrap();
        -(rigid.right.wheel.radius - rigid.left.wheel.radius) / (spacing * radius)
    };
    let (mut x, mut slope, mut now) = (0.0, 0.0, bend(y));
    loop {
        let before = slope;
        y += step * slope + 0.5 * step * step * now;
        let next = bend(y);
        slope += 0.5 * step * (now + next);
        now = next;
        if before < 0.0 && slope >= 0.0 {
            // The slope vanishes inside the step.
            return (x + step * before / (before - slope), y);
        }
        x += step;
    }
}

#[test]
fn equivalent_conicity_is_that_of_the_motion_followed_along_the_track() {
    for (wheel, amplitude) in [("cone:1/20", 3e-3), ("s1002", 3e-3), ("s1002", 1.5e-3)] {
        let text = RECIPE.replace("\"s1002\"", &format!("\"{wheel}\""));
        let pair = Pair::build(&Recipe::parse(&text, Path::new("recipe.toml")).unwrap()).unwrap();
        let found = RadiusDifference::of(&pair).conicity(amplitude).unwrap();
        let (half, end) = half_a_wave(&pair, amplitude);
        assert!((end + amplitude).abs() < 0.01 * amplitude, "{wheel}: from {amplitude} to {end}");
        // Klingel: λ = 2 π √(e r₀ / (2 tan γ))
        let expected = 2.0 * std::f64::consts::PI.powi(2) * 1.5 * 0.46 / (2.0 * half).powi(2);
        println!("{wheel} on 60e1, y = {} mm: tan γ {found:.4}, along the track {expected:.4}", 1e3 * amplitude);
        assert!((found / expected - 1.0).abs() < 0.01, "{wheel}: {found}, along the track {expected}");
        if wheel == "cone:1/20" {
            // A cone has its taper, but for the roll, which moves the contact over the rail's crown.
            assert!((found / 0.05 - 1.0).abs() < 0.1, "{found}");
        }
    }
}
