//! `flangeway profile`: what a profile is taken for, with a drawing of its shape, slope and curvature.

mod drawing;

use std::path::{Path, PathBuf};

use serde_json::json;

use crate::curve::Curve;
use crate::error::Result;
use crate::image::write_atomically;
use crate::profile::{LengthUnit, Profile, ProfileKind, ReadOptions, is_built_in};
use crate::profile_noise;

/// Arguments of `flangeway profile`.
#[derive(Debug, Clone, clap::Args)]
pub struct ProfileArgs {
    /// Profile file, or a built-in: s1002, cone:1/20, circular_wheel:0.1, two_line, urban_arcs, 60e1, 54e1,
    /// flat_rail, circular_rail:0.3
    #[arg(value_name = "FILE|BUILTIN")]
    pub profile: String,
    /// What the profile belongs to, where the file does not say
    #[arg(long)]
    pub kind: Option<ProfileKind>,
    /// Whether y changes sign, over what is recognised
    #[arg(long, value_name = "BOOL")]
    pub mirror_y: Option<bool>,
    /// Whether z changes sign, over what is recognised
    #[arg(long, value_name = "BOOL")]
    pub mirror_z: Option<bool>,
    /// Length unit of the file, over what is recognised
    #[arg(long)]
    pub unit: Option<LengthUnit>,
    /// Root mean square distance (m) by which the curve may leave the points
    #[arg(long, value_name = "METRES", default_value_t = 0.0)]
    pub smoothing: f64,
    /// Drawing to write; the profile's name with .svg in the current folder by default
    #[arg(short, long, value_name = "OUT.svg")]
    pub output: Option<PathBuf>,
    /// Print what was recognised as JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// Reads the profile, says what it was taken for, and writes the drawing.
///
/// # Errors
/// When the profile cannot be read or the drawing cannot be written.
pub fn run(args: &ProfileArgs) -> Result<()> {
    let options = ReadOptions { mirror_y: args.mirror_y, mirror_z: args.mirror_z, length_unit: args.unit };
    let profile = Profile::load(&args.profile, Path::new(""), args.kind, &options)?;
    let curve = Curve::fit(&profile, args.smoothing)?;
    let output = args.output.clone().unwrap_or_else(|| default_output(&args.profile));
    write_atomically(&output, drawing::draw(&profile, &curve)?.as_bytes())?;

    eprintln!(
        "{}: {} profile, {} points, {:.1} mm along the contour",
        profile.name,
        profile.kind,
        profile.points.len(),
        1e3 * curve.length()
    );
    let [y, z] = [0, 1].map(|axis| extent(&profile, axis).map(|x| 1e3 * x));
    eprintln!("  y {:.3} to {:.3} mm, z {:.3} to {:.3} mm, joints: {}", y[0], y[1], z[0], z[1], profile.joints.len());
    for sentence in &profile.recognised {
        eprintln!("  {sentence}");
    }
    if args.smoothing > 0.0 {
        eprintln!("  smoothed, the curve leaves the points by {:.4} mm rms", 1e3 * curve.residual());
    }
    let band = profile_noise::contactable(&curve, profile.kind);
    let warning = profile_noise::warning(&profile, &curve, args.smoothing, band);
    if let Some(warning) = &warning {
        eprintln!("flangeway: warning: {warning}");
    }
    eprintln!("  drawn in {}", output.display());
    if args.json {
        super::print_json(&summary(&profile, &curve, args.smoothing, warning.as_deref(), &output))?;
    }
    Ok(())
}

fn summary(
    profile: &Profile,
    curve: &Curve,
    smoothing: f64,
    warning: Option<&str>,
    output: &Path,
) -> serde_json::Value {
    let joints: Vec<_> = profile
        .joints
        .iter()
        .filter_map(|j| profile.points.get(j.index).map(|p| json!({ "index": j.index, "y_m": p[0], "z_m": p[1] })))
        .collect();
    let hash: String = profile.source_hash.iter().map(|byte| format!("{byte:02x}")).collect();
    json!({
        "name": profile.name,
        "kind": profile.kind,
        "points": profile.points.len(),
        "length_m": curve.length(),
        "y_m": extent(profile, 0),
        "z_m": extent(profile, 1),
        "joints": joints,
        "file_smoothing": profile.smoothing,
        "smoothing_m": smoothing,
        "residual_m": curve.residual(),
        "source_sha256": hash,
        "recognised": profile.recognised,
        "warning": warning,
        "drawing": output.display().to_string(),
    })
}

fn extent(profile: &Profile, axis: usize) -> [f64; 2] {
    profile.points.iter().fold([f64::MAX, f64::MIN], |[low, high], p| [low.min(p[axis]), high.max(p[axis])])
}

/// The file's stem, or the built-in's name with `:` and `/` replaced, with `.svg`.
fn default_output(spec: &str) -> PathBuf {
    let stem = if is_built_in(spec) {
        spec.replace([':', '/'], "_")
    } else {
        Path::new(spec).file_stem().map_or_else(|| "profile".into(), |stem| stem.to_string_lossy().into_owned())
    };
    PathBuf::from(format!("{stem}.svg"))
}
