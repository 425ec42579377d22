"""Floquet exponents: natural frequencies and damping of a machine whose directions turn with planet carriers.

A free motion of a machine with periodic coefficients is e^{λt} Σ_m q_m e^{im·ft} (Floquet): it has the frequency of its
exponent λ and all sidebands of that, and λ + im·f are exponents of the same motion. They are the roots of Hill's
infinite determinant, here that of the harmonic balance of :mod:`gearwhine.coupling.linear.carriers.turning_response` at
complex frequencies ω = λ / i. Its receptance from a load b at the order 0 to a motion c at the order 0, g(ω) = cᵀ
A⁻¹(ω) b, has its poles there. Of a mode of the machine with its carriers frozen, with the eigenvalue λ₀ and the vectors
b right and c left, the secant method finds the zero of 1/g from λ₀ / i: the exponent of the family of this mode that is
nearest, as b and c hardly meet the others. It is the mode's own where the machine turns slowly or is nearly alike all
round.

A fixed observer sees the motion of an exponent at all frequencies Im λ + m·f, in proportion to the parts q_m that its
sensors have of it. Next to its pole the response is that motion, whatever the load.
"""

from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.linear.carriers.turning_response import TurningResponse
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.progress import Progress, silent

_FIRST_STEP = 1e-5  # first step of the secant method, relative
_CONVERGED = 1e-6  # relative step from which the next one is rounding: the order of the secant method is 1.6
_ITERATIONS = 20
_FARTHEST = 3.0  # largest distance of an exponent from the frozen eigenvalue, over the largest rate of turning
_BESIDE_POLE = 1e-6  # relative distance from an exponent at which the response is all but its motion
_SAME = 1e-7  # relative distance within which two exponents are one


@dataclass(frozen=True, eq=False)
class _Receptance:
    """1 / g(ω) of a mode."""

    model: TurningResponse
    right: ComplexArray
    left: ComplexArray

    def inverse(self, frequency: complex) -> complex:
        still = self.model.still
        moved = self.model.respond(frequency, [({still: self.right}, {})], [still])[still][0]
        return 1.0 / complex(self.left.conj() @ moved)


def floquet_exponents(
    model: TurningResponse,
    eigenvalues: ComplexArray,
    right: ComplexArray,
    left: ComplexArray,
    progress: Progress = silent,
) -> ComplexArray:
    """Exponents λ of a machine whose directions turn, nearest to eigenvalues with its carriers frozen.

    Parameters
    ----------
    model : TurningResponse
    eigenvalues : ndarray of complex, shape (m,)
        λ₀, of oscillating modes [1/s].
    right, left : ndarray of complex, shape (m, n)
        Their right and left vectors.
    progress : callable

    Returns
    -------
    ndarray of complex, shape (m,)
        λ [1/s]; NaN where the search does not settle near the eigenvalue, or settles at the exponent of another mode
        that is nearer to it.
    """
    found = np.full(len(eigenvalues), complex(np.nan, np.nan))
    for number, (value, *vectors) in enumerate(zip(eigenvalues, right, left, strict=True)):
        found[number] = _nearest(_Receptance(model, *vectors), complex(value))
        progress("exponents with turning carriers", (number + 1) / len(eigenvalues))
    distance = np.abs(found - eigenvalues)
    for first in range(len(found)):
        for second in range(first):
            if abs(found[first] - found[second]) <= _SAME * abs(found[first]):
                # A mode that the symmetry of equal planets makes twice has its exponent twice.
                if abs(eigenvalues[first] - eigenvalues[second]) <= _SAME * abs(eigenvalues[first]):
                    continue
                found[first if distance[first] > distance[second] else second] = complex(np.nan, np.nan)
    return found


def observed_frequencies(
    model: TurningResponse, exponents: ComplexArray, right: ComplexArray, sensors: FloatArray
) -> FloatArray:
    """Frequencies at which sensors that stand still see the motions of exponents most.

    Parameters
    ----------
    model : TurningResponse
    exponents : ndarray of complex, shape (m,)
        λ [1/s]; NaN is left so.
    right : ndarray of complex, shape (m, n)
        Vectors of the modes with frozen carriers.
    sensors : ndarray, shape (s, n)
        Motion of each sensor by the coordinates; one or more.

    Returns
    -------
    ndarray, shape (m,)
        |Im λ + m·f| of the order with the largest acceleration, the powers of all sensors added [rad/s].
    """
    seen = np.full(len(exponents), np.nan)
    for number in np.flatnonzero(~np.isnan(exponents)):
        frequency = complex(exponents[number]) / 1j * (1.0 + _BESIDE_POLE)
        motion = model.respond(frequency, [({model.still: right[number]}, {})])
        at = {order: frequency + model.shift(order) for order in motion}
        size = {order: abs(at[order]) ** 2 * float(np.linalg.norm(sensors @ q[0])) for order, q in motion.items()}
        seen[number] = abs(at[max(size, key=lambda order: size[order])].real)
    return seen


def _nearest(receptance: _Receptance, eigenvalue: complex) -> complex:
    """Zero of 1 / g near a frozen eigenvalue; NaN where there is none."""
    before, at = eigenvalue / 1j, eigenvalue / 1j * (1.0 + _FIRST_STEP)
    inverse_before, inverse = receptance.inverse(before), receptance.inverse(at)
    for _ in range(_ITERATIONS):
        if inverse == inverse_before:
            break
        before, at = at, at - inverse * (at - before) / (inverse - inverse_before)
        if abs(at - before) <= _CONVERGED * abs(at):
            break
        if abs(1j * at - eigenvalue) > _FARTHEST * receptance.model.rates[-1]:
            return complex(np.nan, np.nan)
        inverse_before, inverse = inverse, receptance.inverse(at)
    else:
        return complex(np.nan, np.nan)
    return 1j * at
