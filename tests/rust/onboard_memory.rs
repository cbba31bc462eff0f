//! The follower's memory: its size, and no allocation after its start.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]

use onboard::{Bounds, Follower, State, Windows};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// The system's allocator, which counts on each thread apart: that of the harness allocates whenever it gets its turn.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call goes to the system's allocator unchanged.
#[expect(unsafe_code, reason = "an allocator cannot be written without it, and nothing else counts allocations")]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn nine_parameters_take_64_kilobytes_and_allocate_nothing() {
    assert!(size_of::<Follower<9, 304>>() <= 64_000, "{} bytes", size_of::<Follower<9, 160>>());
    assert!(size_of::<Windows<9, 304>>() <= 64_000, "{} bytes", size_of::<Windows<9, 160>>());
    let start = [Bounds::new(-100.0, 100.0); 9];
    let mut follower = Follower::<9, 304>::drifting(start, [1e-6; 9]).expect("good rates");
    let mut windows = Windows::<9, 304>::new(start, 10.0).expect("a good window");
    let before = ALLOCATIONS.get();
    let (mut state, mut changes) = (7_u64, 0);
    for k in 0..3000_u32 {
        let mut readings = [0.0; 9];
        for x in &mut readings {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *x = f64::from((state >> 40) as u32) / 8_388_608.0 - 1.0;
        }
        let jump = if k == 2500 { 50.0 } else { 0.0 };
        let right = readings.iter().sum::<f64>() + jump;
        let row = readings.map(|x| Bounds::reading(x, 0.01));
        follower.sample(0.1 * f64::from(k), &readings, &[0.01; 9], right, 0.5).expect("a good sample");
        changes +=
            usize::from(windows.row(0.1 * f64::from(k), &row, Bounds::reading(right, 0.5)).expect("good").is_some());
    }
    let after = ALLOCATIONS.get();
    assert_eq!(after - before, 0);
    // The wrong row was seen: what ran was the whole of the follower.
    assert!(follower.state() != State::Bounded && changes > 0);
    assert_eq!(follower.kept(), 304);
}
