//! Mutated literals for the text parser: whatever comes, it answers at once, without a panic, and soundly.
//!
//! `IVSID_FUZZ_SECONDS` sets how long (default 2; `make fuzz` runs ten minutes).
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(clippy::print_stdout, clippy::cast_possible_truncation, reason = "a report; random bits are cut on purpose")]

mod common;

use common::Random;
use interval_core::exact::{from_text, ratio_down, ratio_up};
use interval_core::{DecoratedInterval, Interval};
use std::time::{Duration, Instant};

const SEEDS: [&str; 16] = [
    "[0.1, 0.2]",
    "[1/3]",
    "[-inf, 0x1.8p-3]",
    "3.56?1",
    "-10?2ue3",
    "[empty]_trv",
    "[entire]",
    "[nai]",
    "[1,2]_com",
    "[,]",
    "1e-400",
    "2.5??d",
    "[0x.fp+1023, 1E+400]",
    "[9007199254740993]",
    "1.0000000000000001?1_dac",
    "[ - 1 , + 1 ]",
];
const ALPHABET: &[u8] = b"0123456789.,?[]/+-eEpPxXuUdD_ \tcomdactrvdefillinfnaiempty\xc3\xa9\0";

fn mutate(text: &str, random: &mut Random) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=random.bits() % 6 {
        let choice = random.bits();
        let letter = ALPHABET[(choice >> 20) as usize % ALPHABET.len()];
        let at = (choice >> 40) as usize % (bytes.len() + 1);
        match choice % 5 {
            0 | 1 => bytes.insert(at, letter),
            2 if at < bytes.len() => bytes[at] = letter,
            3 if at < bytes.len() => drop(bytes.remove(at)),
            4 => {
                // Long runs, which is where a parser can be slow.
                let run = vec![letter; (choice >> 8) as usize % 4096];
                bytes.splice(at..at, run);
            }
            _ => {}
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[test]
fn mutated_literals() {
    let seconds = std::env::var("IVSID_FUZZ_SECONDS").ok().and_then(|s| s.parse().ok()).unwrap_or(2);
    let end = Instant::now() + Duration::from_secs(seconds);
    let mut random = Random(seconds);
    let (mut total, mut read, mut slowest) = (0_u64, 0_u64, Duration::ZERO);
    while Instant::now() < end {
        let text = mutate(SEEDS[random.bits() as usize % SEEDS.len()], &mut random);
        let start = Instant::now();
        let bare = text.parse::<Interval>();
        let literal = Interval::from_literal(&text);
        let decorated = text.parse::<DecoratedInterval>();
        slowest = slowest.max(start.elapsed());
        total += 1;
        if let Ok(x) = bare {
            read += 1;
            assert_eq!(literal.map(|(y, _)| y), Ok(x), "{text:?}");
            assert_eq!(x.to_exact().parse::<Interval>(), Ok(x), "{text:?}");
            if let Some(exact) = from_text(text.trim()) {
                assert_eq!((x.lo(), x.hi()), (ratio_down(&exact), ratio_up(&exact)), "{text:?}");
            }
        }
        if let Ok(x) = decorated {
            assert!(x.is_nai() || x.to_string().parse::<DecoratedInterval>().is_ok(), "{text:?}");
        }
    }
    println!("{total} literals, {read} read, the slowest in {slowest:?}");
    assert!(slowest < Duration::from_secs(1), "{slowest:?}");
    assert!(read > 0);
}
