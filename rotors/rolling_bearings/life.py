"""Rating life of a rolling bearing: of its loads by ISO 281, and of the loads of its elements by ISO/TS 16281.

**Basic rating life** (ISO 281): 90 % of like bearings reach L₁₀ = (C/P)^p million revolutions with the dynamic rating
C, the equivalent load P and p = 3 for balls or 10/3 for rollers. P = X F_r + Y F_a of the radial and the axial load; X
and Y depend on whether F_a/F_r is above e. Balls: ISO 281:2007, table 3, by contact angle and, up to 15°, by the
relative axial load F_a/(i Z D²); between entries one interpolates, and a single row up to 5° has the factors of 0°. A
row in four-point contact has those of two rows. Self-aligning balls and rollers (tables 3 and 8):

    one row     e = 1.5 tan α,  X = 1, Y = 0            to e,  X = 0.40, Y = 0.40 cot α  beyond
    two, balls  e = 1.5 tan α,  X = 1, Y = 0.42 cot α   to e,  X = 0.65, Y = 0.65 cot α  beyond
    two, rollers                X = 1, Y = 0.45 cot α   to e,  X = 0.67, Y = 0.67 cot α  beyond

It holds for steady loads up to half of C, without moments, clearance and preload between the rows.

**Basic reference rating life** (ISO/TS 16281:2008): of the loads that the elements carry, hence with clearance,
preload, tilt and centrifugal force. Balls, with the ratings Q_c of one contact
(`gearwhine.rotors.rolling_bearings.ratings`) and the inner ring turning against the load, summed over all rows:

    Q_ei = (Σ Q_i³ / Z)^{1/3},   Q_eo = (Σ Q_o^{10/3} / Z)^{3/10}
    L₁₀ᵣ = [Σ (Q_ci/Q_ei)^{−10/3} + (Q_co/Q_eo)^{−10/3}]^{−9/10}

Rollers, slice by slice with q_c = Q_c n^{−7/9} and the stresses at their ends, f_k:

    q_ei = (Σ (f q)⁴ / Z)^{1/4},   q_eo = (Σ (f q)^{9/2} / Z)^{2/9}
    L₁₀ᵣ = [Σ_k (q_ci/q_ei)^{−9/2} + (q_co/q_eo)^{−9/2}]^{−8/9}
    f_k = 1 − 0.01 / ln(1.985 |2k − n − 1| / (2n − 2))

Where the outer ring turns against the load and the inner one stands, as on a planet's pin, the powers 3 and 10/3, and 4
and 9/2, are of the other ring each.

The life of rollers goes as the fourth power of the load here and as 10/3 there; both agree near P = C. The f_k stand
for the logarithmic profile, medium loads and tilts up to 4'. ISO/TS 16281 covers single rows; more add as theirs do.
"""

import math
from collections.abc import Sequence

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.errors import require_finite
from gearwhine.rotors.rolling_bearings.element_contacts import ElementLoads
from gearwhine.rotors.rolling_bearings.equilibrium import RollingState
from gearwhine.rotors.rolling_bearings.ratings import Row, contact_ratings, dynamic_rating
from gearwhine.rotors.rolling_bearings.roller_rows import LineContactRow
from gearwhine.rotors.rolling_bearings.rolling_bearing import RollingBearing
from gearwhine.rotors.rolling_bearings.rows import FourPointRow

_MILLION = 1e6
# ISO 281:2007, table 3: relative axial load F_a / (i Z D²) [Pa] of the columns, and for each contact angle [degrees]:
# e; X and Y of one row beyond e; Y of two rows up to e; X and Y of two rows beyond.
_RELATIVE_LOAD = 1e6 * np.array([0.172, 0.345, 0.689, 1.03, 1.38, 2.07, 3.45, 5.17, 6.89])
_RADIAL_E = (0.19, 0.22, 0.26, 0.28, 0.30, 0.34, 0.38, 0.42, 0.44)
_RADIAL_Y = (2.30, 1.99, 1.71, 1.55, 1.45, 1.31, 1.15, 1.04, 1.00)
_SMALL_ANGLES: dict[float, tuple[Sequence[float], float, Sequence[float], Sequence[float], float, Sequence[float]]] = {
    0.0: (_RADIAL_E, 0.56, _RADIAL_Y, (0.0,) * 9, 0.56, _RADIAL_Y),
    5.0: (
        (0.23, 0.26, 0.30, 0.34, 0.36, 0.40, 0.45, 0.50, 0.52),
        0.56,
        _RADIAL_Y,
        (2.78, 2.40, 2.07, 1.87, 1.75, 1.58, 1.39, 1.26, 1.21),
        0.78,
        (3.74, 3.23, 2.78, 2.52, 2.36, 2.13, 1.87, 1.69, 1.63),
    ),
    10.0: (
        (0.29, 0.32, 0.36, 0.38, 0.40, 0.44, 0.49, 0.54, 0.54),
        0.46,
        (1.88, 1.71, 1.52, 1.41, 1.34, 1.23, 1.10, 1.01, 1.00),
        (2.18, 1.98, 1.76, 1.63, 1.55, 1.42, 1.27, 1.17, 1.16),
        0.75,
        (3.06, 2.78, 2.47, 2.29, 2.18, 2.00, 1.79, 1.64, 1.63),
    ),
    15.0: (
        (0.38, 0.40, 0.43, 0.46, 0.47, 0.50, 0.55, 0.56, 0.56),
        0.44,
        (1.47, 1.40, 1.30, 1.23, 1.19, 1.12, 1.02, 1.00, 1.00),
        (1.65, 1.57, 1.46, 1.38, 1.34, 1.26, 1.14, 1.12, 1.12),
        0.72,
        (2.39, 2.28, 2.11, 2.00, 1.93, 1.82, 1.66, 1.63, 1.63),
    ),
}
_LARGE_ANGLES: dict[float, tuple[float, float, float, float, float, float]] = {
    20.0: (0.57, 0.43, 1.00, 1.09, 0.70, 1.63),
    25.0: (0.68, 0.41, 0.87, 0.92, 0.67, 1.41),
    30.0: (0.80, 0.39, 0.76, 0.78, 0.63, 1.24),
    35.0: (0.95, 0.37, 0.66, 0.66, 0.60, 1.07),
    40.0: (1.14, 0.35, 0.57, 0.55, 0.57, 0.93),
    45.0: (1.34, 0.33, 0.50, 0.47, 0.54, 0.81),
}


def equivalent_load(state: RollingState) -> float | None:
    """Equivalent dynamic load P of a bearing under its load [N].

    None where ISO 281 has no factors: unlike rows, more than two of them, rows that press each other, balls beyond 45°,
    and balls at 15° or less under more axial load than table 3 lists.
    """
    rows = state.bearing.rows
    like = {(type(row), row.count, row.element_diameter, row.pitch_diameter, row.contact_angle) for row in rows}
    opposed = len({row.direction for row in rows}) == 2 and rows[0].contact_angle > 0.0
    # Opposite offsets are a displacement of the ring, by which rows do not press each other.
    pressed = sum(row.axial_offset for row in rows) > 0.0
    if len(like) > 1 or len(rows) > 2 or (opposed and pressed):
        return None
    radial = float(np.hypot(*state.load[:2]))
    axial = abs(float(state.load[2]) + state.bearing.axial_preload)
    row = rows[0]
    if isinstance(row, LineContactRow) and row.contact_angle == 0.0:
        return radial
    factors = _factors(row, len(rows), opposed or isinstance(row, FourPointRow), axial)
    if factors is None:
        return None
    e, below, (x, y) = factors
    return radial + below * axial if axial <= e * radial else x * radial + y * axial


def rated_revolutions(state: RollingState, dynamic: float) -> float | None:
    """Return the basic rating life L₁₀ of a bearing under its load, in revolutions.

    Parameters
    ----------
    state : RollingState
        The bearing in equilibrium under its load.
    dynamic : float
        Dynamic rating C of the whole bearing, as its maker prints it [N].

    Returns
    -------
    float or None
        Infinite without load; None where the equivalent load is not defined (:func:`equivalent_load`).

    Raises
    ------
    RotorError
        A rating that is not positive and finite.
    """
    require_finite("dynamic rating", dynamic, positive=True)
    load = equivalent_load(state)
    if load is None:
        return None
    return float("inf") if load == 0.0 else _MILLION * float((dynamic / load) ** life_exponent(state.bearing))


def life_exponent(bearing: RollingBearing) -> float:
    """Return the power p by which the basic rating life falls with the load."""
    return 10.0 / 3.0 if isinstance(bearing.rows[0], LineContactRow) else 3.0


def reference_revolutions(state: RollingState, dynamic: float | None = None) -> float:
    """Return the basic reference rating life L₁₀ᵣ of a bearing from the loads of its elements, in revolutions.

    Parameters
    ----------
    state : RollingState
        The bearing in equilibrium.
    dynamic : float, optional
        Dynamic rating C of the whole bearing [N]; by default from the geometry by ISO 281.

    Returns
    -------
    float
        Infinite without load.

    Raises
    ------
    RotorError
        A rating that is not positive and finite.
    """
    rows = state.bearing.rows
    if dynamic is not None:
        require_finite("dynamic rating", dynamic, positive=True)
    damage, line = 0.0, isinstance(rows[0], LineContactRow)
    for row, loads in zip(rows, state.rows, strict=True):
        rating = dynamic_rating(row, len(rows)) if dynamic is None else dynamic
        ratings = contact_ratings(row, rating, len(rows))
        damage += _line_damage(row, loads, ratings) if isinstance(row, LineContactRow) else _damage(row, loads, ratings)
    return math.inf if damage == 0.0 else _MILLION * damage ** (-8.0 / 9.0 if line else -0.9)


def _damage(row: Row, loads: ElementLoads, ratings: tuple[float, float]) -> float:
    """Sum Σ (Q_c/Q_e)^{−10/3} over both rings, and over both diagonals of four-point balls."""
    diagonals = 1 if np.unique(loads.azimuths).size == loads.azimuths.size else 2
    total = 0.0
    powers = _of_rings(row, 3.0, 10.0 / 3.0)
    for load, rating, power in zip((loads.inner_load, loads.outer_load), ratings, powers, strict=True):
        mean = (load.reshape(diagonals, -1) ** power).mean(axis=1) ** (1.0 / power)
        total += float(((mean / rating) ** (10.0 / 3.0)).sum())
    return total


def _line_damage(row: LineContactRow, loads: ElementLoads, ratings: tuple[float, float]) -> float:
    """Sum Σ_k (q_c/q_e)^{−9/2} over both rings."""
    assert loads.slice_loads is not None
    inner, total = loads.slice_loads, 0.0
    outer = inner + ((loads.outer_load - loads.inner_load) / row.slices)[:, None]
    for load, rating, power in zip((inner, outer), ratings, _of_rings(row, 4.0, 4.5), strict=True):
        mean = ((_end_stresses(row.slices) * load) ** power).mean(axis=0) ** (1.0 / power)
        total += float(((mean / (rating * row.slices ** (-7.0 / 9.0))) ** 4.5).sum())
    return total


def _of_rings(row: Row, turning: float, still: float) -> tuple[float, float]:
    """Powers of the mean load of the inner and of the outer ring: one turns against the load, one stands still."""
    return (still, turning) if row.outer_turns else (turning, still)


def _end_stresses(slices: int) -> FloatArray:
    """Stress factors f_k, (slices,): one in the middle, 2.3 at the ends."""
    if slices == 1:
        return np.ones(1)
    part = np.abs(2.0 * np.arange(1, slices + 1) - slices - 1.0) / (2.0 * slices - 2.0)
    factors = np.ones(slices)
    off = part > 0.0
    factors[off] = 1.0 - 0.01 / np.log(1.985 * part[off])
    return factors


def _factors(row: Row, rows: int, opposed: bool, axial: float) -> tuple[float, float, tuple[float, float]] | None:
    """e, Y up to e, and X and Y beyond it, of one row or of two that are opposed."""
    angle = row.contact_angle
    if isinstance(row, LineContactRow) or row.self_aligning:
        steep = 1.0 / math.tan(angle) if angle > 0.0 else 0.0
        if not opposed:
            return 1.5 * math.tan(angle), 0.0, (0.4, 0.4 * steep)
        below, beyond = (0.45, 0.67) if isinstance(row, LineContactRow) else (0.42, 0.65)
        return 1.5 * math.tan(angle), below * steep, (beyond, beyond * steep)
    degrees = math.degrees(angle)
    # The contact lines of radial balls and of a single row at small angles turn under load as those at 0°.
    if not opposed and degrees <= 5.0:
        degrees = 0.0
    relative = axial / (rows * row.count * row.element_diameter**2)
    if degrees > 45.0 + 1e-6 or (degrees < 20.0 and relative > _RELATIVE_LOAD[-1]):
        return None
    table = [
        [float(np.interp(relative, _RELATIVE_LOAD, np.broadcast_to(entry, 9))) for entry in entries]
        for entries in _SMALL_ANGLES.values()
    ]
    if not opposed:
        table[1] = table[0]
    table += [list(entries) for entries in _LARGE_ANGLES.values()]
    angles = [*_SMALL_ANGLES, *_LARGE_ANGLES]
    e, x, y, below, x_two, y_two = (float(np.interp(degrees, angles, column)) for column in zip(*table, strict=True))
    return (e, below, (x_two, y_two)) if opposed else (e, 0.0, (x, y))
