//! Recipes for common wheel and rail pairs, as text. The table format is specified in `FORMAT.md` beside this crate.
