//! The layers of the crates: a module uses only what stands above it in the tables of ARCHITECTURE.md, bottom to top
//! there.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The beginnings of the tables' sections.
const HEADING: &str = "`crates/interval-core/src`";
const ONBOARD: &str = "`crates/onboard/src`";

/// Names in backticks, without the slash of a folder.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2).map(|name| name.trim_end_matches('/'))
}

/// Modules by rank: line by line, and from left to right on a line.
fn ranks(architecture: &str, heading: &str) -> BTreeMap<String, usize> {
    let section = architecture.split(heading).nth(1).expect("ARCHITECTURE.md has the section");
    let rows = section.lines().skip_while(|l| !l.starts_with('|')).take_while(|l| l.starts_with('|'));
    let cells = rows.skip(2).map(|row| row.split('|').nth(1).expect("a table has cells"));
    cells.flat_map(quoted).enumerate().map(|(rank, name)| (name.to_owned(), rank)).collect()
}

fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("the sources are readable") {
        let path = entry.expect("the sources are readable").path();
        if path.is_dir() {
            sources(&path, into);
        } else if path.extension().is_some_and(|e| e == "rs") {
            into.push(path);
        }
    }
}

/// The path of modules that a file is: `a/b.rs` and `a/b/mod.rs` are `[a, b]`.
fn modules(path: &Path, root: &Path) -> Vec<String> {
    let inner = path.strip_prefix(root).expect("a source").with_extension("");
    let mut names: Vec<String> = inner.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    names.pop_if(|last| last == "mod" || last == "lib");
    names
}

/// The code of a line, without its comment.
fn code(line: &str) -> &str {
    line.split("//").next().unwrap_or(line)
}

/// Names after the `::` that a text begins with: `::a::{b, c::d}` gives `a::b` and `a::c::d`.
fn paths(text: &str) -> Vec<Vec<String>> {
    let Some(rest) = text.strip_prefix("::") else { return vec![Vec::new()] };
    if let Some(group) = rest.strip_prefix('{') {
        let mut depth = 0_i32;
        let mut parts = vec![String::new()];
        for c in group.chars() {
            match c {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    parts.push(String::new());
                    continue;
                }
                _ => {}
            }
            parts.last_mut().expect("never empty").push(c);
        }
        return parts.iter().flat_map(|part| paths(&format!("::{}", part.trim()))).collect();
    }
    let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
    if end == 0 {
        return vec![Vec::new()];
    }
    let name = rest[..end].to_owned();
    paths(&rest[end..]).into_iter().map(|path| [vec![name.clone()], path].concat()).collect()
}

/// Absolute paths of all that a file names by `crate::` or `super::`, from the modules that it is.
fn uses(text: &str, module: &[String]) -> Vec<Vec<String>> {
    let text: String = text.lines().map(code).collect::<Vec<_>>().join(" ");
    let mut found = Vec::new();
    let word = |at: usize| !text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
    for (at, _) in text.match_indices("crate::").filter(|(at, _)| word(*at)) {
        found.extend(paths(&text[at + "crate".len()..]));
    }
    for (at, _) in text.match_indices("super::").filter(|(at, _)| word(*at) && !text[..*at].ends_with("super::")) {
        let mut rest = &text[at..];
        let mut place = module.to_vec();
        while let Some(further) = rest.strip_prefix("super::") {
            place.pop();
            rest = further;
        }
        found.extend(paths(&format!("::{rest}")).into_iter().map(|path| [place.clone(), path].concat()));
    }
    found
}

/// The longest beginning of a path that the table ranks.
fn owner(path: &[String], ranks: &BTreeMap<String, usize>) -> Option<(String, usize)> {
    (1..=path.len()).rev().find_map(|n| {
        let name = path[..n].join("/");
        ranks.get(&name).map(|&rank| (name, rank))
    })
}

/// Uses of the source files that point up, and files that the table does not name.
fn faults(root: &Path, ranks: &BTreeMap<String, usize>) -> Vec<String> {
    let mut files = Vec::new();
    sources(root, &mut files);
    files.sort();
    // Names that the crate's root lends: `Error` is `error::Error`.
    let lib = fs::read_to_string(root.join("lib.rs")).expect("the crate has a root");
    let lent: BTreeMap<String, Vec<String>> = (lib.lines())
        .filter_map(|line| code(line).strip_prefix("pub use "))
        .flat_map(|line| paths(&format!("::{line}")))
        .filter_map(|path| Some((path.last()?.clone(), path)))
        .collect();
    let mut found = Vec::new();
    for file in files {
        let module = modules(&file, root);
        if module.is_empty() {
            continue;
        }
        let Some((mine, rank)) = owner(&module, ranks) else {
            found.push(format!("{} is in no row of ARCHITECTURE.md", file.display()));
            continue;
        };
        let text = fs::read_to_string(&file).expect("the sources are readable");
        for path in uses(&text, &module) {
            let path = path.first().and_then(|name| lent.get(name)).unwrap_or(&path);
            match owner(path, ranks) {
                Some((theirs, other)) if other > rank => {
                    found.push(format!("{}: {mine} uses {theirs}, which stands below it", file.display()));
                }
                Some(_) | None => {}
            }
        }
    }
    found.sort();
    found.dedup();
    found
}

fn crate_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

fn table() -> BTreeMap<String, usize> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../ARCHITECTURE.md");
    ranks(&fs::read_to_string(path).expect("the map of the code"), HEADING)
}

#[test]
fn the_follower_uses_only_what_stands_above_it() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let (root, map) = (here.join("crates/onboard/src"), fs::read_to_string(here.join("ARCHITECTURE.md")));
    let mut rows = ranks(&map.expect("the map of the code"), ONBOARD);
    let found = faults(&root, &rows);
    assert!(found.is_empty(), "{}", found.join("\n"));
    for name in rows.keys() {
        assert!(root.join(name).with_extension("rs").is_file(), "ARCHITECTURE.md names {name}, which is no module");
    }
    // With the bounds at the top, every other module would use what stands below it.
    rows.insert("bounds".into(), rows.len());
    assert!(faults(&root, &rows).iter().any(|f| f.contains("half_space uses bounds,")));
}

#[test]
fn each_module_uses_only_what_stands_above_it() {
    let faults = faults(&crate_root(), &table());
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn every_row_names_a_module() {
    let rows = table();
    assert!(rows.len() > 20, "{rows:?}");
    for name in rows.keys() {
        let path = crate_root().join(name);
        assert!(
            path.is_dir() || path.with_extension("rs").is_file(),
            "ARCHITECTURE.md names {name}, which is no module"
        );
    }
}

#[test]
fn a_use_that_points_up_is_found() {
    let mut rows = table();
    // With the arithmetic of intervals at the top, most of the crate would use what stands below it.
    rows.insert("interval".into(), rows.len());
    let faults = faults(&crate_root(), &rows);
    for module in ["matrix", "rounding/slices", "reductions", "regression"] {
        assert!(faults.iter().any(|f| f.contains(&format!("{module} uses interval,"))), "{module}");
    }
}

#[test]
fn paths_are_read_as_the_compiler_reads_them() {
    let here = ["a", "b"].map(String::from);
    let text = "use crate::x::{y, z::W}; // crate::not\nuse super::c;\nuse super::super::d::{e};\nlet t = crate::Error; mycrate::no";
    let found: Vec<String> = uses(text, &here).iter().map(|path| path.join("/")).collect();
    assert_eq!(found, ["x/y", "x/z/W", "Error", "a/c", "d/e"]);
}
