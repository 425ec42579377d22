"""Exact transfer matrices of a uniform piece of shaft: Timoshenko beam in bending, rod in torsion.

Bending, at circular frequency ω, with the section's displacement x and rotation β, the shear force
``f_x = κGA (x' − β)`` and the bending moment ``f_β = EI β'``::

    x'   = β + f_x / κGA            f_x' = −ω² ρA x
    β'   = f_β / EI                 f_β' = −ω² ρI β − f_x

or y' = A y with y = (x, β, f_x, f_β); the piece's transfer matrix is T = exp(A h). The
characteristic polynomial of A h holds only even powers, λ⁴ − e₁ λ² + e₂, so that

    T = C₀ I + C₁ (A h) + C₂ (A h)² + C₃ (A h)³

where, by reducing the exponential series modulo that polynomial,

    C₂ = Σ_{k≥1} h_{k−1}/(2k)!        C₀ = 1 − e₂ Σ_{k≥2} h_{k−2}/(2k)!
    C₃ = Σ_{k≥1} h_{k−1}/(2k+1)!      C₁ = 1 − e₂ Σ_{k≥2} h_{k−2}/(2k+1)!

with h_k = e₁ h_{k−1} − e₂ h_{k−2}, h_0 = 1, h_{−1} = 0 (the complete homogeneous polynomials of the
two roots λ²). These series are entire: they need no square root, so the cut-off frequency √(κGA/ρI),
where the second wave number turns real, the massless field of the Myklestad–Prohl chain (ρ = 0),
the static state (ω = 0) and negative ω² (a shifted, positive definite problem) are no special cases.
They are used on pieces short enough (`rotors.chain`) that |λ²| stays below 5, where fourteen terms
are exact to rounding and no hyperbolic function can overflow.

Torsion is the same with y = (θ, τ): θ' = τ/GJ, τ' = −ω² ρJ θ.
"""

from math import factorial
from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
NumberArray = npt.NDArray[Any]

SERIES_TERMS = 14


def transfer_matrices(
    flexibility: FloatArray,
    inertia: FloatArray,
    length: FloatArray,
    frequency_squared: NumberArray,
    rotation_squared: NumberArray | None = None,
) -> NumberArray:
    """Transfer matrices T of uniform pieces, right state = T · left state.

    All arguments broadcast against each other over their leading axes.

    Parameters
    ----------
    flexibility
        (..., n): 1/κGA and 1/EI for bending (n = 2), 1/GJ for torsion (n = 1).
    inertia
        (..., n): ρA and ρI for bending, ρJ for torsion.
    length
        (...): length h of the piece.
    frequency_squared
        (...): ω²; may be zero, negative or complex.
    rotation_squared
        (...): what takes the place of ω² at the rotary inertia, where that is something else.

    Returns
    -------
    (..., 2n, 2n)
        In the order displacement, rotation, force, moment (bending) or angle, torque (torsion). The
        units are those of the arguments, which need only be consistent.
    """
    if flexibility.shape[-1] == 1:
        return _rod(flexibility[..., 0], inertia[..., 0], length, frequency_squared)
    rotation = frequency_squared if rotation_squared is None else rotation_squared
    return _beam(flexibility, inertia, length, frequency_squared, rotation)


def _beam(
    flexibility: FloatArray,
    inertia: FloatArray,
    length: FloatArray,
    translation: NumberArray,
    rotation: NumberArray,
) -> NumberArray:
    h = length
    a, b = flexibility[..., 0] * h, flexibility[..., 1] * h
    m, j = translation * inertia[..., 0] * h, rotation * inertia[..., 1] * h
    am, bj, bh, hm = a * m, b * j, b * h, h * m
    c0, c1, c2, c3 = _reduced_exponential(-(am + bj), b * m * (a * j - h * h))

    transfer = np.zeros((*c0.shape, 4, 4), dtype=c0.dtype)
    # The powers of A h, written out; A h = [[0, h, a, 0], [0, 0, 0, b], [-m, 0, 0, 0], [0, -j, -h, 0]].
    transfer[..., 0, 0] = transfer[..., 2, 2] = c0 - c2 * am
    transfer[..., 1, 1] = transfer[..., 3, 3] = c0 - c2 * bj
    transfer[..., 0, 1] = h * (c1 - c3 * (am + bj))
    transfer[..., 3, 2] = -transfer[..., 0, 1]
    transfer[..., 0, 2] = c1 * a - c3 * (bh * h + am * a)
    transfer[..., 0, 3] = c2 * bh
    transfer[..., 1, 2] = -transfer[..., 0, 3]
    transfer[..., 1, 0] = c3 * bh * m
    transfer[..., 2, 3] = -transfer[..., 1, 0]
    transfer[..., 1, 3] = b * (c1 - c3 * bj)
    transfer[..., 2, 0] = -m * (c1 - c3 * am)
    transfer[..., 3, 0] = c2 * hm
    transfer[..., 2, 1] = -transfer[..., 3, 0]
    transfer[..., 3, 1] = -c1 * j + c3 * (bj * j + hm * h)
    return transfer


def _rod(
    flexibility: FloatArray, inertia: FloatArray, length: FloatArray, frequency_squared: NumberArray
) -> NumberArray:
    twist, swing = flexibility * length, frequency_squared * inertia * length
    root = -twist * swing
    cosine, sine = np.ones_like(root), np.ones_like(root)
    power = np.ones_like(root)
    for k in range(1, SERIES_TERMS):
        power = power * root
        cosine = cosine + power / factorial(2 * k)
        sine = sine + power / factorial(2 * k + 1)
    transfer = np.zeros((*root.shape, 2, 2), dtype=root.dtype)
    transfer[..., 0, 0] = transfer[..., 1, 1] = cosine
    transfer[..., 0, 1] = sine * twist
    transfer[..., 1, 0] = -sine * swing
    return transfer


def _reduced_exponential(e1: NumberArray, e2: NumberArray) -> tuple[NumberArray, ...]:
    """C₀ … C₃ of the module's docstring, each of the arguments' broadcast shape."""
    older = np.zeros(np.broadcast_shapes(e1.shape, e2.shape), dtype=np.result_type(e1, e2))
    newer = np.ones_like(older)
    even_low, odd_low = older, older
    even_high, odd_high = newer / 2.0, newer / 6.0
    for k in range(2, SERIES_TERMS):
        even_low = even_low + newer / factorial(2 * k)
        odd_low = odd_low + newer / factorial(2 * k + 1)
        older, newer = newer, e1 * newer - e2 * older
        even_high = even_high + newer / factorial(2 * k)
        odd_high = odd_high + newer / factorial(2 * k + 1)
    return 1.0 - e2 * even_low, 1.0 - e2 * odd_low, even_high, odd_high
