//! Normal contact of elastic half-spaces on a grid of rectangles with uniform pressure each.

mod convolution;
mod fourier;
mod influence;
mod levels;
mod normal;
mod patch;
mod stencil;

pub use influence::influence;
pub use levels::Grid;
pub use normal::TOLERANCE;
pub use patch::{EDGES, Patch, PatchRow, RowLoad, interaction, patches};
