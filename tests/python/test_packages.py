"""Packages: one version, whole licences, a release workflow with the least rights, and a Dockerfile that fits the project."""

import io
import re
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest
import yaml
from tests import packages
from tests.licences import shipped

import ivsid

ROOT = Path(__file__).resolve().parents[2]
WORKFLOW = ROOT / ".github" / "workflows" / "release.yml"
CARGO = tomllib.loads((ROOT / "Cargo.toml").read_text())
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())


def pinned(name: str) -> str:
    (version,) = re.findall(rf"^{name}==(\S+)$", (ROOT / "requirements" / "lock.txt").read_text(), re.M)
    return version


def test_every_version_is_that_of_the_workspace():
    version = CARGO["workspace"]["package"]["version"]
    assert ivsid.__version__ == packages.version() == version
    assert PROJECT["project"]["dynamic"] == ["version"] and "version" not in PROJECT["project"]
    for crate in (ROOT / "crates").glob("*/Cargo.toml"):
        assert tomllib.loads(crate.read_text())["package"]["version"] == {"workspace": True}
    ours = [d["version"] for d in CARGO["workspace"]["dependencies"].values() if isinstance(d, dict) and "path" in d]
    assert ours == [version] * 3
    assert yaml.safe_load((ROOT / "CITATION.cff").read_text())["version"] == version
    assert re.search(rf"^## {re.escape(version)}\b", (ROOT / "CHANGELOG.md").read_text(), re.M)


def test_licences_are_whole_and_go_with_each_package():
    assert set(PROJECT["project"]["license-files"]) == packages.LICENCES
    apache, mit = (ROOT / "LICENSE-APACHE").read_text(), (ROOT / "LICENSE-MIT").read_text()
    assert "END OF TERMS AND CONDITIONS" in apache and all(f"{n}. " in apache for n in range(1, 10))
    assert "Permission is hereby granted" in mit and "OTHERWISE, ARISING FROM" in mit
    for name, text in (("LICENSE-APACHE", apache), ("LICENSE-MIT", mit)):
        assert (ROOT / "crates" / "interval-core" / name).read_text() == text
    # A crate that moved on has its licence read again.
    listed = re.findall(r"^([\w-]+) (\d\S*): ", (ROOT / "LICENSE-THIRD-PARTY").read_text(), re.M)
    locked = {(p["name"], p["version"]) for p in tomllib.loads((ROOT / "Cargo.lock").read_text())["package"]}
    assert len(listed) > 40 and set(listed) <= locked, "make licences"
    # The crates of others in a wheel, and none of the project's own.
    assert set(listed) == shipped(), "make licences"
    direct = {d for c in ("interval-core", "filter-core", "onboard", "pyivsid") for d in crate(c)} - {
        "interval-core",
        "filter-core",
        "onboard",
    }
    assert direct <= {name for name, _ in listed}, "make licences"


def crate(name: str) -> set[str]:
    """Crates that a crate needs as it is built by default."""
    manifest = tomllib.loads((ROOT / "crates" / name / "Cargo.toml").read_text())
    default = set(manifest.get("features", {}).get("default", []))
    return {k for k, v in manifest["dependencies"].items() if "optional" not in v or k in default}


def workflow_faults(text: str) -> list[str]:
    """Rights beyond what a job needs, and actions that are not pinned to a commit."""
    content = yaml.safe_load(text)
    found = [] if content.get("permissions") == {} else ["rights of all jobs"]
    allowed = {"contents": {"read"}, "id-token": {"write"}}
    for name, job in content["jobs"].items():
        rights = job.get("permissions", {})
        found += [f"{name}: {k} {v}" for k, v in rights.items() if v not in allowed.get(k, set())]
        if "id-token" in rights and not (job.get("environment") and job.get("needs") and "push" in job.get("if", "")):
            found.append(f"{name} may publish without a tag, an environment or the jobs before it")
        if "timeout-minutes" not in job:
            found.append(f"{name}: no limit of time")
        for step in job["steps"]:
            if "uses" in step and not re.fullmatch(r"[\w-]+/[\w.-]+@[0-9a-f]{40}", step["uses"]):
                found.append(f"{name}: {step['uses']}")
            found += [f"{name}: a value inside a script" for _ in re.findall(r"\$\{\{", step.get("run", ""))]
    return found


def test_the_release_workflow_has_the_least_rights_and_pinned_actions():
    text = WORKFLOW.read_text()
    assert not workflow_faults(text)
    assert "secrets." not in text
    targets = {m["target"] for m in yaml.safe_load(text)["jobs"]["wheel"]["strategy"]["matrix"]["include"]}
    assert targets == {
        "x86_64-unknown-linux-gnu",
        "aarch64-unknown-linux-gnu",
        "x86_64-apple-darwin",
        "aarch64-apple-darwin",
        "x86_64-pc-windows-msvc",
    }


@pytest.mark.parametrize(
    ("good", "bad"),
    [
        ("permissions: {}", "permissions: write-all"),
        ("contents: read", "contents: write"),
        ("@de0fac2e4500dabe0009e67214ff5f5447ce83dd", "@v6"),
        ("    if: github.event_name == 'push'\n", ""),
        ('test "$TAG"', 'test "${{ github.ref_name }}"'),
        ("timeout-minutes: 30", "continue-on-error: true"),
    ],
)
def test_a_workflow_with_more_rights_is_noticed(good, bad):
    text = WORKFLOW.read_text()
    assert good in text and workflow_faults(text.replace(good, bad))


def test_tools_have_one_version_everywhere():
    rust = CARGO["workspace"]["package"]["rust-version"]
    workflow, docker = WORKFLOW.read_text(), (ROOT / "Dockerfile").read_text()
    assert set(re.findall(r"maturin-version: v(\S+)", workflow)) == {pinned("maturin")}
    assert re.findall(r"maturin==(\S+)", docker) == [pinned("maturin")]
    assert re.findall(r"^FROM rust:([\d.]+)-", docker, re.M) == [rust]
    assert set(re.findall(r"(?:rust-toolchain: \"|toolchain install |cargo \+)([\d.]+)", workflow)) == {rust}
    oldest = PROJECT["project"]["requires-python"].removeprefix(">=")
    assert re.findall(r'python-version: "([\d.]+)"', workflow)[0] == oldest
    assert len(docker.splitlines()) == 10


def packed(path: Path, names, prefix: str) -> Path:
    with tarfile.open(path, "w:gz") as archive:
        for name in names:
            archive.addfile(tarfile.TarInfo(prefix + name), io.BytesIO())
    return path


def test_a_package_with_too_few_files_or_too_many_is_refused(tmp_path):
    version = packages.version()
    sources = [f"{d}/{n}" for d in ("src", "examples") for n in packages.tracked(f"crates/interval-core/{d}")]
    whole = [*sources, "build.rs", "README.md", "LICENSE-APACHE", "LICENSE-MIT", "Cargo.toml"]
    head = f"interval-core-{version}/"
    assert not packages.crate_faults(packed(tmp_path / "a", whole, head))
    assert packages.crate_faults(packed(tmp_path / "b", [*whole[1:], "tests/data.csv"], head)) == [
        f"not in the crate: {whole[0]}",
        "does not belong: tests/data.csv",
    ]
    assert "does not belong: docs/guide.md" in packages.source_faults(
        packed(tmp_path / "c", ["docs/guide.md"], f"ivsid-{version}/")
    )
    wheel = tmp_path / f"ivsid-{version}-cp311-abi3-any.whl"
    names = [f"ivsid/{n}" for n in packages.tracked("python/ivsid")] + ["ivsid/_core.abi3.so"]
    names += [f"ivsid-{version}.dist-info/licenses/{n}" for n in packages.LICENCES]
    with zipfile.ZipFile(wheel, "w") as archive:
        for name in names:
            archive.writestr(name, "")
    assert not packages.wheel_faults(wheel, "")
    with zipfile.ZipFile(wheel, "a") as archive:
        archive.writestr("tests/data.csv", "")
        archive.writestr("ivsid/left_over.py", "")
    assert packages.wheel_faults(wheel, "") == [
        "not of the tree: left_over.py",
        "outside of the package: tests/data.csv",
    ]
