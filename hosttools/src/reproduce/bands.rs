//! Figures 8 and 12: where in the plane of lateral position and yaw the right wheel touches in two places.

use flangeway::{Pose, Side, Slot};
use rayon::prelude::*;

use super::runs::{Grounds, STAND_IN};
use super::{Check, Plate};
use crate::error::Result;
use crate::pair::Pair;
use crate::report::plot::{Panel, csv, draw};
use crate::report::style::{INK, Mark, colour};
use crate::rigid::two_wheels;
use crate::verify::height_for_load;

/// Normal force of the wheel (N), and the share of it from which on a slot counts as touching.
const LOAD: f64 = 40e3;
const SHARE: f64 = 0.02;

/// Pairs of slots that can touch together.
#[derive(Clone, Copy, PartialEq)]
enum Band {
    /// Tread and flange root; on the urban pair tread and throat.
    Tread,
    /// Flange root and flange; on the urban pair throat and flange.
    Flange,
    /// All three, or tread and flange.
    Wide,
}

impl Band {
    fn of(touching: [bool; 3]) -> Option<Self> {
        match touching {
            [true, true, false] => Some(Self::Tread),
            [false, true, true] => Some(Self::Flange),
            [true, _, true] => Some(Self::Wide),
            _ => None,
        }
    }

    fn ink(self) -> plotters::style::RGBColor {
        match self {
            Self::Tread => colour(Slot::Tread),
            Self::Flange => colour(Slot::Flange),
            Self::Wide => INK,
        }
    }
}

/// Where the right wheel touches twice, row by row of yaw.
struct Map {
    yaws: Vec<f64>,
    step: f64,
    /// Lateral position, yaw, band.
    cells: Vec<(f64, f64, Band)>,
}

fn map(pair: &Pair, [from, to]: [f64; 2], step: f64, largest_yaw: f64, rows: usize) -> Map {
    let yaws: Vec<f64> = (0..=rows).map(|j| largest_yaw * j as f64 / rows as f64).collect();
    let columns = ((to - from) / step).round() as usize;
    let poses: Vec<(f64, f64)> =
        yaws.iter().flat_map(|yaw| (0..=columns).map(move |i| (from + step * i as f64, *yaw))).collect();
    let band = |&(y, yaw): &(f64, f64)| {
        let rest = two_wheels(pair, y, yaw)?;
        let pose = Pose { lateral: y, yaw, vertical: 0.0, roll: rest.roll };
        let mut column = pair.column(Side::Right, &pose);
        let height = height_for_load(&mut column, LOAD)?;
        let touching = column.slots(height).map(|slot| slot.normal_force() > SHARE * LOAD);
        Some((y, yaw, Band::of(touching)?))
    };
    Map { yaws, step, cells: poses.par_iter().filter_map(band).collect() }
}

impl Map {
    /// Begin and end (m) of a band at a yaw.
    fn extent(&self, band: Band, yaw: f64) -> Option<[f64; 2]> {
        let mut of = self.cells.iter().filter(|c| c.1 == yaw && (c.2 == band || c.2 == Band::Wide)).map(|c| c.0);
        let first = of.next()?;
        Some([first, of.next_back().unwrap_or(first)])
    }

    /// Mean width (m) of a band over all yaws, counted in cells.
    fn width(&self, band: Band) -> f64 {
        let cells = self.cells.iter().filter(|c| c.2 == band || c.2 == Band::Wide).count();
        self.step * cells as f64 / self.yaws.len() as f64
    }

    fn picture(&self, name: &str, title: &str, bands: &[(Band, String)], range: [f64; 2]) -> Result<String> {
        let height = self.yaws[1];
        let cell = |&(y, yaw, band): &(f64, f64, Band)| {
            let corner = [1e3 * (y - 0.5 * self.step), 1e3 * (yaw - 0.5 * height), 1e3 * self.step, 1e3 * height];
            (corner, band.ink())
        };
        let mut panel = Panel::new(title, ["lateral position y (mm)", "yaw (mrad)"], Vec::new());
        let largest = 1e3 * self.yaws[self.yaws.len() - 1];
        panel.ranges = Some([1e3 * range[0]..1e3 * range[1], -0.02 * largest..1.05 * largest]);
        panel.cells = self.cells.iter().map(cell).collect();
        let entries: Vec<_> = bands.iter().map(|(band, text)| (Mark::Dot, band.ink(), text.clone())).collect();
        draw(name, &entries, &[vec![panel]])
    }

    fn csv(&self) -> Result<Vec<u8>> {
        let code = |band| match band {
            Band::Tread => 1.0,
            Band::Flange => 2.0,
            Band::Wide => 3.0,
        };
        csv(&["y_m", "yaw_rad", "band"], self.cells.iter().map(|&(y, yaw, band)| vec![y, yaw, code(band)]))
    }
}

/// Figure 8.
pub(super) fn simplified(grounds: &Grounds) -> Result<Plate> {
    const RANGE: [f64; 2] = [1e-3, 3e-3];
    let map = map(&grounds.simplified.pair, RANGE, 5e-6, 20e-3, 40);
    // With two regions alone, the flange line lies in the second slot.
    let extents: Vec<_> = map.yaws.iter().filter_map(|yaw| map.extent(Band::Tread, *yaw)).collect();
    let middles: Vec<f64> = extents.iter().map(|[a, b]| 0.5 * (a + b)).collect();
    let (Some(first), Some(last)) = (middles.first(), middles.last()) else {
        return Err(crate::error::Error::field("", "figure 8", "the simplified pair never touches twice"));
    };
    let (first, last, width) = (1e3 * first, 1e3 * last, 1e3 * map.width(Band::Tread));
    let falls = middles.windows(2).all(|w| w[1] <= w[0] + map.step) && last < first;
    let text = format!("tread and flange line both bear at {} kN", 1e-3 * LOAD);
    let svg = map.picture(
        "two-contact positions of the simplified pair",
        "simplified pair, right wheel",
        &[(Band::Tread, text)],
        RANGE,
    )?;
    Ok(Plate {
        number: 8,
        stem: "fig08".into(),
        title: "Two-contact positions of the simplified pair",
        svg,
        csv: map.csv()?,
        theirs: "The positions with two contacts form a narrow band at the transition to the flange, near y = 2 mm \
                 without yaw, which moves to smaller y as the yaw grows.",
        ours: format!(
            "One band, on average {width:.3} mm wide under {} kN, at y = {first:.2} mm without yaw and {last:.2} mm at 20 \
             mrad.",
            1e-3 * LOAD
        ),
        difference: "Agrees. That it begins near 2 mm is so by our choice of the wheels' spacing.",
        checks: vec![
            Check {
                figure: 8,
                claim: "two-contact positions form a narrow band near the flange transition",
                measured: width,
                unit: "mm wide on average; narrow is below 0.5 mm",
                holds: width > 0.0 && width < 0.5,
            },
            Check {
                figure: 8,
                claim: "the band lies near y = 2 mm at zero yaw",
                measured: first,
                unit: "mm",
                holds: (first - 2.0).abs() < 0.3,
            },
            Check {
                figure: 8,
                claim: "the band moves to smaller y as the yaw grows",
                measured: last - first,
                unit: "mm from yaw 0 to 20 mrad, falling all the way",
                holds: falls,
            },
        ],
    })
}

/// Figure 12.
pub(super) fn urban(grounds: &Grounds) -> Result<Plate> {
    const RANGE: [f64; 2] = [3.5e-3, 4.5e-3];
    let map = map(&grounds.urban.pair, RANGE, 1e-5, 40e-3, 40);
    let (tread, flange) = (1e3 * map.width(Band::Tread), 1e3 * map.width(Band::Flange));
    let place = |band| map.extent(band, 0.0).map_or([f64::NAN; 2], |ends| ends.map(|y| 1e3 * y));
    let ([tread_from, tread_to], [flange_from, flange_to]) = (place(Band::Tread), place(Band::Flange));
    let bands = [
        (Band::Tread, "tread and throat".to_string()),
        (Band::Flange, "throat and flange".to_string()),
        (Band::Wide, "all three, or tread and flange".to_string()),
    ];
    Ok(Plate {
        number: 12,
        stem: "fig12".into(),
        title: "Two-contact positions of the urban pair",
        svg: map.picture(
            "two-contact positions of the urban pair",
            &format!("{STAND_IN}, right wheel"),
            &bands,
            RANGE,
        )?,
        csv: map.csv()?,
        theirs: "The worn-like DT14 profile has two bands of two-contact positions: one at the transition to the flange, \
                 and a wider one on the tread.",
        ours: format!(
            "Two bands too, under {} kN: without yaw tread and throat from y = {tread_from:.2} to {tread_to:.2} mm, throat \
             and flange from {flange_from:.2} to {flange_to:.2} mm. Over all yaws they are {tread:.2} and {flange:.2} mm wide \
             on average.",
            1e-3 * LOAD
        ),
        difference: "Another wheel: DT14 is not published, and the stand-in was chosen to have both bands. As the yaw grows \
                     its flange touches earlier, its throat hardly does: the bands meet, and there all three bear. Two \
                     contacts that both lie on one region share a slot and are not shown.",
        checks: vec![
            Check {
                figure: 12,
                claim: "two bands, one at the flange transition and one on the tread",
                measured: flange_from - tread_to,
                unit: "mm between the bands at zero yaw",
                holds: flange_from > tread_to,
            },
            Check {
                figure: 12,
                claim: "the band on the tread is the wider one",
                measured: tread / flange,
                unit: "times the width of the band at the flange",
                holds: tread > flange,
            },
        ],
    })
}
