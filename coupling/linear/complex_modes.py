"""Complex modes of the coupled system: natural frequencies, damping, mode shapes, energy shares and stability.

The modes are those about a linearised contact. Their energy shares are kinetic energy, strain energy and damping by
component, bearing and gear mesh.

A mode λ = σ + iω with shape q has a quadratic form in each matrix: m = qᴴ q, c = qᴴ C q and k = qᴴ K q. The
symmetric parts of C and K give their real parts; gyroscopic terms do no work, and the circulatory part of K, that of
cross-coupled bearings, gives i k_c. The real part of λ* qᴴ (λ² + λ C + K) q = 0 is the balance of power, so that

    σ = - Σ (|λ|² c + ω k_c) / (|λ|² m + k),

a sum over all parts of the machine: each one's part in the damping ratio -σ/|λ|, exactly, however strongly damped.

Shapes of eigenvalues that agree to rounding are any basis of the space that they span, and so would be their shares.
Each mode of such a group has the group's means over an orthonormal basis: traces, which do not depend on the basis.

A mode with σ > 0 is unstable: it grows at the rate σ, and the parts whose share of σ is positive feed energy into it.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Literal

import numpy as np

from gearwhine.coupling.linear.carriers.frozen_directions import FROZEN_MODES, frozen_warnings
from gearwhine.coupling.linear.carriers.planetary_modes import planetary_kinds
from gearwhine.coupling.linear.eigenpairs import Eigenpairs, quadratic_eigenpairs
from gearwhine.coupling.linear.modal_superposition import SUM_RULE
from gearwhine.coupling.machine.components import RotorComponent
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.statics.mean_mesh import ContactState, linear_matrices, mean_contact
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.result_warnings import ResultWarning

# Relative distance of eigenvalues within which rounding mixes their shapes: by the eigensolver's error over this.
# Forward and backward whirl of a round shaft that hardly turns are further apart.
_SAME_EIGENVALUE_DISTANCE = 1e-8
_INDEPENDENT = 1e-6  # part of the largest singular value of a group's shapes above which a direction is one of theirs
_NOTHING = 1e-12  # strain or total energy below this part of the kinetic one is none


@dataclass(frozen=True)
class Part:
    """A part of the machine with strain energy and damping: a component, a connector, or a tooth contact."""

    kind: Literal["component", "connector", "contact"]
    name: str


@dataclass(frozen=True)
class ModeShares:
    """Energy shares of m modes, by c components and p parts.

    Attributes
    ----------
    parts : tuple of Part
        Components (shafts, housing, pedestals with their own supports), then linear connectors, then contacts.
    moving : ndarray, shape (m, n)
        Kinetic energy by coordinate.
    kinetic : ndarray, shape (m, c)
        Kinetic energy by component.
    strain : ndarray, shape (m, p)
        Strain energy by part; zeros for a rigid-body motion, negative where a part's stiffness is negative.
    damping : ndarray, shape (m, p)
        Damping ratio by part; the sum is the mode's. Negative where a part feeds energy into the mode.
    stiffness : ndarray, shape (m,)
        Re qᴴ K q / qᴴ q [1/s²]; negative where the springs as a whole destabilise the mode.
    """

    parts: tuple[Part, ...]
    moving: FloatArray
    kinetic: FloatArray
    strain: FloatArray
    damping: FloatArray
    stiffness: FloatArray


def mode_shares(
    system: CoupledSystem, contact: ContactState, eigenvalues: ComplexArray, shapes: ComplexArray
) -> ModeShares:
    """Energy shares of modes, shapes (m, n) along the rows, in the order of their frequencies."""
    groups = _groups(eigenvalues)
    eigenvalues = _over_groups(eigenvalues, groups)
    shapes, means = _bases(shapes, groups)
    motion = means @ np.abs(shapes) ** 2
    mass = motion.sum(axis=1)
    parts: list[Part] = []
    kinetic, works = [], []
    start = 0
    for component in system.components:
        rows = slice(start, start + component.size)
        start += component.size
        parts.append(Part("component", component.name))
        kinetic.append(motion[:, rows].sum(axis=1))
        # The gyroscopic terms are skew and contribute to none of the three.
        works.append(_work(shapes[:, rows], component.stiffness, component.damping))
    for connector in system.linear:
        parts.append(Part("connector", connector.name))
        works.append(_work(shapes @ connector.directions, connector.stiffness, connector.damping))
    for tooth, k, c in zip(system.contacts, contact.stiffness, contact.damping, strict=True):
        parts.append(Part("contact", tooth.name))
        compression = np.abs(shapes @ tooth.direction) ** 2
        works.append((k * compression, 0.0 * compression, c * compression))
    strained, fed, lost = (np.array(rows) @ means.T for rows in zip(*works, strict=True))
    size = np.abs(eigenvalues)
    strain = strained.sum(axis=0)
    total = size**2 * mass + strain
    # Real eigenvalues of an undamped system with a negative stiffness have no total energy.
    safe = np.where(np.abs(total) > _NOTHING * size**2 * mass, total * np.where(size > 0.0, size, 1.0), np.inf)
    damping_shares = (size**2 * lost + eigenvalues.imag * fed) / safe
    strain_sum = np.abs(strained).sum(axis=0)
    return ModeShares(
        parts=tuple(parts),
        moving=motion / mass[:, None],
        kinetic=np.array(kinetic).T / mass[:, None],
        strain=(strained / np.where((size > 0.0) & (strain_sum > 0.0) & (strain != 0.0), strain, np.inf)).T,
        damping=np.where(size > 0.0, damping_shares, 0.0).T,
        stiffness=np.where(size > 0.0, strain / mass, 0.0),
    )


def _groups(eigenvalues: ComplexArray) -> list[slice]:
    """Group modes, ascending in frequency, whose eigenvalues agree to rounding; rigid motions stand alone."""
    size = np.abs(eigenvalues)
    apart = np.abs(np.diff(eigenvalues)) > _SAME_EIGENVALUE_DISTANCE * np.minimum(size[1:], size[:-1])
    edges = [0, *(np.flatnonzero(apart | (size[1:] == 0.0) | (size[:-1] == 0.0)) + 1).tolist(), len(eigenvalues)]
    return [slice(begin, end) for begin, end in pairwise(edges) if end > begin]


def _over_groups(values: ComplexArray, groups: list[slice]) -> ComplexArray:
    """Replace the values of each group by their mean."""
    return np.concatenate([np.full(len(values[group]), values[group].mean()) for group in groups] or [values])


def group_bases(eigenvalues: ComplexArray, shapes: ComplexArray) -> tuple[ComplexArray, FloatArray]:
    """Orthonormal bases of the spaces of groups of modes, (b, n), and the averaging weights of each mode, (m, b).

    A quadratic form summed over an orthonormal basis of a group's space does not depend on the choice of basis.
    """
    return _bases(shapes, _groups(eigenvalues))


def _bases(shapes: ComplexArray, groups: list[slice]) -> tuple[ComplexArray, FloatArray]:
    """Orthonormal basis of each group's shapes, (b, n), and the averaging weights of each mode, (m, b)."""
    bases: list[ComplexArray] = []
    means = np.zeros((len(shapes), 0))
    for group in groups:
        basis = shapes[group]
        if len(basis) > 1:
            _, sizes, rows = np.linalg.svd(basis, full_matrices=False)
            basis = rows[sizes > _INDEPENDENT * sizes[0]]
        mean = np.zeros((len(shapes), len(basis)))
        mean[group] = 1.0 / len(basis)
        bases.append(basis)
        means = np.hstack([means, mean])
    return (np.concatenate(bases) if bases else shapes), means


def _work(
    deflections: ComplexArray, stiffness: FloatArray, damping: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Re qᴴ K q, Im qᴴ K q and Re qᴴ C q of deflections along the rows, shape (m,) each."""
    symmetric, skew = 0.5 * (stiffness + stiffness.T), 0.5 * (stiffness - stiffness.T)

    def form(matrix: FloatArray) -> ComplexArray:
        return np.asarray(np.sum(deflections.conj() * (deflections @ matrix.T), axis=1))

    return form(symmetric).real, form(skew).imag, form(0.5 * (damping + damping.T)).real


COORDINATE_KINDS = ("housing", "rotor", "torsion", "axial", "body", "pedestal", "residual")

_MESH_SHARE = 0.3  # a mode with a larger share of its strain energy in the teeth is a mesh mode
_EQUAL_SHARES = 1e-6  # shares that differ by less are equal: rounding must not choose between them
_WHIRLS = 0.01  # least share of the kinetic energy in a rotor's bending for which its whirl is given


@dataclass(frozen=True)
class ModesCertificate:
    """Certificate of completeness and accuracy of the modes.

    Attributes
    ----------
    expected, found : int
        Number of eigenvalues expected, 2 n, and found; conjugates count, and each zero by its multiplicity.
    zeros : int
        Number of zero eigenvalues, from ranks.
    max_residual : float
        Largest |λ² q + λ C q + K q| over the norm of its terms.
    sum_rule : float
        Largest entry of Σ λ q pᴴ + X - I, 0 where every pair is there once.
    """

    expected: int
    found: int
    zeros: int
    max_residual: float
    sum_rule: float

    @property
    def is_complete(self) -> bool:
        """Whether all eigenvalues are there, and the sum rule proves each of them to be there once."""
        return self.found == self.expected and self.sum_rule <= SUM_RULE


@dataclass(frozen=True)
class CoupledModes:
    """Damped natural modes, ascending in frequency; one of each conjugate pair.

    Attributes
    ----------
    eigenvalues : ndarray of complex, shape (m,)
        Eigenvalues λ [1/s] with frequency |λ| and damping ratio -Re λ / |λ|; exactly 0 for rigid motions.
    shapes : ndarray of complex, shape (m, n)
        Mode shapes in the coordinates, of unit norm.
    left : ndarray of complex, shape (m, n)
        Left vectors p with pᴴ (2 λ I + C) q = 1; NaN for rigid motions, whose double zeros have none such.
    kinds : tuple of str
        Kind of motion: ``housing``, ``rotor``, ``torsion``, ``axial``, ``body`` (a gear's), ``pedestal``, ``mesh``, or
        ``rigid`` where nothing resists; ``residual`` for the local compliance beside the housing's modes,
        whose frequency means nothing.
    where : tuple of str
        The component that moves most in coordinates of that kind; of a mesh mode the contact strained most.
    energy : tuple of dict
        Share of each kind of coordinate in the mode's kinetic energy, and under ``mesh`` the teeth's share in its
        strain energy.
    shares : ModeShares
        Energy shares of components, bearings and gear meshes.
    whirl : ndarray, shape (m, c)
        Whirl of each component: 1 where it whirls counter-clockwise about z in circles, -1 clockwise, 0 in a plane; NaN
        where it has no bending or hardly any in the mode.
    certificate : ModesCertificate
    pairs : Eigenpairs
        All 2n eigenpairs, for superposition.
    planetary : tuple of str
        Kind of each mode in a planetary set, such as ``rotational: carrier``, see
        :mod:`gearwhine.coupling.linear.carriers.planetary_modes`; empty for modes of other parts.
    warnings : tuple of dict
        That they are those of frozen carriers, see :mod:`gearwhine.coupling.linear.carriers.frozen_directions`.
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
    planetary: tuple[str, ...] = ()
    warnings: tuple[ResultWarning, ...] = ()

    @property
    def frequencies_hz(self) -> FloatArray:
        """Undamped natural frequencies |λ| / 2π [Hz], shape (m,)."""
        return np.asarray(np.abs(self.eigenvalues) / (2.0 * np.pi))

    @property
    def damping_ratios(self) -> FloatArray:
        """Damping ratios, shape (m,); negative where the mode grows."""
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
        Contact state: by default :func:`gearwhine.coupling.statics.mean_mesh.mean_contact`, or
        :func:`gearwhine.coupling.statics.mean_mesh.contact_at` for an instant.

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
        planetary=planetary_kinds(system, shares.moving),
        warnings=frozen_warnings(system, FROZEN_MODES),
    )


def whirl_directions(system: CoupledSystem, vectors: ComplexArray, means: FloatArray) -> FloatArray:
    """Sense of each component's bending about +z in modes, shape (m, c): see :class:`CoupledModes`.

    Counter-clockwise circles have y a quarter turn behind x. With x and y in the same mass-normalised shapes of the
    shaft, the sense is the part of the kinetic energy in such circles less that in the opposite ones. ``vectors`` and
    ``means`` are those of :func:`gearwhine.coupling.linear.complex_modes.group_bases`: indistinguishable modes have one
    sense.
    """
    directions = np.full((len(means), len(system.components)), np.nan)
    whole = means @ (np.abs(vectors) ** 2).sum(axis=1)
    start = 0
    for number, component in enumerate(system.components):
        end = start + component.size
        if isinstance(component, RotorComponent):
            m = component.plane_size
            x, y = vectors[:, start : start + m], vectors[:, start + m : start + 2 * m]
            forward = means @ (np.abs(x + 1j * y) ** 2).sum(axis=1)
            backward = means @ (np.abs(x - 1j * y) ** 2).sum(axis=1)
            both = forward + backward
            whirls = 0.5 * both > _WHIRLS * whole
            directions[whirls, number] = ((forward - backward) / np.where(both > 0.0, both, 1.0))[whirls]
        start = end
    return directions


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
    return next(kind for kind in COORDINATE_KINDS if share[kind] >= most - _EQUAL_SHARES)


def _places(system: CoupledSystem, shares: ModeShares, kinds: list[str]) -> list[str]:
    """Component or contact of each mode, see :attr:`CoupledModes.where`; the first where several are equal."""
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
    """Index of the largest share; the first where several are equal within rounding."""
    return int(np.flatnonzero(values >= values.max() - _EQUAL_SHARES)[0])


_NEUTRAL = 1e-9  # damping ratios below this are rounding
_EIGENVALUE_ROUNDING = 1e-12  # eigenvalues below this part of the largest are rounding


@dataclass(frozen=True)
class GrowingMode:
    """An unstable mode, which grows from any disturbance until a nonlinearity limits it.

    Attributes
    ----------
    mode : int
        Index among the modes.
    eigenvalue : complex
        λ [1/s]; real for a divergence without oscillation.
    kind, where : str
        Kind and place as in :class:`gearwhine.coupling.linear.complex_modes.CoupledModes`.
    feeders : tuple of (Part, float)
        Parts that feed energy into it, the strongest first, with their negative parts of the damping ratio. For a
        divergence by negative stiffness, those parts with minus their shares of the strain energy.
    """

    mode: int
    eigenvalue: complex
    kind: str
    where: str
    feeders: tuple[tuple[Part, float], ...]

    @property
    def damping_ratio(self) -> float:
        """-Re λ / |λ|, negative."""
        return float(-self.eigenvalue.real / abs(self.eigenvalue))

    @property
    def doubling_time(self) -> float:
        """Time in which its amplitude doubles [s]."""
        return float(np.log(2.0) / self.eigenvalue.real)


@dataclass(frozen=True)
class Stability:
    """Stability of a set of modes.

    Attributes
    ----------
    growing : tuple of GrowingMode
        Growing modes, the fastest first; none in a stable system.
    least_damped : int or None
        Index of the oscillating mode with the lowest damping ratio.
    """

    growing: tuple[GrowingMode, ...]
    least_damped: int | None

    @property
    def stable(self) -> bool:
        """Whether no mode grows."""
        return not self.growing


def stability(modes: CoupledModes, tolerance: float = _NEUTRAL) -> Stability:
    """Stability of modes by the sign of their damping.

    Parameters
    ----------
    modes : CoupledModes
    tolerance : float
        Damping ratios from -tolerance up count as stable, as do eigenvalues within rounding of zero.
    """
    ratios = modes.damping_ratios
    # The damping ratio of a rigid-body motion is ±1 however small its eigenvalue.
    still = np.abs(modes.eigenvalues) <= _EIGENVALUE_ROUNDING * np.abs(modes.eigenvalues).max(initial=0.0)
    growing = [_growing(modes, int(i)) for i in np.flatnonzero((ratios < -tolerance) & ~still)]
    swinging = np.flatnonzero(modes.eigenvalues.imag > 0.0)
    return Stability(
        growing=tuple(sorted(growing, key=lambda one: -one.eigenvalue.real)),
        least_damped=int(swinging[np.argmin(ratios[swinging])]) if swinging.size else None,
    )


def _growing(modes: CoupledModes, i: int) -> GrowingMode:
    shares = modes.shares
    swings = modes.eigenvalues[i].imag != 0.0
    # A divergence by negative stiffness is independent of the damping: dashpots only slow it.
    shares_of_parts = shares.damping[i] if swings or shares.stiffness[i] >= 0.0 else -shares.strain[i]
    least = -_NEUTRAL * float(np.abs(shares_of_parts).max(initial=0.0))
    feeders = [
        (shares.parts[j], float(shares_of_parts[j]))
        for j in np.argsort(shares_of_parts, kind="stable")
        if shares_of_parts[j] < least
    ]
    return GrowingMode(i, complex(modes.eigenvalues[i]), modes.kinds[i], modes.where[i], tuple(feeders))
