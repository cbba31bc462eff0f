//! Follows rows that come through a pipe: a line of CSV in, the bounds of every parameter out.
//!
//! `simulator | cargo run --release -p onboard --example follow -- 2 --start=-1e6,1e6 --every 100`
//!
//! A line holds `time, y, accuracy of y` and for each parameter `reading, accuracy`. Lines that begin with a letter or
//! `#` are titles. Every so many lines the bounds are written, and at once where nothing explains the rows.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example prints")]

use onboard::{Bounds, Follower, State};
use std::io::{BufRead, Write};
use std::process::ExitCode;

/// What the arguments ask for.
struct Asked {
    columns: usize,
    start: Bounds,
    every: u64,
    rates: f64,
}

fn asked() -> Result<Asked, String> {
    let usage = "usage: follow COLUMNS [--start=LO,HI] [--every N] [--rate R], COLUMNS from 1 to 9";
    let mut asked = Asked { columns: 0, start: Bounds::new(-1e6, 1e6), every: 100, rates: 0.0 };
    let words: Vec<String> =
        std::env::args().skip(1).flat_map(|a| a.split('=').map(str::to_owned).collect::<Vec<_>>()).collect();
    let mut words = words.into_iter();
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("{word} needs a value; {usage}"));
        let number = |text: String| text.parse::<f64>().map_err(|_| format!("{text} is no number; {usage}"));
        match word.as_str() {
            "--start" => {
                let text = value()?;
                let (lo, hi) = text.split_once(',').ok_or_else(|| format!("{text} is no LO,HI; {usage}"))?;
                asked.start = Bounds::new(number(lo.to_owned())?, number(hi.to_owned())?);
            }
            "--every" => {
                asked.every = value()?.parse().ok().filter(|n| *n > 0).ok_or("--every needs a count above 0")?;
            }
            "--rate" => asked.rates = number(value()?)?,
            columns => asked.columns = columns.parse().map_err(|_| usage.to_owned())?,
        }
    }
    Ok(asked)
}

/// The numbers of a line; `None` for a title.
fn numbers<const COUNT: usize>(line: &str) -> Result<Option<[f64; COUNT]>, String> {
    let text = line.trim();
    if text.is_empty() || text.starts_with(|c: char| c.is_alphabetic() || c == '#') {
        return Ok(None);
    }
    let mut found = [0.0; COUNT];
    let mut fields = text.split(',');
    for x in &mut found {
        let field = fields.next().ok_or_else(|| format!("{text:?} has fewer than {COUNT} numbers"))?.trim();
        *x = field.parse().map_err(|_| format!("{field:?} is no number"))?;
    }
    if fields.next().is_some() {
        return Err(format!("{text:?} has more than {COUNT} numbers"));
    }
    Ok(Some(found))
}

fn follow<const N: usize, const FIELDS: usize>(asked: &Asked) -> Result<(), String> {
    let mut follower = Follower::<N, 160>::drifting([asked.start; N], [asked.rates; N]).map_err(|e| e.to_string())?;
    let mut out = std::io::stdout().lock();
    let mut taken = 0_u64;
    for line in std::io::stdin().lock().lines() {
        let line = line.map_err(|e| e.to_string())?;
        let Some(found) = numbers::<FIELDS>(&line)? else { continue };
        let (time, y, accuracy) = (found[0], found[1], found[2]);
        let readings = std::array::from_fn(|j| found[3 + 2 * j]);
        let accuracies = std::array::from_fn(|j| found[4 + 2 * j]);
        let state =
            follower.sample(time, &readings, &accuracies, y, accuracy).map_err(|e| format!("line {line:?}: {e}"))?;
        taken += 1;
        if let State::Empty(proof) = state {
            let words =
                format!("no parameters explain the rows up to {time} s; the proof goes back to {} s", proof.oldest);
            return writeln!(out, "{words}").map_err(|e| e.to_string());
        }
        if taken.is_multiple_of(asked.every) {
            let bounds: Vec<String> = follower.bounds().iter().map(|x| format!("[{:?}, {:?}]", x.lo, x.hi)).collect();
            writeln!(out, "{time}: {}", bounds.join(" ")).and_then(|()| out.flush()).map_err(|e| e.to_string())?;
        }
    }
    Ok(())
}

fn main() -> ExitCode {
    let result = asked().and_then(|asked| match asked.columns {
        1 => follow::<1, 5>(&asked),
        2 => follow::<2, 7>(&asked),
        3 => follow::<3, 9>(&asked),
        4 => follow::<4, 11>(&asked),
        5 => follow::<5, 13>(&asked),
        6 => follow::<6, 15>(&asked),
        7 => follow::<7, 17>(&asked),
        8 => follow::<8, 19>(&asked),
        9 => follow::<9, 21>(&asked),
        _ => Err("the number of parameters is from 1 to 9; give it first, as in `follow 2`".to_owned()),
    });
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(words) => {
            eprintln!("{words}");
            ExitCode::from(2)
        }
    }
}
