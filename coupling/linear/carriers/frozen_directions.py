"""Frozen carriers: the warning of analyses that take directions that turn as they stand at t = 0.

Where all that stands still is alike all round, the coordinates turn with the carrier and no directions do
(:mod:`gearwhine.coupling.machine.planets`): modes and Campbell diagrams are exact. Elsewhere a machine has periodic
coefficients, and a table of modes or a diagram is that of a frozen picture. How far off it is say the exponents of
:mod:`gearwhine.coupling.linear.carriers.floquet_exponents`. Lines and responses are solved with all sidebands
(:mod:`gearwhine.coupling.linear.carriers.turning_response`) and need no warning.
"""

from typing import Any

import numpy as np

from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.numerics.result_warnings import ResultWarning, warning

FROZEN_CARRIER = "carrier frozen"
"""Name of the warning."""

FROZEN_MODES = "natural modes, damping ratios and stability"
"""Subject of the warning of natural modes."""


def frozen_warnings(
    system: CoupledSystem, analysis: str, effect: str | None = None, **figures: Any
) -> tuple[ResultWarning, ...]:
    """Warn that an analysis takes the directions of a system as they stand at t = 0; nothing where none turn.

    Parameters
    ----------
    system : CoupledSystem
    analysis : str
        Plural subject of the warning, such as ``natural modes and damping ratios``.
    effect : str, optional
        How far off the analysis is, in words.
    **figures
        Figures beside ``turning``, the names of what turns, and ``turning_hz``, the lowest rate at which it does.
    """
    if not system.turns:
        return ()
    names = [one.name for one in system.linear if one.turning]
    names += [one.name for one in system.contacts if one.turning]
    slowest = min(abs(rate) for rate in system.turning_rates) / (2.0 * np.pi)
    message = (
        f"{analysis} are those with the carriers frozen as they stand at the start, as {names[0]}"
        + (f" and {len(names) - 1} more connectors turn" if len(names) > 1 else " turns")
        + f" at {slowest:.4g} Hz against parts that are not alike all round"
        + (f"; {effect}" if effect else "")
    )
    return (warning(FROZEN_CARRIER, message, turning=names, turning_hz=slowest, **figures),)
