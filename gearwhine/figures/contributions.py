"""Transfer-path contributions of housing modes and bearings to the leading lines of the sensors, as bars."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearwhine.figures.style import BLUE, FOOT, GREY, HEAD, INK, NOTE, RED, SERIES, SHEET_WIDTH, panel, sheet, shortened
from gearwhine.stages.signature import Contribution, TracedLine

_LINES = 3  # of each sensor
_PARTS = 6  # of each kind
_BAR, _NAMES, _BARS_GAP = 3.4, 31.0, 15.0  # height of a bar, room for its name, and above a panel [mm]
_MARGIN = 4.0
_VISIBLE = 0.05  # percent, below which a part is next to nothing


def draw_contributions(title: str, lines: dict[str, tuple[TracedLine, ...]]) -> Figure:
    """Draw the parts in phase with each line, in percent of it: those of modes, then those of bearings, largest first.

    Bars to the left work against the line. Beyond the largest parts of each kind there is a bar of all others.
    """
    width = (SHEET_WIDTH - 2.0 * _MARGIN) / 2.0 - _NAMES - 3.0
    shown = [(name, line) for name, told in lines.items() for line in told[:_LINES]]
    groups = [(name, line, _gathered(line.modes), _gathered((*line.bearings, line.free))) for name, line in shown]
    heights = [_BAR * max(len(modes), len(bearings)) for _, _, modes, bearings in groups]
    height = HEAD + FOOT + sum(heights) + _BARS_GAP * len(groups)
    note = f"{title}; parts in phase with the line, in percent of it; left: housing modes, right: bearings"
    figure = sheet(height, "Where the lines come from", note)
    up = height - HEAD
    for (name, line, modes, bearings), tall in zip(groups, heights, strict=True):
        up -= _BARS_GAP - 5.0 + tall
        heading = f"{name}: {line.frequency:.0f} Hz, {abs(line.value):.3g} m/s² peak, {line.named.name}"
        figure.text(
            _MARGIN / SHEET_WIDTH,
            (up + tall + 1.2) / height,
            shortened(heading, 100),
            fontsize=NOTE + 1.0,
            color=INK,
            parse_math=False,
        )
        for side, parts in enumerate((modes, bearings)):
            left = _MARGIN + side * (width + _NAMES + 3.0) + _NAMES
            _draw(panel(figure, up, tall, left=left, width=width), parts, BLUE if side == 0 else SERIES[2])
        up -= 5.0
    return figure


def _gathered(parts: Sequence[Contribution]) -> list[tuple[str, float]]:
    """Names and shares of the largest parts, and of all others together."""
    ranked = sorted(parts, key=lambda part: -abs(part.value))
    told = [(part.name, part.share) for part in ranked[:_PARTS]]
    rest = ranked[_PARTS:]
    return [*told, (f"{len(rest)} others", sum(part.share for part in rest))] if rest else told


def _draw(axes: Axes, parts: list[tuple[str, float]], color: str) -> None:
    names, shares = [shortened(name, 26) for name, _ in parts], [100.0 * share for _, share in parts]
    axes.barh(range(len(parts)), shares, color=[color if share >= 0.0 else RED for share in shares], height=0.72)
    axes.set_yticks(range(len(parts)), names, fontsize=NOTE, parse_math=False)
    axes.tick_params(axis="y", length=0.0)
    axes.invert_yaxis()
    axes.axvline(0.0, color=GREY, lw=0.7)
    low, high = min(0.0, *shares), max(0.0, *shares)
    room = 0.2 * (high - low) or 1.0
    # A value stands beyond its bar, on the left of negative ones.
    axes.set_xlim(low - (room if min(shares) <= -_VISIBLE else 0.0), high + room)
    for place, share in enumerate(shares):
        axes.annotate(
            _percent(share), (share, place), (2.0 if share > -_VISIBLE else -2.0, 0.0), textcoords="offset points",
            fontsize=NOTE - 0.5, color=INK, va="center", ha="left" if share > -_VISIBLE else "right",
        )  # fmt: skip
    axes.grid(visible=False, axis="y")


def _percent(share: float) -> str:
    return "0" if abs(share) < _VISIBLE else f"{share:.{0 if abs(share) >= 10.0 else 1}f}"
