//! Placeholder, replaced in the next commit.
#![no_std]
