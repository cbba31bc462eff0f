//! Tells the crate which vectors it may ask the processor for: none without the standard library, which does the asking,
//! and AVX-512 only where the compiler has stable intrinsics. Other back ends take their places, with the same bits.

use std::process::Command;

/// The minor version of Rust 1 in which AVX-512 became stable.
const AVX512: u32 = 89;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(avx2, avx512)");
    let x86_64 = std::env::var("CARGO_CFG_TARGET_ARCH").is_ok_and(|arch| arch == "x86_64");
    if !(x86_64 && std::env::var_os("CARGO_FEATURE_STD").is_some()) {
        return;
    }
    println!("cargo::rustc-cfg=avx2");
    if minor_version().is_some_and(|minor| minor >= AVX512) {
        println!("cargo::rustc-cfg=avx512");
    }
}

/// The minor version of the compiler; unknown ones are taken for old.
fn minor_version() -> Option<u32> {
    let output = Command::new(std::env::var_os("RUSTC")?).arg("--version").output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let version = text.split(' ').nth(1)?;
    version.strip_prefix("1.")?.split('.').next()?.parse().ok()
}
