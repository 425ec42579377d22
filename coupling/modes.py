"""Complex modes of the coupled system: damped natural frequencies and mode shapes about a linearised contact."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from coupling.component import RotorComponent
from coupling.contact_state import ContactState, linear_matrices, mean_contact
from coupling.eigenpairs import Eigenpairs, quadratic_eigenpairs
from coupling.shares import ModeShares, group_bases, mode_shares
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

COORDINATE_KINDS = ("housing", "rotor", "torsion", "axial", "pedestal", "residual")

_MESH_SHARE = 0.3  # a mode with a larger share of its strain energy in the teeth is a mesh mode
_TIED = 1e-6  # shares that differ by less are equal: rounding must not choose between them
_WHIRLS = 0.01  # least share of the kinetic energy in a rotor's bending for which its whirl is given


@dataclass(frozen=True)
class ModesCertificate:
    """Certificate of completeness and accuracy of the modes.

    Attributes
    ----------
    expected, found : int
        Number of eigenvalues, 2 n and those found: conjugates, and each zero by its multiplicity.
    zeros : int
        Number of zero eigenvalues, from ranks.
    max_residual : float
        Largest |λ² q + λ C q + K q|, as a part of the norm of its terms.
    sum_rule : float
        Largest entry of Σ λ q pᴴ + X - I, 0 where every pair is there once.
    """

    expected: int
    found: int
    zeros: int
    max_residual: float
    sum_rule: float


@dataclass(frozen=True)
class CoupledModes:
    """Damped natural modes, ascending in frequency; one of each conjugate pair.

    Attributes
    ----------
    eigenvalues : ndarray of complex, shape (m,)
        λ [1/s], with a frequency of |λ| and a damping ratio of -Re λ / |λ|; exactly 0 for rigid motions.
    shapes : ndarray of complex, shape (m, n)
        Mode shapes in the coordinates, of unit norm.
    left : ndarray of complex, shape (m, n)
        Left vectors p with pᴴ (2 λ I + C) q = 1; NaN for rigid motions, whose double zeros have none such.
    kinds : tuple of str
        Kind of motion: ``housing``, ``rotor``, ``torsion``, ``axial``, ``pedestal``, ``mesh``, or ``rigid`` where
        nothing resists; ``residual`` for the local compliance beside the housing's modes, whose frequency means
        nothing.
    where : tuple of str
        The component that moves most in coordinates of that kind; of a mesh mode the contact strained most.
    energy : tuple of dict
        Share of each kind of coordinate in the mode's kinetic energy, and under ``mesh`` the teeth's share in its
        strain energy.
    shares : ModeShares
        By component, bearing and gear mesh.
    whirl : ndarray, shape (m, c)
        Whirl of each component: 1 where it whirls counter-clockwise about z in circles, -1 clockwise, 0 in a plane; NaN
        where it has no bending or hardly any in the mode.
    certificate : ModesCertificate
    pairs : Eigenpairs
        All 2n, for superposition.
    """

    eigenvalues: ComplexArray
    shapes: ComplexArray
    left: ComplexArray
    kinds: tuple[str, ...]
    where: tuple[str, ...]
    energy: tuple[dict[str, float], ...]
    shares: ModeShares
    whirl: FloatArray
    certificate: ModesCertificate
    pairs: Eigenpairs

    @property
    def frequencies_hz(self) -> FloatArray:
        """Undamped natural frequencies |λ| / 2π [Hz], shape (m,)."""
        return np.asarray(np.abs(self.eigenvalues) / (2.0 * np.pi))

    @property
    def damping_ratios(self) -> FloatArray:
        """Parts of critical, shape (m,); negative where the mode grows."""
        size = np.abs(self.eigenvalues)
        return np.asarray(-self.eigenvalues.real / np.where(size > 0.0, size, 1.0))

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """Kind and place of each mode in words, such as ``rotor: input``."""
        return tuple(f"{kind}: {place}" if place else kind for kind, place in zip(self.kinds, self.where, strict=True))


def coupled_modes(system: CoupledSystem, contact: ContactState | None = None) -> CoupledModes:
    """Eigenvalues of λ² q + λ C q + K q = 0.

    Overdamped motions come as two real eigenvalues and are both listed, with a damping ratio of 1 (or -1); a motion
    that dashpots resist but no spring does is listed at its zero, as rigid, and at its decay.

    Parameters
    ----------
    system : CoupledSystem
    contact : ContactState, optional
        :func:`coupling.mean_contact`, where it is not given, or :func:`coupling.contact_at` an instant.

    Raises
    ------
    ModesError
        Where an eigenpair fails its proof.
    """
    state = mean_contact(system) if contact is None else contact
    stiffness, damping = linear_matrices(system, state)
    pairs = quadratic_eigenpairs(stiffness, damping)
    upper = np.flatnonzero(pairs.values.imag >= 0.0)
    upper = upper[np.argsort(np.abs(pairs.values[upper]), kind="stable")]
    rigid = len(pairs.rigid)
    values = np.concatenate([np.zeros(rigid, dtype=np.complex128), pairs.values[upper]])
    shapes = np.concatenate([pairs.rigid.astype(np.complex128), pairs.right[upper]])
    left = np.concatenate([np.full((rigid, system.size), np.nan, dtype=np.complex128), pairs.left[upper]])
    shares = mode_shares(system, state, values, shapes)
    energy = _energy_by_kind(system, shares)
    kinds = ["rigid" if value == 0.0 else _kind(share) for value, share in zip(values, energy, strict=True)]
    zeros = rigid + pairs.drifts
    return CoupledModes(
        eigenvalues=values,
        shapes=shapes,
        left=left,
        kinds=tuple(kinds),
        where=tuple(_places(system, shares, kinds)),
        energy=tuple(energy),
        shares=shares,
        whirl=whirl_directions(system, *group_bases(values, shapes)),
        certificate=ModesCertificate(
            expected=2 * system.size,
            found=zeros + pairs.values.size,
            zeros=zeros,
            max_residual=float(pairs.residuals.max(initial=0.0)),
            sum_rule=pairs.sum_rule,
        ),
        pairs=pairs,
    )


def whirl_directions(system: CoupledSystem, vectors: ComplexArray, means: FloatArray) -> FloatArray:
    """Sense of each component's bending about +z in modes, shape (m, c): see :class:`CoupledModes`.

    Counter-clockwise circles have y a quarter turn behind x. With x and y in the same mass-normalised shapes of the
    shaft, the sense is the part of the kinetic energy in such circles less that in the opposite ones. ``vectors`` and
    ``means`` are those of :func:`coupling.shares.group_bases`: modes that cannot be told apart have one sense.
    """
    found = np.full((len(means), len(system.components)), np.nan)
    whole = means @ (np.abs(vectors) ** 2).sum(axis=1)
    start = 0
    for number, component in enumerate(system.components):
        end = start + component.size
        if isinstance(component, RotorComponent):
            m = component.modal.lateral.count
            x, y = vectors[:, start : start + m], vectors[:, start + m : start + 2 * m]
            forward = means @ (np.abs(x + 1j * y) ** 2).sum(axis=1)
            backward = means @ (np.abs(x - 1j * y) ** 2).sum(axis=1)
            both = forward + backward
            whirls = 0.5 * both > _WHIRLS * whole
            found[whirls, number] = ((forward - backward) / np.where(both > 0.0, both, 1.0))[whirls]
        start = end
    return found


def _energy_by_kind(system: CoupledSystem, shares: ModeShares) -> list[dict[str, float]]:
    labels = np.array(system.kinds)
    of_kind = {kind: shares.moving[:, labels == kind].sum(axis=1) for kind in COORDINATE_KINDS}
    teeth = np.array([part.kind == "contact" for part in shares.parts])
    of_kind["mesh"] = shares.strain[:, teeth].sum(axis=1)
    return [{kind: float(values[i]) for kind, values in of_kind.items()} for i in range(len(shares.moving))]


def _kind(share: dict[str, float]) -> str:
    if share["mesh"] > _MESH_SHARE:
        return "mesh"
    most = max(share[kind] for kind in COORDINATE_KINDS)
    return next(kind for kind in COORDINATE_KINDS if share[kind] >= most - _TIED)


def _places(system: CoupledSystem, shares: ModeShares, kinds: list[str]) -> list[str]:
    """Component or contact of each mode, see :attr:`CoupledModes.where`; the first of equal ones."""
    owners = np.repeat(np.arange(len(system.components)), [part.size for part in system.components])
    labels = np.array(system.kinds)
    places = []
    for i, kind in enumerate(kinds):
        if kind == "mesh":
            teeth = [j for j, part in enumerate(shares.parts) if part.kind == "contact"]
            places.append(shares.parts[teeth[_largest(shares.strain[i][teeth])]].name)
            continue
        moving = shares.moving[i] * ((labels == kind) | (kind == "rigid"))
        owned = np.bincount(owners, moving, len(system.components)).astype(np.float64)
        places.append(system.components[_largest(owned)].name)
    return places


def _largest(values: FloatArray) -> int:
    """Index of the largest share; the first of those that are equal but for rounding."""
    return int(np.flatnonzero(values >= values.max() - _TIED)[0])
