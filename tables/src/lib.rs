//! Recipes for common wheel and rail pairs, as text, and a small table of each, ready for the kernel.
//!
//! A table is a static in read-only memory, aligned to a cache line. It is compiled from the recipe beside it under a
//! budget of [`SMALL_BYTES`], which stands above the recipe's own `max_bytes`; `regenerate.sh` beside this crate rewrites
//! the tables, and its `README.md` says how accurate they are. The format is specified in `FORMAT.md`.
#![no_std]

/// S1002 wheel on 60E1 rail inclined 1:40, standard gauge: the recipe of `flangeway quickstart`.
pub const S1002_60E1_40: &str = include_str!("../recipes/s1002_60e1_40.toml");
/// S1002 wheel on 60E1 rail inclined 1:20, standard gauge.
pub const S1002_60E1_20: &str = include_str!("../recipes/s1002_60e1_20.toml");
/// S1002 wheel on 54E1 rail inclined 1:20, standard gauge.
pub const S1002_54E1_20: &str = include_str!("../recipes/s1002_54e1_20.toml");
/// The paper's simplified pair: circular rail, wheel of two straight lines.
pub const SIMPLIFIED_PAIR: &str = include_str!("../recipes/simplified_pair.toml");
/// Stand-in for the paper's urban metre-gauge vehicle.
pub const URBAN_METRE_GAUGE: &str = include_str!("../recipes/urban_metre_gauge.toml");

/// Byte budget (`compile --max-bytes`) of the committed tables.
pub const SMALL_BYTES: u64 = 262_144;

/// Bytes that begin on a cache line.
#[repr(C, align(64))]
struct Aligned<T: ?Sized>(T);

static S1002_60E1_40_IMAGE: &Aligned<[u8]> = &Aligned(*include_bytes!("../s1002_60e1_40.fwt"));
static S1002_60E1_20_IMAGE: &Aligned<[u8]> = &Aligned(*include_bytes!("../s1002_60e1_20.fwt"));
static S1002_54E1_20_IMAGE: &Aligned<[u8]> = &Aligned(*include_bytes!("../s1002_54e1_20.fwt"));
static SIMPLIFIED_PAIR_IMAGE: &Aligned<[u8]> = &Aligned(*include_bytes!("../simplified_pair.fwt"));
static URBAN_METRE_GAUGE_IMAGE: &Aligned<[u8]> = &Aligned(*include_bytes!("../urban_metre_gauge.fwt"));

/// Small table of [`S1002_60E1_40`].
pub static S1002_60E1_40_TABLE: &[u8] = &S1002_60E1_40_IMAGE.0;
/// Small table of [`S1002_60E1_20`].
pub static S1002_60E1_20_TABLE: &[u8] = &S1002_60E1_20_IMAGE.0;
/// Small table of [`S1002_54E1_20`].
pub static S1002_54E1_20_TABLE: &[u8] = &S1002_54E1_20_IMAGE.0;
/// Small table of [`SIMPLIFIED_PAIR`].
pub static SIMPLIFIED_PAIR_TABLE: &[u8] = &SIMPLIFIED_PAIR_IMAGE.0;
/// Small table of [`URBAN_METRE_GAUGE`].
pub static URBAN_METRE_GAUGE_TABLE: &[u8] = &URBAN_METRE_GAUGE_IMAGE.0;

/// A pair with its recipe and its small table.
#[derive(Debug, Clone, Copy)]
pub struct Committed {
    /// File stem of recipe and table.
    pub name: &'static str,
    /// The recipe's text.
    pub recipe: &'static str,
    /// The table's image, for `flangeway::ContactTable::new`.
    pub image: &'static [u8],
}

/// All pairs.
pub static ALL: [Committed; 5] = [
    Committed { name: "s1002_60e1_40", recipe: S1002_60E1_40, image: &S1002_60E1_40_IMAGE.0 },
    Committed { name: "s1002_60e1_20", recipe: S1002_60E1_20, image: &S1002_60E1_20_IMAGE.0 },
    Committed { name: "s1002_54e1_20", recipe: S1002_54E1_20, image: &S1002_54E1_20_IMAGE.0 },
    Committed { name: "simplified_pair", recipe: SIMPLIFIED_PAIR, image: &SIMPLIFIED_PAIR_IMAGE.0 },
    Committed { name: "urban_metre_gauge", recipe: URBAN_METRE_GAUGE, image: &URBAN_METRE_GAUGE_IMAGE.0 },
];

/// Scenario of the paper's section 5: a single wheelset with simplified profiles, R = 1000 m at 15 m/s.
pub const WHEELSET_R1000: &str = include_str!("../scenarios/wheelset_r1000.toml");
/// Recipe of the pair on which `flangeway reproduce` runs [`BOGIE_R60`]; its table is compiled there.
pub const URBAN_ARCS: &str = include_str!("../scenarios/urban_arcs.toml");
/// Scenario of the paper's section 6: a metre-gauge bogie, R = 60 m at 15 m/s.
pub const BOGIE_R60: &str = include_str!("../scenarios/bogie_r60.toml");
