"""Cost of a study: how long its gearboxes will take by the first of them, and what of them takes most."""

from __future__ import annotations

from gearwhine.solutions import duration
from gearwhine.variation.named_quantities import takes_all_periods
from gearwhine.variation.quantities import Evaluation

_WORTH_TELLING = 60.0  # time of a study below which its cost is not told [s]
_MOST = 0.4  # part of a gearbox's time from which on what takes it is named


def cost_of_study(first: Evaluation, taken: float, count: int, noun: str, table: str) -> str:
    """Return what a long study will take by its first gearbox, and which key leaves out what takes most.

    Parameters
    ----------
    first : Evaluation
    taken : float
        Time that all will take by it [s].
    count : int
        Number of gearboxes.
    noun : str
    table : str
        Table of the case whose keys choose what is found.
    """
    if taken < _WORTH_TELLING:
        return ""
    text = f"{count} {noun} take some {duration(taken)} by the first of them"
    total = sum(first.seconds.values())
    over = {name for name in first.seconds if takes_all_periods(name)}
    parts = {name: spent for name, spent in first.seconds.items() if name not in over}
    parts["over all mesh periods"] = sum(first.seconds[name] for name in over)
    name = max(parts, key=lambda one: parts[one])
    if parts[name] < _MOST * total or total == 0.0:
        return text
    left_out = over if name == "over all mesh periods" else {name}
    what = "what pitch deviations make differ over all mesh periods" if len(left_out) > 1 else f"{name!r}"
    text += f", {100.0 * parts[name] / total:.0f} % of it for {what}"
    rest = f", which leaves {duration(taken * (1.0 - parts[name] / total))}"
    kept = dict.fromkeys(f"*.{one.rpartition('.')[2]}" for one in first.numbers if one not in left_out)
    if name in first.numbers or len(left_out) > 1:
        listed = ", ".join(f'"{one}"' for one in kept)
        return f"{text}; without it: [{table}] quantities = [{listed}]{rest}" if kept else text
    others = [one for one in first.seconds if "." not in one and one != name]
    listed = ", ".join(f'"{one}"' for one in others)
    return f"{text}; without it: [{table}] analyses = [{listed}]{rest}" if others else text
