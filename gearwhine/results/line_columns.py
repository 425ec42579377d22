"""Columns of tables of spectral lines, alike in all results."""

from collections.abc import Callable, Sequence

from gearwhine.output.sections import Column, Row

LINE_NAME = Column("what it is", "name")
"""Column of a line's name, such as ``1× pinion -> wheel``."""

MECHANISMS = {
    "transmission_error": "transmission error",
    "varying_stiffness": "varying mesh stiffness",
    "load_shuttling": "load shuttling",
    "friction": "tooth friction",
    "pitch_errors": "pitch errors, runout or damage",
    "unbalance": "unbalance",
    "shaft_bow": "shaft bow",
    "torque_ripple": "torque ripple",
    "base_motion": "motion of the base",
    "load": "other loads",
}
"""Mechanisms of lines in words."""


def line_frequency(link: Callable[[Row], Sequence[str]] | None = None) -> Column:
    """Return the column of a line's frequency, which may link to places in the report, see :class:`Column`."""
    return Column("line [Hz]", "frequency_hz", ".1f", link=link)
