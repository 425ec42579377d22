"""Checks of any report in a browser: widths, colours, print, folds and links; tables, shapes, hostile names."""

import json
import re
import shutil
import time
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from chromium import Browser
from PIL import Image

from gearwhine.output.manifest import MANIFEST

HOSTILE = "</script><script>window.hacked = 1</script><img src=x onerror='window.hacked = 2'>"
LOOKS = [(400, True), (400, False), (1280, True), (1280, False), (3840, True), (3840, False)]
_NAMES = ("name", "title", "driver", "driven", "rotor", "shaft", "sensor", "message")

# Every fold shuts and opens again; every link leads to a place that is then in sight, though all was folded before.
_FOLDS = """
(() => [...document.querySelectorAll("main details")].filter((one) => {
  const before = one.open, summary = one.querySelector(":scope > summary");
  summary.click(); const turned = one.open !== before;
  summary.click(); return !turned || one.open !== before;
}).map((one) => one.id || one.className))()
"""
_LINKS = """
(async () => {
  const lost = [], folds = [...document.querySelectorAll("main details")], seen = new Set();
  const before = folds.map((fold) => fold.open);
  for (const link of document.querySelectorAll("a")) {
    if (seen.has(link.hash)) continue;
    seen.add(link.hash);
    const target = document.getElementById(decodeURIComponent(link.hash.slice(1)));
    for (const fold of folds) fold.open = false;
    link.click();
    await new Promise((done) => setTimeout(done, 0));
    if (!target || !target.checkVisibility()) lost.push(link.hash);
  }
  folds.forEach((fold, place) => { fold.open = before[place]; });
  return [seen.size, lost];
})()
"""
# A click on a heading puts a column in order, a second click turns it: by numbers where all cells begin with one.
_SORTS = """
(() => {
  const wrong = []; let done = 0;
  const value = (text) => parseFloat(text.replace("−", "-").replace(/^\\+/, ""));
  for (const [place, table] of [...document.querySelectorAll("main table")].entries())
    for (const [column, heading] of [...table.tHead.rows[0].cells].entries()) {
      const button = heading.querySelector("button");
      if (!button) continue;
      const cells = () => [...table.tBodies[0].rows].map((row) => row.cells[column].textContent.trim());
      for (const sense of [1, -1]) {
        button.click(); done += 1;
        const values = cells().filter((text) => text !== "–").map(value);
        if (values.some(Number.isNaN)) continue;
        if (values.some((one, row) => row && sense * (one - values[row - 1]) < 0)) wrong.push([place, column, sense]);
      }
    }
  return [done, wrong];
})()
"""


def brightness(browser: Browser, selector: str, what: str = "backgroundColor") -> float:
    """Return the mean of red, green and blue of a computed colour."""
    colour = browser.value(f"getComputedStyle(document.querySelector({selector!r})).{what}")
    return sum(map(float, re.findall(r"[\d.]+", colour)[:3])) / 3.0


def in_sight(browser: Browser) -> np.ndarray[Any, Any]:
    """Return the picture of the viewer of shapes."""
    return np.asarray(Image.open(BytesIO(browser.screenshot("model-viewer"))).convert("RGB")).astype(int)


def moved(browser: Browser, seconds: float = 0.3) -> float:
    """Return the mean difference of two pictures of the viewer."""
    first = in_sight(browser)
    time.sleep(seconds)
    return float(np.abs(in_sight(browser) - first).mean())


def is_clean(browser: Browser) -> None:
    """Hostile names are text, nothing goes wrong, and nothing leaves the page."""
    assert browser.value("typeof window.hacked") == "undefined"
    assert browser.value("document.querySelectorAll('img[onerror]').length") == 0
    assert browser.problems() == []
    assert browser.requests() == []


def look_at(browser: Browser, page: Path, *, interactive: bool) -> None:
    """Hold a page of any size against what all pages do."""
    browser.resize(1280)
    browser.open(page)
    for width, dark in LOOKS:
        browser.resize(width, dark=dark)
        browser.wait_for(f"document.documentElement.scrollWidth === {width}", 10.0)
        assert (brightness(browser, "body") < 60.0) is dark
        assert (brightness(browser, "body", "color") > 180.0) is dark
    browser.resize(1280)
    assert browser.value(_FOLDS) == []
    links, lost = browser.value(_LINKS)
    assert links > 5
    assert lost == []
    if interactive:
        sorts, wrong = browser.value(_SORTS)
        assert sorts > 20
        assert wrong == []
    is_clean(browser)
    browser.resize(1280, dark=True, media="print")
    assert brightness(browser, "body") == 255.0
    printed = browser.printed()
    assert printed.startswith(b"%PDF")
    assert 2 <= len(re.findall(rb"/Type\s*/Page\b(?!s)", printed)) <= 60
    is_clean(browser)
    browser.resize(1280)


def look_at_shapes(browser: Browser) -> None:
    """A shape of the page is loaded, and another one of the list can be chosen.

    That shapes move is seen on one page alone, in ``test_report_in_browser``: without a graphics card the first picture
    takes seconds.
    """
    browser.resize(200, 300)  # small, since it is drawn without a graphics card
    browser.value("document.querySelector('model-viewer').scrollIntoView()")
    browser.wait_for("document.querySelector('model-viewer').loaded")
    told = browser.value("document.querySelector('.told').textContent")
    browser.value("[...document.querySelectorAll('[data-shape]')].find((one) => one.ariaPressed !== 'true').click()")
    browser.wait_for(f"document.querySelector('.told').textContent !== {json.dumps(told)}")
    is_clean(browser)


def with_hostile_names(folder: Path, to: Path) -> None:
    """Copy a results folder, its names in all documents followed by what a page must not run."""

    def named(value: Any, key: str = "") -> Any:
        if isinstance(value, dict):
            return {inner: named(entry, inner) for inner, entry in value.items()}
        if isinstance(value, list):
            return [named(entry, key) for entry in value]
        return f"{value} {HOSTILE}" if isinstance(value, str) and key in _NAMES else value

    shutil.copytree(folder, to)
    (to / MANIFEST).unlink()  # the names are none that a run wrote
    (to / "report.html").unlink(missing_ok=True)
    for summary in to.rglob("summary.json"):
        document = json.loads(summary.read_text(encoding="utf-8"))
        summary.write_text(json.dumps(named(document)), encoding="utf-8")
