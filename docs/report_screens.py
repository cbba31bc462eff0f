"""Pictures of the first screens of the report pages, by a Chromium without a window: python docs/report_screens.py OUT FOLDER...

Each FOLDER holds a ``report.html``; OUT gets a picture of it on a desk, and of the first one in the dark and on a phone as well. The pictures of
the docs are of two sails of the shipped Otter, whose demands arrive 0.3 s late:

    for s in 1 2; do ivsid simulate otter python/ivsid/data/otter_programme.toml --seed $s --effect thruster.delay=0.3 --out trial$s; done
    ivsid diagnose otter trial1/log.csv trial2/log.csv --out diagnose
    ivsid identify otter trial1/log.csv --out identify
    python docs/report_screens.py docs diagnose identify
"""

from __future__ import annotations

import io
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Final

from PIL import Image

# Colours of a picture: letters stay clear, and a file is a third as large.
# Source: definition: the palette of a PNG
PALETTE: Final = 48
# Width and height of a desk's window and of a phone's [pixels].
# Source: definition: a small laptop and a small phone
DESK: Final = (1320, 780)
PHONE: Final = (390, 800)
BROWSERS: Final = ("chromium", "chromium-browser", "google-chrome")


def picture(page: Path, out: Path, size: tuple[int, int], *options: str) -> None:
    """Writes a picture of the first screen of a page.

    Args:
        page: the report.
        out: the picture.
        size: of the window.
        options: further options of the browser.

    Raises:
        FileNotFoundError: no Chromium is installed.
    """
    browser = next((found for name in BROWSERS if (found := shutil.which(name))), None)
    if browser is None:
        raise FileNotFoundError(f"no browser is installed; install one of {', '.join(BROWSERS)}")
    with tempfile.TemporaryDirectory() as folder:
        shot = Path(folder) / "shot.png"
        fixed = ["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--virtual-time-budget=5000"]
        place = [f"--user-data-dir={folder}/profile", f"--window-size={size[0]},{size[1]}", f"--screenshot={shot}"]
        subprocess.run(
            [browser, *fixed, *place, *options, page.resolve().as_uri()], check=True, capture_output=True, timeout=120
        )
        image = Image.open(io.BytesIO(shot.read_bytes())).convert("RGB")
    image.quantize(PALETTE, dither=Image.Dither.NONE).save(out, optimize=True)


def main(out: Path, folders: list[Path]) -> None:
    """Writes the pictures of all pages into a folder."""
    for k, folder in enumerate(folders):
        page, name = folder / "report.html", f"report_{folder.name}"
        picture(page, out / f"{name}.png", DESK)
        if k == 0:
            picture(page, out / f"{name}_dark.png", DESK, "--blink-settings=preferredColorScheme=0")
            picture(page, out / f"{name}_phone.png", PHONE)


if __name__ == "__main__":
    main(Path(sys.argv[1]), [Path(f) for f in sys.argv[2:]])
