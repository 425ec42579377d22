"""Natural frequencies and mode shapes of a rotor at rest, in both planes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.certificate import ModeCertificate, combined_certificate
from gearwhine.rotors.errors import require, require_count, require_finite
from gearwhine.rotors.model.bearing import Bearing, undamped
from gearwhine.rotors.model.shaft import Rotor
from gearwhine.rotors.modes.lateral import LateralModes, lateral_modes, require_unbuckled
from gearwhine.rotors.transfer_matrix.discretised_shaft import ContinuousShaft, DiscretisedShaft, discretise_together
from gearwhine.rotors.transfer_matrix.mode_shapes import limit_above, proved_modes, shaft_with_modes
from gearwhine.rotors.transfer_matrix.rotor_shafts import bending_shafts
from gearwhine.rotors.transfer_matrix.wittrick_williams import lowest_natural_frequencies, wittrick_williams_counts
from gearwhine.rotors.whirl.modal_projection import slowest
from gearwhine.rotors.whirl.planar_basis import DEFAULT_COUNT
from gearwhine.rotors.whirl.whirl_modes import WhirlModes, solve_whirl

# Number of bisections after which roots of both planes that are not separated count as one.
MOST_HALVINGS = 50


@dataclass(frozen=True)
class RestFrequencies:
    """Undamped natural frequencies of both planes at rest.

    Attributes
    ----------
    frequencies : ndarray, shape (m,)
        Lateral natural frequencies at rest of both planes, ascending [rad/s]; an isotropic root stands twice.
    axial_share : ndarray, shape (m,)
        Share of the kinetic energy along the axis, as in `gearwhine.rotors.WhirlModes`; 0 where the bearings do not
        couple axial and lateral motion.
    certificate : ModeCertificate
        Proof of completeness over both planes, and over axial motion where it is coupled to them.
    """

    frequencies: FloatArray
    axial_share: FloatArray
    certificate: ModeCertificate
    _shapes: Callable[[npt.ArrayLike], FloatArray] = field(repr=False)

    def evaluate(self, z: npt.ArrayLike) -> FloatArray:
        """Motion of every mode along x, y and z at positions z [m], of unit norm in mass, (m, 3, len(z)) [1/√kg].

        Raises
        ------
        RotorError
            A position is not on the shaft.
        """
        return self._shapes(z)


def rest_frequencies(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
) -> RestFrequencies:
    """Undamped natural frequencies of both planes of a rotor that does not turn.

    Where bearings do not couple the planes, each is solved with its own k_xx or k_yy; otherwise both are solved
    together, as in `gearwhine.rotors.solve_whirl` at zero speed.

    Parameters
    ----------
    rotor, bearings : Rotor, sequence of Bearing
        The rotor and its bearings, none for a free rotor. Tables over speed are read at their lowest speed.
    frequency_limit : float, optional
        Limit strictly below which all frequencies are found [rad/s].
    count : int, optional
        Number of frequencies over both planes, instead of a limit; with neither, 12. Multiple roots stay whole.

    Raises
    ------
    RotorError, IncompleteModesError
        As `gearwhine.rotors.solve_lateral_modes`.
    """
    undamped_bearings = [undamped(bearing.at_speed(slowest(bearing))) for bearing in bearings]
    if not all(_is_planar(bearing) for bearing in undamped_bearings):
        modes = solve_whirl(rotor, undamped_bearings, 0.0, frequency_limit=frequency_limit, count=count)
        return RestFrequencies(
            modes.damped_frequencies, modes.axial_share, modes.certificate, partial(_coupled_shapes, modes)
        )

    wanted = count
    if frequency_limit is None and count is None:
        wanted = DEFAULT_COUNT
    require_count("count of frequencies", wanted)
    planes = [tuple(bearing.plane_support(direction) for bearing in undamped_bearings) for direction in (0, 1)]
    for supports in planes:
        require_unbuckled(rotor, supports)
    continuous_shafts = bending_shafts(rotor, planes)
    alike = planes[0] == planes[1]
    if frequency_limit is not None:
        require(count is None, "frequency_limit and count", (frequency_limit, count), "one of the two")
        require_finite("frequency_limit", frequency_limit, positive=True)
        limit, shafts = (
            frequency_limit,
            discretise_together(continuous_shafts[:1] if alike else continuous_shafts, frequency_limit),
        )
        expected = wittrick_williams_counts(shafts, limit)
        by_plane = [
            lowest_natural_frequencies(shaft, number, limit) for shaft, number in zip(shafts, expected, strict=True)
        ]
    else:
        shafts, shares = _shares(continuous_shafts, wanted or DEFAULT_COUNT)
        if alike:
            shafts, shares = shafts[:1], shares[:1]
        by_plane = [
            lowest_natural_frequencies(shaft, share, shaft.highest) for shaft, share in zip(shafts, shares, strict=True)
        ]
        both = np.sort(np.concatenate(by_plane * 2 if alike else by_plane))
        if count is not None:
            most = f"at most {both.size}, all this lumped rotor has"
            require(count <= both.size, "count of frequencies", count, most)
        limit = limit_above(float(both[min(wanted or DEFAULT_COUNT, both.size) - 1]), shafts[0])
        expected = wittrick_williams_counts(shafts, limit)
        by_plane = [one[:number] for one, number in zip(by_plane, expected, strict=True)]
    solved = [
        proved_modes(shaft, frequencies, number, limit) if number else None
        for shaft, frequencies, number in zip(shafts, by_plane, expected, strict=True)
    ]
    if alike:
        solved = solved * 2
    planar = [
        (direction, lateral_modes(modes.frequencies, modes.fields, modes.mixture, planes[direction], modes.certificate))
        for direction, modes in enumerate(solved)
        if modes is not None
    ]
    frequencies = np.concatenate([modes.frequencies for _, modes in planar] or [np.zeros(0)])
    order = np.argsort(frequencies, kind="stable")
    certificate = combined_certificate([modes.certificate for _, modes in planar], limit, "wittrick-williams")
    shapes = partial(_planar_shapes, planar, order)
    return RestFrequencies(frequencies[order], np.zeros(frequencies.size), certificate, shapes)


def _planar_shapes(
    planar: Sequence[tuple[int, LateralModes]], order: npt.NDArray[np.intp], z: npt.ArrayLike
) -> FloatArray:
    """Shapes of modes that move in one plane each, x (0) or y (1)."""
    places = np.atleast_1d(np.asarray(z, dtype=np.float64))
    shapes = np.zeros((order.size, 3, places.size))
    first = 0
    for direction, modes in planar:
        shapes[first : first + modes.count, direction] = modes.evaluate(places)[0]
        first += modes.count
    return shapes[order]


def _coupled_shapes(modes: WhirlModes, z: npt.ArrayLike) -> FloatArray:
    """Shapes of modes in which planes and axis move together: in phase everywhere, as nothing damps or turns.

    Of a double root two circular motions may be found: their real and imaginary parts are its modes.
    """
    x, y = modes.evaluate(z)
    motion = np.stack([x, y, modes.evaluate_axial(z)], axis=1)
    squares = (motion**2).sum(axis=(1, 2))
    turned = motion * np.exp(-0.5j * np.angle(squares))[:, None, None]
    circular = np.abs(squares) < 0.5 * (np.abs(motion) ** 2).sum(axis=(1, 2))
    shapes = np.array(turned.real)
    number = 0
    while number < circular.size:
        if circular[number]:
            parts = np.sqrt(2.0) * np.array([turned[number].real, turned[number].imag])
            shapes[number : number + 2] = parts[: circular.size - number]
        number += 1 + int(circular[number])
    return shapes


def _is_planar(bearing: Bearing) -> bool:
    """Whether the bearing is rigidly mounted and its stiffness is diagonal, without a negative one."""
    stiffness = bearing.stiffness
    diagonal = np.count_nonzero(stiffness) == np.count_nonzero(stiffness.diagonal())
    return bearing.pedestal is None and diagonal and bool((stiffness.diagonal() >= 0.0).all())


def _shares(continuous_shafts: list[ContinuousShaft], count: int) -> tuple[list[DiscretisedShaft], list[int]]:
    """Discretised shafts of the planes, and the number of modes of each among the lowest ``count`` of both.

    A lumped rotor with fewer modes gives all of them.
    """
    # Distributed mass has no end of modes; of lumped ones, constraints take some in one plane or the other.
    available = (
        [continuous_shaft.available_modes for continuous_shaft in continuous_shafts]
        if continuous_shafts[0].available_modes < np.inf
        else [np.inf]
    )
    if sum(available) <= count:
        most = [int(number) for number in available]
        return [
            shaft_with_modes(continuous_shaft, number)
            for continuous_shaft, number in zip(continuous_shafts, most, strict=True)
        ], most
    low, high = 0.0, continuous_shafts[0].likely_frequency((count + 1) // 2)
    while True:
        shafts = discretise_together(continuous_shafts, high)
        shares = wittrick_williams_counts(shafts, high)
        if sum(shares) >= count:
            break
        low, high = high, 2.0 * high
    for _ in range(MOST_HALVINGS):
        # A superfluous mode costs less than the search for the gap between the last two.
        if sum(shares) <= count + 1:
            break
        middle = 0.5 * (low + high)
        fewer = wittrick_williams_counts(shafts, middle)
        if sum(fewer) >= count:
            high, shares = middle, fewer
        else:
            low = middle
    return shafts, shares
