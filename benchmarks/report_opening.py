"""How long reports take to open in Chromium without a window and without a graphics card.

Each page is opened several times, each time in a new browser process that has shown a small page before, so that
nothing of the page is compiled yet and the browser itself is up. Times count from the navigation, by the page's clock:

painted
    first contentful paint.
loaded
    end of the ``load`` event; all scripts that run by themselves are set up by then.
usable
    the later of both, or the end of the last task above 50 ms that holds the main thread up within the next three
    seconds.

    python benchmarks/report_opening.py out/report.html out/report-interactive.html
    python benchmarks/report_opening.py --tasks out/report-interactive.html     # and each long task
"""

import statistics
import sys
import tempfile
import time
from pathlib import Path

from timing import machine

sys.path.append(str(Path(__file__).parents[1] / "tests" / "gearwhine"))

from chromium import Browser, find_chromium

TURNS = 5
WATCHED = 3.0  # after the page is loaded [s]
_WATCH = """
window.longTasks = [];
new PerformanceObserver((list) => {
  for (const one of list.getEntries()) window.longTasks.push([one.startTime, one.duration]);
}).observe({ type: "longtask", buffered: true });
"""
_TIMES = """
({
  painted: (performance.getEntriesByName("first-contentful-paint")[0] || {}).startTime,
  loaded: performance.getEntriesByType("navigation")[0].loadEventEnd,
  tasks: window.longTasks,
})
"""
NAMES = ("painted", "loaded", "usable")


def open_once(program: str, page: Path) -> tuple[dict[str, float], list[list[float]]]:
    """Return the times of one opening [s], and start and length of each long task [ms]."""
    with tempfile.TemporaryDirectory() as profile, Browser(program, Path(profile)) as browser:
        browser.resize(1280)
        small = Path(profile) / "small.html"
        small.write_text("<!doctype html><title>small</title><p>A browser that is up.", encoding="utf-8")
        browser.open(small)
        browser.screenshot()
        # The tools would keep a copy of the page, and decode it once more.
        browser.call("Network.disable")
        browser.events.clear()
        browser.call("Page.addScriptToEvaluateOnNewDocument", source=_WATCH)
        # No command is sent meanwhile: it would take its time on the main thread.
        browser.call("Page.navigate", url=page.resolve().as_uri())
        browser.wait_for_event("Page.loadEventFired")
        time.sleep(WATCHED)
        found = browser.value(_TIMES)
    tasks = found["tasks"]
    last = max((start + length for start, length in tasks), default=0.0)
    times = {"painted": found["painted"], "loaded": found["loaded"]}
    times["usable"] = max(*times.values(), last)
    return {name: 1e-3 * value for name, value in times.items()}, tasks


def main() -> None:
    """Print a row for each page: the median, with least and greatest, of each time."""
    program = find_chromium()
    assert program is not None, "no Chromium here"
    told = "--tasks" in sys.argv
    pages = [Path(name) for name in sys.argv[1:] if not name.startswith("--")]
    print(machine())
    print(f"| page | MB | {' | '.join(f'{name}, s' for name in NAMES)} |")
    print(f"|---|---|{'---|' * len(NAMES)}")
    for page in pages:
        turns = [open_once(program, page) for _ in range(TURNS)]
        cells = []
        for name in NAMES:
            values = [times[name] for times, _ in turns]
            cells.append(f"{statistics.median(values):.2f} ({min(values):.2f} to {max(values):.2f})")
        print(f"| {page.parent.name}/{page.name} | {page.stat().st_size / 1e6:.2f} | {' | '.join(cells)} |", flush=True)
        for _, tasks in turns if told else ():
            print("    " + ", ".join(f"{start:.0f}+{length:.0f}" for start, length in tasks))


if __name__ == "__main__":
    main()
