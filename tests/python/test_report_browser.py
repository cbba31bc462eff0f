"""The report page in a browser without a window: zoom, cursor, links, file, themes, phone and paper; nothing is loaded and nothing fails."""

import json
import re
import shutil
import subprocess

import numpy as np
import pytest

from ivsid import workflow
from ivsid.report import page
from ivsid.report.page import Report
from test_report_page import report

BROWSER = next((p for n in ("chromium", "chromium-browser", "google-chrome") if (p := shutil.which(n))), None)
pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed: apt-get install chromium")

# Errors are collected from the first line on.
WATCH = """<script>
window.seen = { errors: [] };
addEventListener("error", (e) => seen.errors.push(e.message));
addEventListener("securitypolicyviolation", (e) => seen.errors.push(`refused ${e.blockedURI}`));
for (const level of ["error", "warn"]) console[level] = (...words) => seen.errors.push(words.join(" "));
</script>"""
# What a reader does, and what is seen after each step.
READER = """<script>
const figure = document.querySelector("figure.series"), over = figure.querySelector(".u-over"), box = figure.querySelector(".panel");
const view = () => [Number(figure.dataset.start), Number(figure.dataset.end)];
const rest = () => new Promise((done) => setTimeout(done, 60));
const at = (type, x, more) => new MouseEvent(type, { bubbles: true, clientX: over.getBoundingClientRect().left + x, clientY: over.getBoundingClientRect().top + 20, ...more });
const inks = () => { const c = figure.querySelector("canvas"); const d = c.getContext("2d").getImageData(0, 0, c.width, c.height).data; let dark = 0, lit = 0;
  for (let i = 0; i < d.length; i += 4) { if (d[i + 3] > 200) { const sum = d[i] + d[i + 1] + d[i + 2]; dark += sum < 120; lit += sum > 690; } } return { dark, lit }; };
const width = over.clientWidth;
(async () => {
  await rest();
  seen.plots = document.querySelectorAll(".uplot").length;
  seen.wide = document.documentElement.scrollWidth - innerWidth;
  seen.first = inks();
  over.dispatchEvent(new WheelEvent("wheel", { deltaY: -100, clientX: over.getBoundingClientRect().left + width / 2, cancelable: true }));
  seen.passed = view();
  box.focus();
  over.dispatchEvent(new WheelEvent("wheel", { deltaY: -100, clientX: over.getBoundingClientRect().left + width / 2, cancelable: true }));
  seen.wheel = view();
  box.dispatchEvent(new KeyboardEvent("keydown", { key: "0" }));
  seen.whole = view();
  over.dispatchEvent(at("mousemove", width * 0.25));
  over.dispatchEvent(at("mousedown", width * 0.25, { button: 0 }));
  for (const share of [0.3, 0.4, 0.5]) { document.dispatchEvent(at("mousemove", width * share, { movementX: 9 })); over.dispatchEvent(at("mousemove", width * share, { movementX: 9 })); await rest(); }
  document.dispatchEvent(at("mouseup", width * 0.5, { button: 0 }));
  await rest();
  seen.drag = view();
  document.querySelector("p.jump button").click();
  seen.jump = view();
  box.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true }));
  await rest();
  const told = () => [...figure.querySelectorAll(".u-legend .u-value")].map((v) => v.textContent);
  seen.cursor = told();
  box.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true }));
  await rest();
  seen.next = told();
  let blob = null;
  URL.createObjectURL = (b) => { blob = b; return "#"; };
  figure.querySelector("[data-do=csv]").click();
  seen.csv = await blob.text();
  document.getElementById("theme").click();
  await rest();
  seen.theme = document.documentElement.dataset.theme;
  seen.second = inks();
  seen.closed = document.querySelectorAll("details:not([open])").length;
  dispatchEvent(new Event("beforeprint"));
  seen.paper = [document.querySelectorAll("details:not([open])").length, document.documentElement.dataset.theme];
  dispatchEvent(new Event("afterprint"));
  seen.after = [document.querySelectorAll("details:not([open])").length, document.documentElement.dataset.theme];
  seen.loaded = performance.getEntriesByType("resource").map((e) => e.name);
  const found = document.createElement("pre");
  found.id = "found";
  found.textContent = JSON.stringify(seen);
  document.body.append(found);
})();
</script>"""


# A reader of curves: zooms the first figure to its middle, and saves what is in view of each figure.
CURVES = """<script>
(async () => {
  const rest = () => new Promise((done) => setTimeout(done, 60));
  await rest();
  seen.plots = document.querySelectorAll(".uplot").length;
  seen.wide = document.documentElement.scrollWidth - innerWidth;
  seen.saved = [];
  let blob = null;
  URL.createObjectURL = (b) => { blob = b; return "#"; };
  document.querySelector("figure.series [data-do=in]").click();
  await rest();
  for (const button of document.querySelectorAll("figure.series [data-do=csv]")) { button.click(); seen.saved.push(await blob.text()); }
  seen.loaded = performance.getEntriesByType("resource").map((e) => e.name);
  const found = document.createElement("pre");
  found.id = "found";
  found.textContent = JSON.stringify(seen);
  document.body.append(found);
})();
</script>"""


def read(folder, width, height, made: Report, reader=READER):
    """What a reader sees on a screen of a size."""
    html = page.html(made).replace("<title>", f"{WATCH}<title>", 1).replace("</body>", f"{reader}</body>")
    (folder / "page.html").write_text(html)
    found, complaint = None, ""
    # A blob is read in real time, which the browser's virtual clock does not wait for on a busy machine: the page is opened again, with more of it.
    for budget in (8000, 30000, 120000):
        command = [
            BROWSER,
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--hide-scrollbars",
            f"--user-data-dir={folder}/profile-{budget}",
            f"--window-size={width},{height}",
            f"--virtual-time-budget={budget}",
            "--dump-dom",
            f"file://{folder}/page.html",
        ]
        done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
        found = re.search(r'<pre id="found">(.*?)</pre>', done.stdout, re.S)
        if found:
            break
        complaint = done.stderr[-2000:]
    assert found, complaint
    from html import unescape

    return json.loads(unescape(found[1]))


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    return read(tmp_path_factory.mktemp("desk"), 1280, 900, report())


def test_nothing_fails_and_nothing_is_loaded(seen):
    assert seen["errors"] == [] and seen["loaded"] == [] and seen["plots"] == 2


def test_wheel_drag_keys_and_links_zoom_all_panels(seen):
    # A page that is scrolled past a figure does not zoom it.
    assert seen["passed"] == seen["whole"] == pytest.approx([0.0, 39.9])
    low, high = seen["wheel"]
    assert high - low == pytest.approx(39.9 / 1.6, rel=1e-3) and 0 < low < high < 39.9
    assert seen["drag"] == pytest.approx([0.25 * 39.9, 0.5 * 39.9], abs=0.5)
    assert seen["jump"] == pytest.approx([1.0, 2.0])


def test_the_keys_move_one_cursor_over_all_panels(seen):
    first, later = ([float(x) for x in seen[k] if x not in ("–", "--")] for k in ("cursor", "next"))
    assert len(first) == len(later) == 6
    # Time of both panels, and the measured value there.
    assert first[0] == first[3] and later[0] == later[3] == pytest.approx(first[0] + 0.1, abs=0.011)
    assert later[1] == pytest.approx(np.sin(later[0]), abs=2e-3)


def test_what_is_visible_is_saved(seen):
    header, *rows = seen["csv"].strip().splitlines()
    assert header.startswith('time [s],"surge velocity u [m/s]: measured"') and header.count(",") == 4
    times = [float(r.split(",")[0]) for r in rows]
    assert times == pytest.approx(np.linspace(1.0, 2.0, 11).tolist())
    # Every fiftieth sample after the seventh is missing, none of them here.
    assert [float(r.split(",")[1]) for r in rows] == pytest.approx(np.sin(times).tolist(), abs=1e-6)


def test_figures_follow_the_theme_and_paper_is_light_and_open(seen):
    assert seen["theme"] == "dark" and seen["closed"] > 0
    assert seen["first"]["dark"] > seen["first"]["lit"] and seen["second"]["lit"] > seen["second"]["dark"]
    assert seen["paper"] == [0, "light"] and seen["after"] == [seen["closed"], "dark"]


def test_nothing_is_wider_than_a_phone(tmp_path):
    seen = read(tmp_path, 360, 740, report("drag.surge.quadratic beside thruster.voltage_sag"))
    assert seen["errors"] == [] and seen["wide"] <= 0


def test_curves_zoom_and_are_saved_as_they_were_measured(tmp_path):
    """Logarithms are drawn; the file holds averaging times and deviations."""
    rng = np.random.default_rng(0)
    rows = "\n".join(f"{0.05 * k:.2f},{x:.9f}" for k, x in enumerate(1e-3 * rng.standard_normal(1000)))
    (tmp_path / "still.csv").write_text(f"t,ax\n{rows}\n")
    seen = read(tmp_path, 390, 800, workflow.allan(tmp_path / "still.csv"), CURVES)
    assert seen["errors"] == [] and seen["loaded"] == [] and seen["plots"] == 2 and seen["wide"] <= 0
    curve = [row.split(",") for row in seen["saved"][0].strip().splitlines()]
    assert curve[0][0] == "averaging time [s]" and curve[0][1] == '"ax [m/s^2]: deviation"'
    taus, deviations = (np.array([float(row[k]) for row in curve[1:]]) for k in (0, 1))
    # White noise falls with the root of the averaging time; the zoom left the ends out.
    assert 0.05 < taus[0] < taus[-1] < 15.0
    short = taus < 1.0
    np.testing.assert_allclose((deviations * np.sqrt(taus))[short], 1e-3 * np.sqrt(0.05), rtol=0.25)
    assert len(seen["saved"][1].strip().splitlines()) == 1001
    demand = np.linspace(-100, 100, 21)
    rows = "\n".join(f"{d},{0.004 * d * abs(d)}" for d in demand)
    (tmp_path / "pull.csv").write_text(f"demand [%],thrust [N]\n{rows}\n")
    seen = read(tmp_path, 1280, 900, workflow.thrust(tmp_path / "pull.csv"), CURVES)
    assert seen["errors"] == [] and seen["loaded"] == [] and seen["plots"] == 2
    head, *rows = (row.split(",") for row in seen["saved"][0].strip().splitlines())
    assert head[:2] == ["demand [%]", '"thrust [N]: table"']
    points = [(float(r[0]), float(r[1])) for r in rows if r[1]]
    np.testing.assert_allclose([t for _, t in points], [0.004 * d * abs(d) for d, _ in points], atol=1e-4)
    assert 5 < len(points) < 21
