"""Load ratings of rows of rolling elements from their geometry: dynamic by ISO 281, static by ISO 76.

**Dynamic rating** C of i equal rows (ISO 281:2007; its factors after ISO/TR 1281-1), in N and mm,

    balls    C = b_m f_c (i cos α)^{0.7} Z^{2/3} D^{1.8}      (3.647 D^{1.4} for D > 25.4 mm)
             f_c = 98.0665 · 0.41 λ [1 + (1.04 t)^{10/3}]^{−3/10} s [2f_i/(2f_i − 1)]^{0.41}
             s = γ^{0.3} (1 − γ)^{1.39} (1 + γ)^{−1/3}
             t = [(1 − γ)/(1 + γ)]^{1.72} [(f_i/f_o) (2f_o − 1)/(2f_i − 1)]^{0.41}

    rollers  C = b_m f_c (i L cos α)^{7/9} Z^{3/4} D^{29/27}
             f_c = 551.13 · 0.377 λν [1 + (1.04 t)^{9/2}]^{−2/9} γ^{2/9} (1 − γ)^{29/27} (1 + γ)^{−1/4}
             t = [(1 − γ)/(1 + γ)]^{143/108}

with λ = 0.95 for grooves and 1 for self-aligning balls, λν = 0.83. b_m = 1.3 for balls, 1.1 for cylindrical and tapered
rollers and 1.15 for spherical ones. Within ISO's limits the standard takes grooves of 0.52 D for all, and so does the
rating here; wider ones are rated by their own.

**Ratings of one contact** (ISO/TS 16281:2008), by which the loads of the elements are weighed, t with the grooves as
they are,

    balls    Q_ci = C / (0.407 Z cos α i^{0.7}) [1 + (1.044 t)^{10/3}]^{3/10}
             Q_co = C / (0.389 Z cos α i^{0.7}) [1 + (1.044 t)^{−10/3}]^{3/10}
    rollers  Q_ci = C / (0.378 λν Z cos α i^{7/9}) [1 + (1.038 t)^{9/2}]^{2/9}
             Q_co = C / (0.364 λν Z cos α i^{7/9}) [1 + (1.038 t)^{−9/2}]^{2/9}

0.407 = J_r(½)/J_1(½) and 0.389 = J_r/J_2 are Sjövall's integrals, so that half a loaded circle has the life of ISO 281.

**Static rating** C₀ (ISO 76; its factors after ISO/TR 10657). Balls: the load under which Hertz's greatest pressure
reaches 4 200 MPa (4 600 MPa in self-aligning bearings) at the ring where it is higher, with the worst of Z balls under
5/(Z cos α) of a radial load. The outer ring decides below γ = 0.09, and the inner one above. The standard's f₀ holds
for Young's moduli of 207 GPa and for grooves up to 0.52 D and 0.53 D; closer ones are rated with these. Rollers:
44 (1 − γ) Z L D cos α, in N and mm. A row in four-point contact is rated as two, one for each diagonal.
"""

import math
from dataclasses import replace

from gearwhine.rotors.rolling_bearings.hertz import STEEL, ContactElasticity
from gearwhine.rotors.rolling_bearings.roller_rows import LineContactRow, SphericalRollerRow
from gearwhine.rotors.rolling_bearings.rows import BallRow, FourPointRow

Row = BallRow | LineContactRow

# ISO 76: pressures at which the worst element is pressed in by 1e-4 of its diameter.
_RATING_PRESSURE, _SELF_ALIGNING_PRESSURE = 4.2e9, 4.6e9
# ISO 281: groove radii over the ball's diameter up to which ratings hold, and the radius they are made with.
_WIDEST_INNER, _WIDEST_OUTER, _RATED_GROOVE = 0.52, 0.53, 0.52
_LARGE_BALL = 25.4
# ISO/TR 10657: bearing steel of the static rating.
_RATED_STEEL = ContactElasticity(ring_modulus=207e9, element_modulus=207e9)
_EDGE_LOSS = 0.83  # λν of rollers, for the stresses at their ends


def static_rating(row: Row) -> float:
    """Radial static load rating C₀ of one row after ISO 76, N, for a check of a row against a catalogue."""
    if isinstance(row, BallRow):
        share = _diagonals(row) * row.count * math.cos(row.contact_angle) / 5.0
        pressure = _SELF_ALIGNING_PRESSURE if row.self_aligning else _RATING_PRESSURE
        rated = replace(
            row, inner_groove=max(row.inner_groove, _WIDEST_INNER), outer_groove=max(row.outer_groove, _WIDEST_OUTER)
        )
        load = min(contact.load_at_pressure(pressure) for contact in (rated.inner_contact, rated.outer_contact))
        # At one pressure the load goes as 1/E*²: other materials keep their ratio to the steel of the rest of the code.
        return share * load * (STEEL.contact_modulus / _RATED_STEEL.contact_modulus) ** 2
    across = row.count * row.length * row.roller_diameter * math.cos(row.contact_angle)
    return 44e6 * (1.0 - row.gamma) * across


def dynamic_rating(row: Row, rows: int = 1) -> float:
    """Radial dynamic load rating C of ``rows`` equal rows in one bearing after ISO 281 [N]."""
    gamma, count, rows = row.gamma, row.count, rows * _diagonals(row)
    cosine = math.cos(row.contact_angle)
    if isinstance(row, BallRow):
        f_i, f_o = _rated_grooves(row)
        scale = 98.0665 * 0.41 * (1.0 if row.self_aligning else 0.95)
        shape = gamma**0.3 * (1.0 - gamma) ** 1.39 * (1.0 + gamma) ** (-1.0 / 3.0)
        both = (1.0 + (1.04 * _ball_ratio(row.gamma, f_i, f_o)) ** (10.0 / 3.0)) ** -0.3
        factor = 1.3 * scale * both * shape * (2.0 * f_i / (2.0 * f_i - 1.0)) ** 0.41
        diameter = 1e3 * row.ball_diameter
        size = diameter**1.8 if diameter <= _LARGE_BALL else 3.647 * diameter**1.4
        return float(factor * (rows * cosine) ** 0.7 * count ** (2.0 / 3.0) * size)
    scale = 551.13373 * 0.377 * _EDGE_LOSS
    shape = gamma ** (2.0 / 9.0) * (1.0 - gamma) ** (29.0 / 27.0) * (1.0 + gamma) ** -0.25
    both = (1.0 + (1.04 * _roller_ratio(row)) ** 4.5) ** (-2.0 / 9.0)
    factor = (1.15 if isinstance(row, SphericalRollerRow) else 1.1) * scale * both * shape
    length, diameter = 1e3 * row.length, 1e3 * row.roller_diameter
    return float(factor * (rows * length * cosine) ** (7.0 / 9.0) * count**0.75 * diameter ** (29.0 / 27.0))


def contact_ratings(row: Row, dynamic: float, rows: int = 1) -> tuple[float, float]:
    """Ratings Q_ci, Q_co of an element's contacts at either ring, N, from C of ``rows`` equal rows (ISO/TS 16281)."""
    share, rows = row.count * math.cos(row.contact_angle), rows * _diagonals(row)
    if isinstance(row, BallRow):
        share *= rows**0.7
        ratio = 1.044 * _ball_ratio(row.gamma, row.inner_groove, row.outer_groove)
        power, mean = 10.0 / 3.0, 0.3
        inner, outer = 0.407 * share, 0.389 * share
    else:
        share *= rows ** (7.0 / 9.0) * _EDGE_LOSS
        ratio, power, mean = 1.038 * _roller_ratio(row), 4.5, 2.0 / 9.0
        inner, outer = 0.378 * share, 0.364 * share
    return dynamic / inner * (1.0 + ratio**power) ** mean, dynamic / outer * (1.0 + ratio**-power) ** mean


def _diagonals(row: Row) -> int:
    return 2 if isinstance(row, FourPointRow) else 1


def _rated_grooves(row: BallRow) -> tuple[float, float]:
    """Grooves of the dynamic rating C."""
    if row.self_aligning:
        return max(row.inner_groove, _WIDEST_OUTER), row.outer_groove
    inner = _RATED_GROOVE if row.inner_groove <= _WIDEST_INNER else row.inner_groove
    outer = _RATED_GROOVE if row.outer_groove <= _WIDEST_OUTER else row.outer_groove
    return inner, outer


def _ball_ratio(gamma: float, f_i: float, f_o: float) -> float:
    groove = f_i / f_o * (2.0 * f_o - 1.0) / (2.0 * f_i - 1.0)
    return float(((1.0 - gamma) / (1.0 + gamma)) ** 1.72 * groove**0.41)


def _roller_ratio(row: LineContactRow) -> float:
    return float(((1.0 - row.gamma) / (1.0 + row.gamma)) ** (143.0 / 108.0))
