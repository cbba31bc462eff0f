"""Checks of the packages that ``make wheel`` leaves in dist: python -m tests.packages.

The wheel's platform tag is what auditwheel finds, its files are those of the tree, all three packages have one version and the
licences, and none holds tests, benchmarks or what a build leaves behind. Sizes are printed.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
DIST = ROOT / "dist"
LICENCES = {"LICENSE", "LICENSE-APACHE", "LICENSE-MIT", "LICENSE-THIRD-PARTY"}


def version() -> str:
    """The version of the workspace, from which all others come."""
    found: str = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]["version"]
    return found


def tracked(folder: str) -> set[str]:
    """Files of a folder that git knows, relative to it; in an unpacked archive all that no build leaves behind."""
    listed = subprocess.run(["git", "ls-files", folder], cwd=ROOT, capture_output=True, text=True, check=False)
    if listed.returncode == 0 and listed.stdout:
        return {Path(line).relative_to(folder).as_posix() for line in listed.stdout.splitlines()}
    files = (p for p in (ROOT / folder).rglob("*") if p.is_file() and p.suffix not in (".so", ".pyd", ".pyc"))
    return {p.relative_to(ROOT / folder).as_posix() for p in files}


def wheel_faults(path: Path, auditwheel: str) -> list[str]:
    """Faults of a wheel; ``auditwheel`` is the program, or empty where the platform has none."""
    with zipfile.ZipFile(path) as archive:
        names = set(archive.namelist())
    info = f"ivsid-{version()}.dist-info"
    package = {n.removeprefix("ivsid/") for n in names if n.startswith("ivsid/")}
    core = {n for n in package if n.startswith("_core.") and not n.endswith(".pyi")}
    found = [] if path.name.startswith(f"ivsid-{version()}-cp311-abi3-") else [f"{path.name}: another version or tag"]
    found += [f"not in the wheel: {n}" for n in sorted(tracked("python/ivsid") - package)]
    found += [f"not of the tree: {n}" for n in sorted(package - core - tracked("python/ivsid"))]
    found += [f"outside of the package: {n}" for n in sorted(names) if not n.startswith(("ivsid/", info))]
    found += [f"no {n} in the wheel" for n in sorted(LICENCES) if f"{info}/licenses/{n}" not in names]
    if len(core) != 1:
        found.append(f"{len(core)} compiled modules")
    if auditwheel:
        said = subprocess.run([auditwheel, "show", str(path)], capture_output=True, text=True, check=True).stdout
        tag = re.search(r'platform tag:\s*"(\w+)"', said)
        if tag is None or not path.name.endswith(f"-{tag[1]}.whl"):
            found.append(f"auditwheel finds {tag[1] if tag else 'no tag'} for {path.name}")
    return found


def source_faults(path: Path) -> list[str]:
    """Faults of the source distribution."""
    head = f"ivsid-{version()}/"
    with tarfile.open(path) as archive:
        names = {n.removeprefix(head) for n in archive.getnames()}
    needed = LICENCES | {"PKG-INFO", "Cargo.lock", "Cargo.toml", "pyproject.toml", "README.md", "CITATION.cff"}
    needed |= {f"python/ivsid/{n}" for n in tracked("python/ivsid")}
    needed |= {
        f"crates/{c}/src/{n}"
        for c in ("filter-core", "interval-core", "onboard", "pyivsid")
        for n in tracked(f"crates/{c}/src")
    } | {"crates/interval-core/build.rs"}
    stray = [
        n for n in names if n.startswith(("tests/", "benches/", "docs/", "target/")) or n.endswith((".so", ".pyc"))
    ]
    return [f"not in the source: {n}" for n in sorted(needed - names)] + [f"does not belong: {n}" for n in stray]


def crate_faults(path: Path) -> list[str]:
    """Faults of the public crate: its sources, its page and its licences, and no more."""
    head = f"interval-core-{version()}/"
    with tarfile.open(path) as archive:
        names = {n.removeprefix(head) for n in archive.getnames()}
    crate = "crates/interval-core"
    needed = {f"{d}/{n}" for d in ("src", "examples") for n in tracked(f"{crate}/{d}")}
    needed |= {"build.rs", "README.md", "LICENSE-APACHE", "LICENSE-MIT"}
    made = {"Cargo.toml", "Cargo.toml.orig", "Cargo.lock", ".cargo_vcs_info.json"}
    return [f"not in the crate: {n}" for n in sorted(needed - names)] + [
        f"does not belong: {n}" for n in sorted(names - needed - made)
    ]


def main() -> int:
    """Checks what lies in dist, and prints sizes."""
    auditwheel = ROOT / ".venv" / "tools" / "bin" / "auditwheel"
    wheels, sources = list(DIST.glob("*.whl")), list(DIST.glob("ivsid-*.tar.gz"))
    crates = list(DIST.glob("*.crate"))
    if not (wheels and len(sources) == len(crates) == 1):
        sys.stderr.write("dist holds no wheel, source distribution or crate: make wheel\n")
        return 2
    faults = [f for w in wheels for f in wheel_faults(w, str(auditwheel) if sys.platform == "linux" else "")]
    faults += source_faults(sources[0]) + crate_faults(crates[0])
    for path in (*wheels, *sources, *crates):
        sys.stdout.write(f"{path.name}: {path.stat().st_size / 1e6:.2f} MB\n")
    sys.stdout.writelines(f"{fault}\n" for fault in faults)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
