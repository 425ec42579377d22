"""Certified modes of a shaft in bending, torsion or axial motion, below a frequency limit or by their number."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .certificate import ModeCertificate, certify
from .chain import DiscretisedShaft
from .errors import RotorError, require, require_count, require_finite
from .fields import ShaftFields
from .lines import ContinuousShaft
from .root_count import lowest_natural_frequencies, wittrick_williams_count
from .shaft import STATION_TOLERANCE
from .shapes import SAME_ROOT, solve_mode_shapes

FloatArray = npt.NDArray[np.float64]

DEFAULT_COUNT = 10
# Part of the frequency scale below which there are rigid motions only.
STANDSTILL = 1e-12
# A first guess this far off would mean a model of no finite frequency at all.
MOST_DOUBLINGS = 200


@dataclass(frozen=True)
class SolvedModes:
    """Modes of a shaft: frequencies (m,) in rad/s, k fields, their mixture (m, k) in each mode, and a certificate."""

    frequencies: FloatArray
    fields: ShaftFields
    mixture: FloatArray
    certificate: ModeCertificate


def find_modes(line: ContinuousShaft, frequency_limit: float | None, count: int | None) -> SolvedModes:
    """Every mode of a shaft below the limit (rad/s), or the lowest ``count``."""
    require(
        frequency_limit is None or count is None,
        "frequency_limit and count",
        (frequency_limit, count),
        "one of the two",
    )
    if frequency_limit is not None:
        require_finite("frequency_limit", frequency_limit, positive=True)
        chain = line.cut(frequency_limit)
        return certified_modes(chain, wittrick_williams_count(chain, frequency_limit), frequency_limit)
    available = line.available_modes
    if count is None:
        wanted = int(min(DEFAULT_COUNT, available))
    else:
        require_count("count of modes", count)
        require(count <= available, "count of modes", count, f"at most {available:g}, all this lumped rotor has")
        wanted = count
    return certified_modes(shaft_with_modes(line, wanted), wanted)


def certified_modes(chain: DiscretisedShaft, wanted: int, limit: float | None = None) -> SolvedModes:
    """The lowest ``wanted`` modes of a shaft: all below a limit (rad/s), or with every multiple of the last root.

    Raises
    ------
    IncompleteModesError
        The modes fail their own proof.
    """
    frequencies = lowest_natural_frequencies(chain, wanted, limit or chain.highest)
    if limit is None:
        limit = limit_above(float(frequencies[-1]), chain)
        wanted = wittrick_williams_count(chain, limit)
    return proved_modes(chain, frequencies, wanted, limit)


def limit_above(last: float, chain: DiscretisedShaft) -> float:
    """A limit (rad/s) a little above the last mode, which takes in its twins, if it has any."""
    return min(max(last * (1.0 + 2.0 * SAME_ROOT), STANDSTILL * chain.highest), chain.highest)


def proved_modes(chain: DiscretisedShaft, frequencies: FloatArray, expected: int, limit: float) -> SolvedModes:
    """Modes of a chain at its lowest frequencies (m,), or at the ``expected`` lowest where those lack twins.

    Raises
    ------
    IncompleteModesError
        The modes fail their own proof.
    """
    if expected > frequencies.size:
        frequencies = lowest_natural_frequencies(chain, expected, chain.highest)
    fields, mixture, mass, stiffness = solve_mode_shapes(chain, frequencies)
    return SolvedModes(frequencies, fields, mixture, certify(limit, expected, frequencies, mass, stiffness))


def shaft_with_modes(line: ContinuousShaft, wanted: int) -> DiscretisedShaft:
    """A discretised shaft with at least ``wanted`` modes below the highest frequency that it is good for."""
    highest = line.likely_frequency(wanted)
    for _ in range(MOST_DOUBLINGS):
        chain = line.cut(highest)
        if wittrick_williams_count(chain, highest) >= wanted:
            return chain
        highest *= 2.0
    raise RotorError(f"{wanted} modes are not found below {highest:g} rad/s; expected a rotor with fewer")


def require_positions(stations: FloatArray, z: npt.ArrayLike) -> FloatArray:
    """Positions (m) as an array clipped onto the shaft; raises `RotorError` for one beyond its ends."""
    positions = np.atleast_1d(np.asarray(z, dtype=np.float64))
    low, high = float(stations[0]), float(stations[-1])
    slack = STATION_TOLERANCE * (high - low)
    inside = (positions >= low - slack) & (positions <= high + slack)
    if positions.ndim != 1 or not bool(inside.all()):
        raise RotorError(f"positions are {z!r}; expected places on the shaft, {low:g} to {high:g} m")
    return np.asarray(np.minimum(np.maximum(positions, low), high))
