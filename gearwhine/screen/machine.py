"""The main job on the terminal: housing and comparison, and what is declared of the run."""

from typing import Any

from gearwhine.output.terminal import open_console, show
from gearwhine.results.run import sections
from gearwhine.screen.housing import comparison_table, modes_line


def show_run(document: dict[str, Any]) -> None:
    """The main job's outcome."""
    console = open_console()
    console.print(document["title"], style="bold")
    if "housing" in document:
        modes_line(console, document["housing"])
    if "compare" in document:
        comparison_table(console, document["compare"])
    rest = {key: value for key, value in document.items() if key not in ("title", "reused")}
    show(rest, sections(document), timed=True)
