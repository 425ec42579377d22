"""Argument principle: the number of roots of the exact equations in a region, and estimates of missing roots.

The determinant f(λ) of `gearwhine.rotors.whirl.equations` is entire, so that the number of its zeros inside a closed
contour is the winding number of f about zero along it. The contour here bounds a rectangle in the plane of w = ln λ: an
annular sector r₁ < |λ| < r₂, θ₁ < arg λ < θ₂. All oscillating motions, stable or not, lie in one such sector just
inside 0 < arg λ < π.

Known roots are divided out: q(λ) = f(λ) / Π (λ − μ_k), over all known μ_k inside and outside, is analytic on the
contour whatever the μ_k are, and the number of zeros of f inside is exactly

    winding number of q  +  number of μ_k inside,

because an error in a μ_k leaves both a zero and a pole inside, whose contributions cancel. If the μ_k are all the
roots, q is smooth with winding number zero, and few samples suffice; a missing root shows in q as in f. A μ_k next to
the contour is not divided out: the sampling decides on which side it lies. Where both senses are coupled and the speed
is real, f(λ̄) is the conjugate of f(λ), and the conjugates of the μ_k, outside the sector, are divided out too; so is a
power of λ, for the motions of a free shaft at zero.

Sampling is adaptive. With g = d ln q/dw measured at every sample by a short second step, an interval of
length h is safe when |h g| < 1.5 at both its ends and its own change of ln q is that of the mean slope. A
root of any multiplicity k at a distance d < h/2 from the interval gives |g| > k/h at both ends. So even the whole turn
of a double root, invisible in the phase, shows in the slopes, and the interval is halved.

Where a root is missing from the known ones, the power sums of all roots,

    Σ w_k^m = (1/2πi) ∮ w^m d ln q = (1/2πi) { [w^m ln q] − m ∮ w^{m−1} ln q dw },

less those of known roots not divided out, give the polynomial of the missing ones (Delves and Lyness, Math. Comp. 21,
1967).
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.rotors.errors import IncompleteModesError
from gearwhine.rotors.whirl.eigenvalues import Speed
from gearwhine.rotors.whirl.equations import WhirlEquations

NONE = np.zeros(0, dtype=np.complex128)


class RootOnContourError(IncompleteModesError):
    """A root lies on the contour, neither inside nor outside."""


@dataclass(frozen=True)
class Sector:
    """The annular sector of all λ with least < |λ| < most [rad/s], and first < arg λ < last [rad]."""

    least: float
    most: float
    first: float
    last: float

    @cached_property
    def bounds(self) -> FloatArray:
        """Least and greatest ln |λ|, and least and greatest arg λ, (4,)."""
        return np.array([math.log(self.least), math.log(self.most), self.first, self.last])

    def holds(self, eigenvalues: ComplexArray) -> npt.NDArray[np.bool_]:
        """Mark the values that lie inside."""
        from gearwhine.rotors.whirl.eigenvalue_kernels import inside

        is_inside = np.empty(eigenvalues.size, dtype=np.bool_)
        inside(eigenvalues, self.bounds, is_inside)
        return is_inside

    def halves(self, part: float) -> tuple["Sector", "Sector"]:
        """Two sectors, divided across the longer side at a fraction of it."""
        if np.log(self.most / self.least) > self.last - self.first:
            middle = self.least * (self.most / self.least) ** part
            return Sector(self.least, middle, self.first, self.last), Sector(middle, self.most, self.first, self.last)
        middle = self.first + part * (self.last - self.first)
        return Sector(self.least, self.most, self.first, middle), Sector(self.least, self.most, middle, self.last)


@dataclass(frozen=True)
class ContourCount:
    """Number of roots inside one contour, and the samples along it.

    Attributes
    ----------
    count : int
        Number of roots inside, with multiplicity.
    samples : int
        Number of determinants evaluated.
    path : ndarray of complex, shape (3, s + 1)
        Values of w, of ln q continued along the contour, and of d ln q/dw; the last point is the first.
    left : ndarray of complex
        Known roots inside that are not divided out of q.
    """

    count: int
    samples: int
    path: ComplexArray
    left: ComplexArray

    def missing(self, wanted: int) -> ComplexArray:
        """Estimates of ``wanted`` roots inside that are not among the known ones, by the power sums."""
        points, logs, slopes = self.path
        # About the middle of the contour and in its size, the powers stay of one order.
        middle = points[:-1].mean()
        size = float(np.abs(points - middle).max())
        w, slopes = (points - middle) / size, slopes * size
        h = np.diff(w)
        rest = (np.log(self.left) - middle) / size
        sums = np.empty(wanted, dtype=np.complex128)
        for m in range(1, wanted + 1):
            values = m * w ** (m - 1) * logs
            rates = m * w ** (m - 1) * slopes + m * (m - 1) * w ** max(m - 2, 0) * logs
            integral = (h * (values[1:] + values[:-1]) / 2.0 + h**2 * (rates[:-1] - rates[1:]) / 12.0).sum()
            whole = w[-1] ** m * logs[-1] - w[0] ** m * logs[0] - integral
            sums[m - 1] = whole / 2j / np.pi - (rest**m).sum()
        coefficients = np.zeros(wanted + 1, dtype=np.complex128)
        coefficients[0] = 1.0
        for m in range(1, wanted + 1):  # Newton's identities
            coefficients[m] = -(coefficients[:m][::-1] @ sums[:m]) / m
        return np.asarray(np.exp(np.roots(coefficients) * size + middle))


def count_by_argument_principle(
    equations: WhirlEquations, sector: Sector, speed: Speed, known_roots: ComplexArray = NONE
) -> ContourCount:
    """Count the roots in a sector by the winding number of the determinant along its edge.

    Parameters
    ----------
    equations : WhirlEquations
        The exact equations.
    sector : Sector
        Region of the count.
    speed : Speed
        Speed of rotation as an analytic function of λ.
    known_roots : ndarray of complex, shape (k,)
        Known roots, inside or outside; an inexact root costs samples only [rad/s].

    Raises
    ------
    RootOnContourError
        The phase does not settle however finely an edge is sampled.
    """
    from gearwhine.rotors.whirl.argument_principle_kernels import follow_contour

    matrix = equations.shooting_matrix
    base, rate = complex(speed.base), complex(speed.rate)
    points, samples, count, left, path = follow_contour(
        sector.bounds,
        (base, rate),
        equations.total_mass,
        known_roots,
        # With both senses and a speed that is real at real λ, roots come in conjugate pairs.
        len(equations.blocks) > 1 and base.imag == 0.0 == rate.imag,
        matrix.arrays,
        matrix.pattern.arrays,
    )
    if points:
        return ContourCount(count, samples, path[:, :points], left)
    raise RootOnContourError(
        f"the count of whirl modes with {sector.least:g} < |λ| < {sector.most:g} rad/s does not settle, as one lies "
        "on the edge of the region; choose a limit a little apart from it"
    )
