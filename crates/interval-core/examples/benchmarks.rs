//! Sets of solutions that other tools bound too, without any option: the benchmarks LALO20 and CVDP23 of ARCH-COMP, and
//! Lotka and Volterra's equations from the start of its LOVO21.
//!
//! LALO20: Laub and Loomis, Mol. Biol. Cell 9 (1998); CVDP23, LOVO21: Geretti et al., ARCH-COMP reports on nonlinear dynamics.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(clippy::print_stdout, reason = "an example prints")]

use interval_core::reach::{System, Term, follow};
use interval_core::{Error, Interval};
use std::time::Instant;

/// A table of one equation: each coefficient as text, and its components, one mention a power.
type Table<'a> = &'a [(&'a str, &'a [usize])];

fn system(equations: &[Table]) -> Result<System, Error> {
    let term = |&(text, factors): &(&str, &[usize])| {
        let mut powers = vec![0; equations.len()];
        for &i in factors {
            powers[i] += 1;
        }
        Ok(Term { coefficient: text.parse()?, powers })
    };
    let tables = equations.iter().map(|terms| terms.iter().map(term).collect());
    System::new(&tables.collect::<Result<Vec<_>, Error>>()?)
}

fn lalo20() -> Result<System, Error> {
    system(&[
        &[("[1.4]", &[2]), ("[-0.9]", &[0])],
        &[("[2.5]", &[4]), ("[-1.5]", &[1])],
        &[("[0.6]", &[6]), ("[-0.8]", &[1, 2])],
        &[("[2]", &[]), ("[-1.3]", &[2, 3])],
        &[("[0.7]", &[0]), ("[-1]", &[3, 4])],
        &[("[0.3]", &[0]), ("[-3.1]", &[5])],
        &[("[1.8]", &[5]), ("[-1.5]", &[1, 6])],
    ])
}

/// x1, y1, x2, y2 and the coupling b: `y' = (1 - x^2) y + b (x_other - x) - x`.
fn cvdp23() -> Result<System, Error> {
    let one = "[1]";
    let less = "[-1]";
    system(&[
        &[(one, &[1])],
        &[(one, &[1]), (less, &[0, 0, 1]), (one, &[4, 2]), (less, &[4, 0]), (less, &[0])],
        &[(one, &[3])],
        &[(one, &[3]), (less, &[2, 2, 3]), (one, &[4, 0]), (less, &[4, 2]), (less, &[2])],
        &[],
    ])
}

fn lotka_volterra() -> Result<System, Error> {
    system(&[&[("[3]", &[0]), ("[-3]", &[0, 1])], &[("[1]", &[0, 1]), ("[-1]", &[1])]])
}

fn bounded(name: &str, system: &System, start: &[&str], horizon: f64, shown: usize) -> Result<(), Error> {
    let start = start.iter().map(|text| text.parse()).collect::<Result<Vec<Interval>, _>>()?;
    let began = Instant::now();
    let tube = follow(system, &start, horizon)?;
    let seconds = began.elapsed().as_secs_f64();
    let Some(last) = tube.nodes.last() else {
        println!("{name}: no step was proved");
        return Ok(());
    };
    let highest = tube.nodes.iter().map(|node| node.over[shown].hi()).fold(f64::NEG_INFINITY, f64::max);
    let widths: Vec<String> = last.state.iter().map(|x| format!("{:.5}", x.width())).collect();
    println!(
        "{name}: until {:.4} in {} steps and {seconds:.2} s; component {} at most {highest:.4}; widths {}",
        last.time,
        tube.nodes.len(),
        shown + 1,
        widths.join(" ")
    );
    Ok(())
}

fn main() -> Result<(), Error> {
    for w in ["0.01", "0.05", "0.1"] {
        let start = ["1.2", "1.05", "1.5", "2.4", "1", "0.1", "0.45"];
        let boxes: Vec<String> = start.iter().map(|x| around(x, w)).collect::<Result<_, _>>()?;
        let texts: Vec<&str> = boxes.iter().map(String::as_str).collect();
        bounded(&format!("LALO20 W = {w}"), &lalo20()?, &texts, 20.0, 3)?;
    }
    let x = "[1.25, 1.55]";
    let y = "[2.35, 2.45]";
    for b in ["[1]", "[1, 1.2]", "[1, 3]"] {
        bounded(&format!("CVDP23 b = {b}"), &cvdp23()?, &[x, y, x, y, b], 7.0, 1)?;
    }
    for (parts, places) in [(10, 1), (20, 2), (10, 4)] {
        in_pieces(parts, places)?;
    }
    for x in ["[1.292, 1.308]", "[1.288, 1.312]"] {
        bounded(&format!("Lotka-Volterra x = {x}"), &lotka_volterra()?, &[x, "[1]"], 3.64, 0)?;
    }
    Ok(())
}

/// CVDP23 for b of `[1, 3]`, each of `parts` equal parts of b and of `places` equal parts of x1 and of x2 by itself: every
/// start and b lies in one of them.
fn in_pieces(parts: u32, places: u32) -> Result<(), Error> {
    let system = cvdp23()?;
    let began = Instant::now();
    let y: Interval = "[2.35, 2.45]".parse()?;
    let (mut highest, mut earliest) = (f64::NEG_INFINITY, f64::INFINITY);
    let (mut last, mut steps) = (vec![Interval::EMPTY; 5], 0);
    let (bs, xs) = (pieces("[1, 3]", parts)?, pieces("[1.25, 1.55]", places)?);
    for &b in &bs {
        for &x1 in &xs {
            for &x2 in &xs {
                let tube = follow(&system, &[x1, y, x2, y, b], 7.0)?;
                steps += tube.nodes.len();
                highest = tube.nodes.iter().map(|n| n.over[1].hi().max(n.over[3].hi())).fold(highest, f64::max);
                if let Some(node) = tube.nodes.last() {
                    earliest = earliest.min(node.time);
                    last = last.iter().zip(&node.state).map(|(a, &b)| a.hull(b)).collect();
                }
            }
        }
    }
    println!(
        "CVDP23 b = [1, 3] in {parts}, x1 and x2 in {places}: until {earliest:.4} in {steps} steps and {:.2} s; y at most {highest:.4}; widths {}",
        began.elapsed().as_secs_f64(),
        last.iter().map(|x| format!("{:.5}", x.width())).collect::<Vec<_>>().join(" ")
    );
    Ok(())
}

/// Equal parts of an interval, which share their ends.
fn pieces(text: &str, count: u32) -> Result<Vec<Interval>, Error> {
    let whole: Interval = text.parse()?;
    let end = |k: u32| {
        let share = f64::from(k) / f64::from(count);
        if k == count { whole.hi() } else { whole.lo() + share * (whole.hi() - whole.lo()) }
    };
    (0..count).map(|k| Interval::new(end(k), end(k + 1))).collect()
}

/// `[x - w, x + w]`, outward.
fn around(x: &str, w: &str) -> Result<String, Error> {
    let (x, w): (Interval, Interval) = (format!("[{x}]").parse()?, format!("[-{w}, {w}]").parse()?);
    Ok((x + w).to_exact())
}
