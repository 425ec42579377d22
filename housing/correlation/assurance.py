"""Modal assurance criterion (MAC) of mode shapes, auto-MAC, pole-weighted MAC, and modal scale factor.

The criterion is the squared cosine of the angle between two vectors (Allemang and Brown 1982),

    MAC(a, b) = |aᴴ b|² / (aᴴ a · bᴴ b),

between 0 and 1, whatever complex number scales either. It weighs degrees of freedom as they come: a survey with most
points on one wall judges mostly that wall, and one with too few points finds different modes alike (Allemang 2003).
:func:`auto_mac` shows the second; :mod:`housing.correlation.orthogonality` weighs by mass instead.
"""

import numpy as np
import numpy.typing as npt

from housing.correlation.shape_sets import ComplexArray, FloatArray, ShapeArray, filled, two_sets
from housing.errors import HousingError


def modal_assurance_criterion(first: npt.ArrayLike, second: npt.ArrayLike) -> FloatArray:
    """Modal assurance criterion between every shape of one set and every shape of another.

    Parameters
    ----------
    first, second : array_like, shapes (a, n_dofs) and (b, n_dofs)
        Real or complex, each shape to any scale. NaN where not measured: two shapes are compared where both were.

    Returns
    -------
    ndarray, shape (a, b)
        From 0 to 1; NaN where two shapes share no degree of freedom; 0 for a shape that is zero wherever the other was
        measured.

    Raises
    ------
    HousingError
        Where the sets do not fit together.
    """
    one, other = two_sets(first, second)
    (a, seen_a), (b, seen_b) = filled(one), filled(other)
    shared = seen_a @ seen_b.T
    product = np.abs(a.conj() @ b.T) ** 2
    norms = (np.abs(a) ** 2 @ seen_b.T) * (seen_a @ np.abs(b.T) ** 2)
    # Rounding may lift a perfect match above one.
    return np.asarray(np.where(shared, np.minimum(product / np.where(norms > 0.0, norms, 1.0), 1.0), np.nan))


def auto_mac(shapes: npt.ArrayLike) -> FloatArray:
    """MAC of a set with itself, shape (n, n): the survey cannot distinguish modes with large off-diagonal values."""
    return modal_assurance_criterion(shapes, shapes)


def modal_scale_factor(reference: npt.ArrayLike, shapes: npt.ArrayLike) -> ComplexArray:
    """The factors that bring shapes nearest to those of a reference, pair by pair, by least squares.

    aᴴ b / aᴴ a with a a shape and b its reference (Allemang 1980), over the degrees of freedom that both have.

    Parameters
    ----------
    reference, shapes : array_like, shape (n, n_dofs)

    Returns
    -------
    ndarray of complex, shape (n,)
        Zero for a shape that is zero.

    Raises
    ------
    HousingError
        Where the sets do not fit together or are not as large as each other.
    """
    target, given = two_sets(reference, shapes, ("the reference's", "the scaled"))
    if len(target) != len(given):
        raise HousingError(f"{len(given)} shapes to be scaled to {len(target)} of a reference; expected as many")
    both = ~(np.isnan(target) | np.isnan(given))
    b, a = np.where(both, target, 0.0), np.where(both, given, 0.0)
    norm = (np.abs(a) ** 2).sum(axis=1)
    return np.asarray((a.conj() * b).sum(axis=1) / np.where(norm > 0.0, norm, 1.0), dtype=np.complex128)


def pole_weighted_mac(
    first: npt.ArrayLike, first_poles: npt.ArrayLike, second: npt.ArrayLike, second_poles: npt.ArrayLike
) -> FloatArray:
    """Pole-weighted MAC: likeness of the free motions of two modes, by shape, frequency and damping (Vacher 2010).

    A mode's free motion is y(t) = Re(c v exp(λ t)). The largest of ∫ y₁·y₂ dt over the phases of both, squared and
    over the largest of ∫ |y₁|² dt and of ∫ |y₂|² dt, is

        (|v₁ᴴ v₂| / |λ₁* + λ₂| + |v₁ᵀ v₂| / |λ₁ + λ₂|)² / (n₁ n₂),    n = vᴴ v / 2|Re λ| + |vᵀ v| / 2|λ|.

    Frequencies that differ by more than the half-power bandwidths make it small, so it judges whether two
    identifications found the same mode of one machine; a model within a few per cent it condemns. A model and its
    test are shown in both respects by the MAC over both frequencies instead (the FMAC of Fotsch and Ewins 2000), as
    ``comparison.png`` does.

    Parameters
    ----------
    first, second : array_like, shapes (a, n_dofs) and (b, n_dofs)
        Without NaN.
    first_poles, second_poles : array_like of complex, shapes (a,) and (b,)
        λ = -ζω + iω√(1 - ζ²) [rad/s].

    Returns
    -------
    ndarray, shape (a, b)

    Raises
    ------
    HousingError
        Where sets and poles do not fit together, a degree of freedom is missing, or a pole does not decay.
    """
    one, other = two_sets(first, second)
    poles = [np.asarray(given, dtype=np.complex128) for given in (first_poles, second_poles)]
    for shapes, given in zip((one, other), poles, strict=True):
        if given.shape != (len(shapes),) or not np.all(given.real < 0.0):
            raise HousingError(
                f"poles {given} rad/s for {len(shapes)} shapes; expected as many, each of negative real part"
            )
        if np.isnan(shapes).any():
            raise HousingError(
                "the pole-weighted MAC needs every degree of freedom of every shape; leave out those unmeasured"
            )
    (a, _), (b, _) = filled(one), filled(other)
    p, q = poles[0][:, None], poles[1]
    product = np.abs(a.conj() @ b.T) / np.abs(p.conj() + q) + np.abs(a @ b.T) / np.abs(p + q)
    norms = np.outer(_largest_energy(a, poles[0]), _largest_energy(b, poles[1]))
    return np.asarray(np.minimum(product**2 / np.where(norms > 0.0, norms, 1.0), 1.0))


def _largest_energy(shapes: ShapeArray, poles: ComplexArray) -> FloatArray:
    hermitian, plain = (np.abs(shapes) ** 2).sum(axis=1), np.abs((shapes**2).sum(axis=1))
    return np.asarray(hermitian / (2.0 * np.abs(poles.real)) + plain / (2.0 * np.abs(poles)))


def largest_off_diagonal(matrix: FloatArray) -> float:
    """Largest off-diagonal entry of a square matrix without NaN; 0 where there is none."""
    others = matrix[~np.eye(len(matrix), dtype=bool)]
    return float(np.max(others[~np.isnan(others)], initial=0.0))
