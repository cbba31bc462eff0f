"""A wheel in an environment of its own, away from the tree: the tutorial's commands, and the minutes that they take.

Run: python -m tests.try_wheel dist/NAME.whl [--short], or --source dist/NAME.tar.gz, of which a wheel is built there first.
``--short`` leaves out the steps of more than some seconds. Only the standard library is used.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
import venv
from pathlib import Path

from tests.page_steps import follow, steps

PAGE = Path(__file__).resolve().parents[1] / "docs" / "tutorial.md"
# Commands that fit, diagnose or prove.
LONG = ("ivsid diagnose", "ivsid identify fixed.toml", "ivsid verify")


def said(words: list[str], environment: dict[str, str], refused: bool = False) -> str:
    """What a program prints; it ends well, or with a sentence where the page shows a refusal."""
    done = subprocess.run(words, env=environment, capture_output=True, text=True, encoding="utf-8", check=False)
    if done.returncode not in ((0, 2) if refused else (0,)):
        raise RuntimeError(f"{words} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout or done.stderr


def main() -> int:
    """Installs, imports, follows the tutorial; prints the times."""
    arguments = argparse.ArgumentParser()
    arguments.add_argument("package", type=Path)
    arguments.add_argument("--source", action="store_true")
    arguments.add_argument("--short", action="store_true")
    chosen = arguments.parse_args()
    package = chosen.package.resolve(strict=True)
    # Nothing of the tree may be found.
    outside = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "VIRTUAL_ENV")}
    outside |= {"PYTHONUTF8": "1"}
    home = Path.cwd()
    with tempfile.TemporaryDirectory() as place:
        os.chdir(place)
        outside["XDG_CACHE_HOME"] = str(Path(place) / "cache")
        begin = time.monotonic()
        venv.create("own", with_pip=True)
        programs = Path(place) / "own" / ("Scripts" if os.name == "nt" else "bin")
        python = str(programs / "python")
        times = {"environment": time.monotonic() - begin}

        def timed(name: str, words: list[str], refused: bool = False) -> str:
            start = time.monotonic()
            text = said(words, outside, refused)
            times[name] = times.get(name, 0.0) + time.monotonic() - start
            return text

        pip = [python, "-m", "pip", "--disable-pip-version-check", "--quiet"]
        if chosen.source:
            timed("wheel of the source", [*pip, "wheel", "--no-deps", "--wheel-dir", "made", str(package)])
            (package,) = (Path(place) / "made").glob("*.whl")
        timed("installation", [*pip, "install", str(package)])
        where = timed("import", [python, "-c", "import ivsid; print(ivsid.__file__)"]).strip()
        if not Path(where).resolve().is_relative_to(Path(place).resolve()):
            raise RuntimeError(f"{where} is not of the new environment")
        timed("import once more", [python, "-c", "import ivsid"])
        found = [s for s in steps(PAGE.read_text(encoding="utf-8")) if not (chosen.short and s.text.startswith(LONG))]
        for step in found:
            follow(step, lambda words: timed("tutorial", [str(programs / "ivsid"), *words], refused=True), str)
        total = time.monotonic() - begin
        os.chdir(home)
    sys.stdout.writelines(f"{name}: {spent:.1f} s\n" for name, spent in times.items())
    sys.stdout.write(f"{len(found)} steps of the tutorial followed; {total / 60:.1f} minutes from nothing\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
