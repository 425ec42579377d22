"""Shared by all tests: the record of published values beside ours."""

from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

import pytest

Published = Callable[..., None]

_KEY = "published value"


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--validation-table",
        metavar="FILE",
        help="write the published values that the tests met, beside ours, to a Markdown file",
    )


@pytest.fixture
def published(record_property: Callable[[str, object], None]) -> Published:
    """Compare our value with a published one, and keep the row for the validation table.

    ``published(source, quantity, value, ours, unit, rel=...)`` or ``abs=...`` fails where they differ by more.
    """

    def compare(
        source: str,
        quantity: str,
        value: float,
        ours: float,
        unit: str = "",
        *,
        rel: float | None = None,
        abs: float | None = None,  # noqa: A002 - as in pytest.approx
    ) -> None:
        record_property(_KEY, [source, quantity, float(value), float(ours), unit])
        assert ours == pytest.approx(value, rel=rel, abs=abs), f"{source}: {quantity}"

    return compare


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    target = terminalreporter.config.getoption("--validation-table")
    if not target:
        return
    rows: dict[str, list[list[object]]] = defaultdict(list)
    for report in terminalreporter.stats.get("passed", []):
        for key, row in report.user_properties:
            if key == _KEY:
                rows[row[0]].append(row[1:])
    Path(target).write_text(_table(rows), encoding="utf-8")
    terminalreporter.write_line(f"{sum(map(len, rows.values()))} published values written to {target}")


def _table(rows: dict[str, list[list[object]]]) -> str:
    lines = [
        "# Validation",
        "",
        "Published values beside ours, as the tests in `tests/validation` met them. Each test holds its own tolerance, the",
        "source's scatter. Written by `make validation`.",
        "",
    ]
    for source in sorted(rows):
        lines += [f"## {source}", "", "| quantity | published | ours | difference |", "|---|---:|---:|---:|"]
        for quantity, value, ours, unit in rows[source]:
            assert isinstance(value, float)
            assert isinstance(ours, float)
            difference = f"{100 * (ours / value - 1):+.3f} %" if value else f"{ours:+.3g}"
            lines.append(f"| {quantity} | {value:.8g} {unit} | {ours:.8g} {unit} | {difference} |")
        lines.append("")
    return "\n".join(lines)
