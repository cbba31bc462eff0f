//! inari and this crate on the same operands in the same process: `name, peer's M intervals/s, ours, ratio`.
fn main() {}
