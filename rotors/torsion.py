"""Torsional modes of a shaft, and of a chain of inertias and springs (Holzer)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .axis_spring import AxisSpring
from .errors import require
from .lines import ContinuousShaft
from .rods import RodModes, rod_modes
from .rotor_lines import rod_shaft
from .search import find_modes
from .shaft import Rotor

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class TorsionalModes(RodModes):
    """Torsional modes, orthonormal in polar inertia; a free shaft's first is its rigid rotation."""

    @property
    def angle(self) -> FloatArray:
        """θ at the stations, rad per unit modal coordinate, (m, s)."""
        return self.amplitude


def solve_torsional_modes(
    rotor: Rotor,
    springs: Sequence[AxisSpring] = (),
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
) -> TorsionalModes:
    """Every torsional mode below a limit, or the lowest ones.

    Parameters
    ----------
    rotor
        The shaft and its discs; couplings are springs between its parts.
    springs
        To ground, N·m/rad; without them the shaft is free, and its rigid rotation is the first mode.
    frequency_limit
        rad/s: all modes strictly below.
    count
        Number of modes, a rigid rotation included; with neither, 10 or all there are.

    Raises
    ------
    RotorError
        A spring off the shaft, both a limit and a count, a rotor without polar inertia, or more modes than a
        lumped rotor has.
    IncompleteModesError
        The modes fail their own proof.
    """
    require(rotor.polar_inertia > 0.0, f"rotor {rotor.name!r} polar inertia", 0.0, "a positive inertia")
    return rod_modes(TorsionalModes, find_modes(rod_shaft(rotor, springs, "torsion"), frequency_limit, count))


def solve_torsional_chain(
    inertias: Sequence[float], stiffnesses: Sequence[float], ground: Sequence[float] | None = None
) -> TorsionalModes:
    """All modes of rigid inertias in a row, joined by massless springs, by the same transfer matrices.

    Parameters
    ----------
    inertias
        (s,): polar moments of inertia, kg·m²; zero is allowed, not everywhere.
    stiffnesses
        (s − 1,): of the springs between neighbours, N·m/rad.
    ground
        (s,): of springs from each inertia to ground, N·m/rad, zero for none and infinite for held; none at
        all without it.

    Raises
    ------
    RotorError
        Numbers that are negative or do not match in count.
    """
    masses, springs = np.array(inertias, dtype=np.float64), np.array(stiffnesses, dtype=np.float64)
    fitting = masses.ndim == 1 and springs.shape == (masses.size - 1,) and springs.size > 0
    expected = "two or more inertias and one spring between each two"
    require(fitting, "torsional chain shapes", (masses.shape, springs.shape), expected)
    positive = bool(np.isfinite(masses).all() and (masses >= 0.0).all() and masses.any())
    require(positive, "torsional chain inertias", list(inertias), "not negative, and not all zero")
    stiff = bool(np.isfinite(springs).all() and (springs > 0.0).all())
    require(stiff, "torsional chain stiffnesses", list(stiffnesses), "positive numbers")
    held = np.zeros(masses.size) if ground is None else np.array(ground, dtype=np.float64)
    fitting = held.shape == masses.shape and bool((held >= 0.0).all())
    require(fitting, "torsional chain ground", held.tolist(), "one stiffness for each inertia, none negative")

    moment = float(np.exp(np.log(springs).mean()))
    line = ContinuousShaft(
        label="torsional chain",
        nodes=np.arange(masses.size, dtype=np.float64),
        stations=np.arange(masses.size, dtype=np.float64),
        kind=np.arange(springs.size),
        start=np.zeros(springs.size),
        end=np.ones(springs.size),
        lengths=np.ones(springs.size),
        coefficients=np.stack([moment / springs, np.zeros(springs.size)], axis=1)[:, :, None],
        uniform=np.ones(springs.size, dtype=np.bool_),
        stiffness=springs[:, None],
        inertia=np.zeros((springs.size, 1)),
        force=np.zeros(springs.size),
        node_inertia=masses[:, None] / moment,
        node_stiffness=held[:, None] / moment,
        node_polar=np.zeros(masses.size),
        length_unit=1.0,
        displacement_unit=np.array([1.0 / np.sqrt(moment)]),
    )
    return rod_modes(TorsionalModes, find_modes(line, None, int(line.available_modes)))
