//! Normal contact of elastic half-spaces on a grid of rectangles with uniform pressure each.

mod convolution;
mod influence;
mod normal;
mod patch;
mod stencil;

pub use convolution::Convolution;
pub use influence::influence;
pub use normal::{TOLERANCE, solve};
pub use patch::{EDGES, Patch, PatchRow, RowLoad, interaction, patches};
pub use stencil::Stencil;
