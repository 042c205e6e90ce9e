"""How many pictures a second `kinsim lab` shows in a real Chromium, and, if asked for, the picture of the page.

A picture counts when the browser says that it has painted it; f, h, u and the cut are drawn anew for each. The numbers
come to docs/how-to/lab.md by ``python .ci/tables.py out docs/how-to/lab.md``.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from playwright.sync_api import Page, sync_playwright

from kinsim.lab.setup import Setup

CELLS, NODES = 320, 128

WINDOWS = ((1400, 900), (1600, 1160))
"""Of the browser, in pixels: one of a laptop, and one in which the picture of the page is taken."""

STEPS = 60
"""After so many the silo has broken, and still moves."""

LONG = 120_000
"""Milliseconds, for kernels that compile."""

FRAMES = """() => {
  const found = Bokeh.documents.flatMap(doc => [...doc._all_models.values()]).find(model => model.name == "painted")
  return [found.data.frames[0], performance.now()]
}"""


def main() -> None:
    """Measure, and print a line."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--seconds", type=float, default=20.0, help="so long it plays")
    options.add_argument("--picture", type=Path, help="where the picture of the page goes, .png")
    options.add_argument("--out", type=Path, default=Path("out/lab.json"), help="where the table goes")
    asked = options.parse_args()
    setup = Setup.of_scene("silo-incline").turned("cells.count", CELLS).turned("method.velocity.count", NODES)
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "silo-incline.toml"
        scene.write_text(setup.turned("clock.number", 0.2).toml(), encoding="utf-8")
        words = [sys.executable, "-m", "kinsim", "lab", str(scene), "--no-browser"]
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as running:
            assert running.stdout
            found = re.search(r"http://\S+", running.stdout.readline())
            assert found
            try:
                measured = [measure(found[0], asked.seconds, window, asked.picture) for window in WINDOWS]
            finally:
                running.terminate()
    rows = []
    for (wide, high), (rate, browser) in zip(WINDOWS, measured, strict=True):
        print(f"kinsim lab: {rate:.1f} pictures a second at {CELLS} x {NODES}, {wide} x {high} pixels, {browser}")
        machine = f"{os.cpu_count()} cores, {platform.machine()}"
        rows.append([f"{CELLS} x {NODES}", f"{wide} x {high}", f"{rate:.1f}", machine, browser])
    caption = f"Pictures that the browser painted, counted for {asked.seconds:g} s"
    heads = ["cells x nodes", "window", "pictures a second", "machine", "browser"]
    asked.out.parent.mkdir(parents=True, exist_ok=True)
    asked.out.write_text(json.dumps({"tables": [{"caption": caption, "heads": heads, "rows": rows}]}), encoding="utf-8")


def measure(address: str, seconds: float, window: tuple[int, int], picture: Path | None) -> tuple[float, str]:
    """Play for so many seconds; the rate and the browser."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": window[0], "height": window[1]})
        page.goto(address)
        page.locator(".now").wait_for(timeout=LONG)
        play = page.locator(".play button")
        play.click()
        page.wait_for_timeout(1000)
        (first, begun), _ = page.evaluate(FRAMES), page.wait_for_timeout(1e3 * seconds)
        last, ended = page.evaluate(FRAMES)
        play.click()
        rate = 1e3 * (last - first) / (ended - begun)
        if picture:
            show(page)
            page.wait_for_timeout(1500)
            page.screenshot(path=picture)
        name = f"headless Chromium {browser.version.partition('.')[0]}, drawn without a GPU"
        browser.close()
    return rate, name


def show(page: Page) -> None:
    """A moment that tells much: a stage in between, the face of a steep place, the misprint."""
    over: Any = page.locator(".over button")
    over.click()
    page.wait_for_timeout(1500)
    play = page.locator(".play button")
    play.click()
    while int(page.locator(".now b").nth(1).inner_text()) < STEPS:
        page.wait_for_timeout(100)
    play.click()
    page.locator(".printed input").check()
    chart = page.locator(".chart").first.bounding_box()
    assert chart
    page.mouse.click(chart["x"] + 0.595 * chart["width"], chart["y"] + 0.5 * chart["height"])
    page.locator("h1").click()  # no frame of focus in the picture


if __name__ == "__main__":
    main()
