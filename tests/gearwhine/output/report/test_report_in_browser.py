"""The report in Chromium: widths, colours, print, folds, links; sorting, curves and shapes of the interactive form."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from chromium import Browser, find_chromium
from looked_at import HOSTILE, brightness, in_sight, look_at, moved
from PIL import Image

from gearwhine.case import load_case
from gearwhine.housing.pictures.drawn_shapes import DrawnHousing, DrawnShape
from gearwhine.housing.pictures.gltf import light_model
from gearwhine.output.report import Contents, MovingShape, report_page
from gearwhine.results import chapters_of
from gearwhine.results.first_page import first_page

PROGRAM = find_chromium()
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(PROGRAM is None, reason="no Chromium here; on Debian or Ubuntu: sudo apt-get install chromium"),
]
MODES = [
    {"number": 1, "frequency_hz": 900.0, "damping_ratio": 0.01, "strength": 2e-3},
    {"number": 2, "frequency_hz": 1007.3, "damping_ratio": 0.02, "strength": 1.5e-2},
    {"number": 3, "frequency_hz": 2500.0, "damping_ratio": 0.005, "strength": 3e-4},
]
LINE = {
    "frequency_hz": 1000.0,
    "amplitude_m_per_s2": 1.5,
    "name": HOSTILE,
    "kind": "mesh",
    "level_db": 120.0,
    "near_mode": None,
    "contributions": {
        "housing_modes": [{"name": "housing mode 2 (1007 Hz)", "amplitude_m_per_s2": 3.0, "share": 1.5, "number": 2}],
        "bearings": [{"name": "front", "amplitude_m_per_s2": 2.0, "share": 1.4}],
        "free_vibration": {"name": "free vibration", "amplitude_m_per_s2": 0.0, "share": 0.0},
    },
}
DOCUMENT = {
    "command": "run",
    "title": f"Gearbox {HOSTILE}",
    "made_at": "2026-01-01T10:00:00+00:00",
    "warnings": [{"name": "runout", "message": HOSTILE}],
    "housing": {
        "modes": MODES,
        "certificate": {"found": 3, "limit_hz": 3200.0, "expected": 3, "complete": True, "max_residual": 2e-12},
        "mesh": {"elements": 10, "dofs": 300},
        "mass_kg": 12.5,
    },
    "steps": 1000,
    "speed_rpm": 5500.0,
    "coordinates": 50,
    "energy_error": 1e-6,
    "sensors": [{"name": HOSTILE, "peaks": [LINE]}],
    "sound": {
        "method": "boundary-elements",
        "highest_frequency_hz": 3000.0,
        "surface": {"triangles": 500, "area_m2": 0.2, "caps_m2": 0.01},
        "lines": [
            {
                "frequency_hz": 1000.0,
                "order": 10.9,
                "name": HOSTILE,
                "sound_power_db": 70.0,
                "sound_power_db_a": 70.0,
                "equivalent_power_db": 71.0,
                "surface_power_db": 70.1,
                "radiation_efficiency": 0.8,
                "contributions": {
                    "housing_modes": [{"name": "housing mode 2", "share": 0.9}],
                    "bearings": [{"name": HOSTILE, "share": 1.4}],
                    "faces": [{"name": "top", "share": 0.7}],
                },
            }
        ],
        "covered": 0.99,
        "total_db": 70.0,
        "total_db_a": 70.0,
        "faces_w": {"top": 1e-5},
        "modes": [],
        "microphones": [],
        "left_out": [],
        "known_source_error": None,
        "known_source_rms": None,
        "box_power_db": None,
    },
}
FREQUENCY = np.arange(0.0, 3000.0, 2.0)


def surface() -> DrawnHousing:
    """Return a plate of 20 by 20 points."""
    y, x = np.mgrid[0:1:20j, 0:1:20j]
    first = (20 * np.arange(19)[:, None] + np.arange(19)).ravel()
    triangles = np.concatenate(
        [np.stack([first, first + 1, first + 20], axis=1), np.stack([first + 1, first + 21, first + 20], axis=1)]
    )
    return DrawnHousing(np.stack([x.ravel(), y.ravel(), 0.0 * x.ravel()], axis=1), triangles, np.arange(400))


def shapes() -> list[MovingShape]:
    plate = surface()
    bending = np.zeros((400, 3))
    bending[:, 2] = np.sin(np.pi * plate.rest[:, 0]) * np.sin(np.pi * plate.rest[:, 1])
    waves = np.zeros((400, 3), dtype=complex)
    waves[:, 2] = np.exp(2j * np.pi * plate.rest[:, 0])
    found = [
        DrawnShape("line-1000.0Hz", f"Operating shape {HOSTILE}", HOSTILE, waves),
        DrawnShape("mode-02-1007Hz", "Mode 2   1007 Hz", "", bending),
    ]
    return [MovingShape(one.name, one.title, one.note, light_model(plate, one, 500)) for one in found]


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Write both forms of the report of a small folder."""
    folder = tmp_path_factory.mktemp("results")
    (folder / "summary.json").write_text(json.dumps(DOCUMENT), encoding="utf-8")
    (folder / "case.toml").write_text(f'title = "x"\nnotes = """{HOSTILE}"""\n', encoding="utf-8")
    y, x = np.mgrid[0:300, 0:500]
    for name in ("spectrum", "mesh-force", "mode-02-1007Hz", "sound-faces-1000.0Hz", "own"):
        pixels = np.stack([255 - x // 4, 255 - y // 3, 200 + 0 * x], axis=-1).astype(np.uint8)
        Image.fromarray(pixels).save(folder / f"{name}.png")
    speeds = np.arange(1000.0, 3000.0, 100.0)
    ridge = 1e-3 + np.exp(-(((FREQUENCY - speeds[:, None] / 2.0) / 50.0) ** 2))
    xr.Dataset(
        {
            "sensor_spectrum": (
                ("sensor", "frequency"),
                1e-3 + np.exp(-(((FREQUENCY - 1000.0) / 20.0) ** 2))[None, :],
                {"units": "m/s2", "long_name": "peak amplitude of acceleration", "trusted_below_hz": 2000.0},
            ),
            "run_spectrum": (("run_signal", "run_speed", "run_frequency"), ridge[None], {"units": ""}),
        },
        {
            "sensor": [HOSTILE],
            "frequency": ("frequency", FREQUENCY, {"units": "Hz"}),
            "run_signal": ["top"],
            "run_speed": ("run_speed", speeds, {"units": "rpm"}),
            "run_frequency": ("run_frequency", FREQUENCY, {"units": "Hz"}),
        },
    ).to_netcdf(folder / "results.nc", engine="h5netcdf")
    case = load_case("spur-pair", []).case
    contents = Contents(chapters_of, first_page)
    found = {}
    for form, moving in (("static", None), ("interactive", shapes())):
        found[form] = folder / f"{form}.html"
        found[form].write_text(report_page(folder, contents, case, shapes=moving), encoding="utf-8")
    return found


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    assert PROGRAM is not None
    with Browser(PROGRAM, tmp_path_factory.mktemp("profile")) as opened:
        yield opened


@pytest.mark.parametrize("form", ["static", "interactive"])
@pytest.mark.parametrize(("width", "dark"), [(400, True), (1280, False), (3840, True)])
def test_a_page_fits_each_width_in_both_colours(
    browser: Browser, pages: dict[str, Path], form: str, width: int, dark: bool
) -> None:
    browser.resize(width, dark=dark)
    browser.open(pages[form])
    assert browser.value("document.documentElement.scrollWidth") == width
    assert (brightness(browser, "body") < 60.0) is dark
    assert (brightness(browser, "body", "color") > 180.0) is dark
    assert brightness(browser, "figure img") == 255.0
    side = browser.value("getComputedStyle(document.querySelector('.side')).display !== 'none'")
    folded = browser.value("getComputedStyle(document.querySelector('.contents')).display !== 'none'")
    assert (side, folded) == ((True, False) if width > 1000 else (False, True))
    assert not browser.value("document.querySelector('.contents details').open")
    # Hostile names stay text, nothing goes wrong, and nothing leaves the page.
    assert browser.value("typeof window.hacked") == "undefined"
    assert browser.value("document.querySelectorAll('img[onerror]').length") == 0
    assert browser.value("document.querySelector('h1').textContent") == f"Gearbox {HOSTILE}"
    assert browser.problems() == []
    assert browser.requests() == []


@pytest.mark.parametrize("form", ["static", "interactive"])
def test_a_page_does_what_every_page_does(browser: Browser, pages: dict[str, Path], form: str) -> None:
    look_at(browser, pages[form], interactive=form == "interactive")


def test_the_policy_of_the_page_stops_a_script_and_a_request(browser: Browser, pages: dict[str, Path]) -> None:
    # What the assertions above rely on: both are noticed.
    page = pages["static"].read_text(encoding="utf-8")
    spoilt = pages["static"].parent / "spoilt.html"
    spoilt.write_text(page.replace("</main>", "<script>1</script></main>"), encoding="utf-8")
    browser.open(spoilt)
    assert any("Content Security Policy" in problem for problem in browser.problems())


def test_chapters_fold_and_a_link_opens_them(browser: Browser, pages: dict[str, Path]) -> None:
    browser.resize(1280)
    browser.open(pages["static"])
    table = "document.querySelector('#run-section-housing-modes table')"
    assert browser.value(f"{table}.checkVisibility()")
    browser.value("document.querySelector('#run-section-housing-modes > summary').click()")
    assert not browser.value(f"{table}.checkVisibility()")
    browser.value("document.querySelector('a[href=\"#run-picture-mode-02-1007hz\"]').click()")
    browser.wait_for(f"{table}.checkVisibility()")
    place = browser.value("document.querySelector('#run-picture-mode-02-1007hz').getBoundingClientRect().top")
    assert -50.0 < place < 900.0


def test_the_loudest_line_leads_to_where_it_radiates(browser: Browser, pages: dict[str, Path]) -> None:
    browser.open(pages["static"])
    link = "document.querySelector('#summary-section-loudest-lines a[href=\"#run-picture-sound-faces-1000-0hz\"]')"
    assert browser.value(f"{link}.textContent") == "1000.0"
    assert browser.value("document.querySelector('#run-picture-sound-faces-1000-0hz img').naturalWidth") > 0
    assert "70.0 dB re 1 pW" in browser.value("document.querySelector('#summary-section-loudest-lines p').textContent")


def test_a_printed_page_is_light_and_has_no_contents(browser: Browser, pages: dict[str, Path]) -> None:
    browser.resize(1280, dark=True, media="print")
    browser.open(pages["interactive"])
    assert brightness(browser, "body") == 255.0
    for hidden in (".side", ".contents", "button.copy", ".viewer"):
        assert browser.value(f"getComputedStyle(document.querySelector('{hidden}')).display") == "none"
    printed = browser.printed()
    assert printed.startswith(b"%PDF")
    assert 2 <= len(re.findall(rb"/Type\s*/Page\b(?!s)", printed)) <= 12
    browser.resize(1280)


def column(browser: Browser, number: int) -> list[str]:
    rows = "document.querySelector('#run-section-housing-modes table').tBodies[0].rows"
    return list(browser.value(f"[...{rows}].map((row) => row.cells[{number}].textContent)"))


def test_a_click_on_a_heading_sorts_and_another_turns_the_order(browser: Browser, pages: dict[str, Path]) -> None:
    browser.open(pages["interactive"])
    heading = "document.querySelector('#run-section-housing-modes table').tHead.rows[0].cells[3]"
    assert column(browser, 0) == ["1", "2", "3"]
    for order, expected in (("ascending", ["3", "1", "2"]), ("descending", ["2", "1", "3"])):
        browser.value(f"{heading}.querySelector('button').click()")
        assert browser.value(f"{heading}.getAttribute('aria-sort')") == order
        assert column(browser, 0) == expected
    # By their numbers, not by their letters: 900 comes before 1007.3.
    browser.value("document.querySelectorAll('#run-section-housing-modes th button')[1].click()")
    assert column(browser, 1) == ["900.00", "1007.30", "2500.00"]
    assert browser.value(f"{heading}.getAttribute('aria-sort')") is None


def test_a_table_is_copied_with_tabs(browser: Browser, pages: dict[str, Path]) -> None:
    browser.open(pages["interactive"])
    browser.value(
        "Object.defineProperty(navigator, 'clipboard', {value: {writeText: async (text) => { window.copied = text; }}})"
    )
    browser.value("document.querySelector('#run-section-housing-modes button.copy').click()")
    rows = [line.split("\t") for line in browser.value("window.copied").splitlines()]
    assert rows[0] == ["mode", "frequency [Hz]", "damping ratio", "strength [1/kg]"]
    assert rows[2] == ["2", "1007.30", "0.0200", "0.015"]


# A page that draws all the time has no idle time, hence the limit.
SETTLED = """
new Promise((done) => requestIdleCallback(() => requestIdleCallback(done, { timeout: 500 }), { timeout: 500 }))
"""
RUNNING = "[typeof window.Plotly !== 'undefined', customElements.get('model-viewer') !== undefined]"
UNPACKED = """
(() => { const counts = { count: 0 }, real = window.DecompressionStream;
  window.DecompressionStream = function (kind) { counts.count += 1; return new real(kind); };
  window.unpacked = counts; })()
"""


def test_a_library_runs_when_something_needs_it_and_not_before(browser: Browser, pages: dict[str, Path]) -> None:
    """What opens with the page is its own script alone, which is small; the rest is packed and inert."""
    browser.resize(1280, 500)
    browser.open(pages["interactive"])
    scripts = browser.value("[...document.scripts].map((one) => [one.type, one.textContent.length])")
    assert sum(length for kind, length in scripts if kind == "") < 20_000
    assert sorted({kind for kind, _ in scripts}) == ["", "application/gzip"]
    assert sum(kind == "application/gzip" for kind, _ in scripts) == 2 + 2 + 2  # libraries, models and drawings
    for place in ("model-viewer", ".plot"):
        top = browser.value(f"document.querySelector('{place}').getBoundingClientRect().top")
        assert top > 500 + 300, f"{place} is in sight from the start"
    browser.value(SETTLED)
    assert browser.value(RUNNING) == [False, False]
    browser.value("document.querySelector('.plot').scrollIntoView()")
    browser.wait_for("document.querySelector('.plot .scatterlayer path')")
    assert browser.value(RUNNING) == [True, False]  # the viewer is in a test of its own
    assert browser.problems() == []
    assert browser.requests() == []


def test_shapes_move_pause_and_are_chosen_and_each_is_unpacked_once(browser: Browser, pages: dict[str, Path]) -> None:
    """All of it on one page: to compile the shaders of a viewer takes longer than the rest."""
    told = "document.querySelector('.told').textContent"
    chosen = "document.querySelectorAll('[data-shape]')"

    def shown(number: int, unpacked: int) -> None:
        """The shape is chosen and loaded, and the page has unpacked this many parts."""
        browser.wait_for(f"document.querySelector('model-viewer').loaded && {chosen}[{number}].ariaPressed === 'true'")
        browser.value(SETTLED)
        assert browser.value("window.unpacked.count") == unpacked

    browser.resize(200, 300)  # small, since it is drawn without a graphics card
    script = browser.call("Page.addScriptToEvaluateOnNewDocument", source=UNPACKED)["identifier"]
    try:
        browser.open(pages["interactive"])
        browser.wait_for("window.unpacked.count === 3")  # for paper: the library of curves and two drawings
        assert not browser.value(RUNNING)[1]
        browser.value("document.querySelector('model-viewer').scrollIntoView()")
        shown(0, 5)  # the viewer and a model
        assert browser.value(RUNNING)[1]
        browser.wait_for("!document.querySelector('model-viewer').paused")
        assert browser.value(told).startswith(f"Operating shape {HOSTILE}")
        in_sight(browser)  # the first picture waits for the shaders, which a busy processor compiles for long
        assert any(moved(browser) > 0.0 for _ in range(20)), "the shape stands still"
        browser.value("document.querySelector('.pause').click()")
        assert any(moved(browser) == 0.0 for _ in range(20)), "the shape moves on"
        # The button at the picture of a mode, a link to a shape that has no picture, and the list of shapes.
        browser.value("document.querySelector('figure[data-picture=mode-02-1007Hz] .move').click()")
        browser.wait_for(f"{told} === 'Mode 2   1007 Hz'")
        shown(1, 6)  # another model
        browser.value("document.querySelector('a[href=\"#shapes-picture-line-1000-0hz\"]').click()")
        browser.wait_for(f"{told}.startsWith('Operating shape')")
        shown(0, 6)  # nothing more
        browser.value(f"{chosen}[1].click()")
        browser.wait_for(f"{told} === 'Mode 2   1007 Hz'")
        shown(1, 6)
    finally:
        browser.call("Page.removeScriptToEvaluateOnNewDocument", identifier=script)
    assert browser.problems() == []
    assert browser.requests() == []


def test_paper_shows_all_curves_and_no_empty_frame(browser: Browser, pages: dict[str, Path]) -> None:
    browser.resize(1280, 500)
    script = browser.call("Page.addScriptToEvaluateOnNewDocument", source=UNPACKED)["identifier"]
    try:
        browser.open(pages["interactive"])
        browser.wait_for("window.unpacked.count === 3")
        browser.value(SETTLED)
    finally:
        browser.call("Page.removeScriptToEvaluateOnNewDocument", identifier=script)
    drawn = "document.querySelectorAll('.live.drawn .plot .main-svg').length > 0"
    frames = "[...document.querySelectorAll('.live')].map((one) => getComputedStyle(one).display)"
    assert not browser.value(drawn)
    browser.resize(1280, 500, media="print")
    assert browser.value(frames) == ["none", "none"]
    browser.printed()
    assert browser.value(drawn)
    assert browser.value(frames) == ["block", "block"]
    assert browser.value("document.querySelectorAll('.plot .scatterlayer path').length") > 0
    browser.resize(1280)
    assert browser.problems() == []


def test_curves_are_drawn_and_zoom(browser: Browser, pages: dict[str, Path]) -> None:
    browser.resize(1280, 900)
    browser.open(pages["interactive"])
    assert browser.value("document.querySelectorAll('.plot').length") == 2
    browser.value("document.querySelector('.plot').scrollIntoView({block: 'start'})")
    browser.wait_for("document.querySelector('.plot .scatterlayer path')")
    browser.wait_for("document.querySelectorAll('.plot .heatmaplayer image').length === 1")
    # The name of the axis has its unit on one line, and stands clear of the numbers.
    title = browser.value("document.querySelector('.plot').layout.yaxis.title.text")
    assert title == "peak amplitude of acceleration<br>[m/s²]"
    right, left = browser.value(
        "(() => { const plot = document.querySelector('.plot'), box = (one) => one.getBoundingClientRect();"
        " const numbers = [...plot.querySelectorAll('.ytick text')].map((one) => box(one).left);"
        " return [box(plot.querySelector('.ytitle')).right, Math.min(...numbers)]; })()"
    )
    assert right <= left + 1.0
    # No button sends the data away.
    titles = browser.value("[...document.querySelectorAll('.modebar-btn')].map((one) => one.dataset.title)")
    assert "Zoom" in titles
    assert not [title for title in titles if re.search("share|cloud|edit|link", title, re.IGNORECASE)]
    reach = "document.querySelector('.plot').layout.xaxis.range"
    assert browser.value(reach)[1] == pytest.approx(2000.0)  # the model is complete up to there
    box = browser.value(
        "(() => { const r = document.querySelector('.plot .nsewdrag').getBoundingClientRect();"
        " return [r.x, r.y, r.width, r.height]; })()"
    )
    x, y, width, height = box
    for kind, along in (("mousePressed", 0.4), ("mouseMoved", 0.5), ("mouseMoved", 0.6), ("mouseReleased", 0.6)):
        browser.call(
            "Input.dispatchMouseEvent",
            type=kind,
            x=x + along * width,
            y=y + 0.5 * height,
            button="left",
            buttons=1,
            clickCount=1,
        )
    browser.wait_for(f"{reach}[0] > 100")
    assert browser.value(reach) == pytest.approx([800.0, 1200.0], rel=0.05)
    assert browser.value("document.querySelector('.plot').data[0].name").startswith("&lt;/script&gt;")
    assert browser.value("typeof window.hacked") == "undefined"
    assert browser.problems() == []
