"""Static equilibrium of a linear structure whose parts are joined by a few nonlinear connectors.

With x the coordinates, K the linear stiffness, f the loads, and connectors of deflections z = Eᵀ x and energies φ(z),
the equilibrium is the minimum of

    Π(x) = ½ xᵀ K x - fᵀ x + Σ φ(Eᵀ x),

which is convex where the connectors' stiffness is symmetric. Each connector has a nominal law k₀ (z - z₀), so that
K₀ = K + E k₀ Eᵀ holds every motion. Then

    x = K₀⁻¹ (f + E (k₀ z₀ + μ)),      μ = k₀ (z - z₀) - dφ/dz,

and only the few components of μ are sought. With the deflections z_f = Eᵀ K₀⁻¹ (f + E k₀ z₀) under the nominal laws,
the compliance C = Eᵀ K₀⁻¹ E = S Sᵀ between the connectors, and ν = Sᵀ μ,

    z = z_f + S ν,      Π(ν) = ½ νᵀ ν + Σ (φ(z) - ½ zᵀ k₀ z + zᵀ k₀ z₀).

S has the eigenvectors of C times the roots of its eigenvalues, without those that are rounding. A trust region finds
the minimum of Π(ν), first with linear meshes, then with meshes at few phases; from there Newton's method takes the
connectors' own tangents, which may be unsymmetric.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial

import numpy as np
from scipy import linalg, sparse

from gearwhine.coupling.statics.static_model import ConnectorLaw, FaceContactLaw, LinearLaw, OffsetLaw, replace_linear
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.trust_region import Local, minimise

_TOLERANCE = 1e-9  # from there Newton's method converges in one step or two
_SETTLED = 0.1  # tolerance with linear meshes
_COARSE = 1e-3  # tolerance with meshes at few phases
_NEWTON_STEPS = 30
_HALVINGS = 6
_REFINEMENTS = 2
# Error over the deflections below which steps are not halved, and end where it hardly falls.
_ROUNDED_DEFLECTION_ERROR = 1e-11
_ROUNDING = 1e-13  # error over the deflections that is that of the structure's solution
_FALLS = 0.5  # largest part of the error that a step leaves, unless the error is rounding
_PLAY = 1e-6  # part of the largest singular value of Newton's equations below which a motion is play
_NO_COMPLIANCE = 1e-13  # part of the largest eigenvalue of the compliance below which one is rounding


@dataclass(frozen=True, eq=False)
class _Imbalance:
    """Deflections minus those under the forces that they cause, over `size`; derivative and norm; the coordinates."""

    x: FloatArray
    difference: FloatArray
    slope: FloatArray
    norm: float


class _HeldStructure:
    """The structure with the nominal laws of its connectors, K₀ = K + E k₀ Eᵀ, factorised.

    Parameters
    ----------
    stiffness, directions, nominal
        See `ConnectedStructure`.
    """

    def __init__(self, stiffness: FloatArray, directions: FloatArray, nominal: FloatArray) -> None:
        held = np.asarray(stiffness + directions @ nominal @ directions.T)
        self._factor = linalg.lu_factor(held)
        self._extended = sparse.csr_array(held).astype(np.longdouble)
        self.compliance: FloatArray = np.asarray(directions.T @ self.answer_to(directions))
        """Compliance C between the connectors, (d, d)."""

    def answer_to(self, loads: FloatArray) -> FloatArray:
        """Solve K₀ x = loads with iterative refinement, as short spans are far stiffer than soft bearings.

        What is left of the loads is taken in extended precision: its rounding would be that of the elastic forces of
        the shortest span, and moves the soft bearings.
        """
        x = linalg.lu_solve(self._factor, loads)
        for _ in range(_REFINEMENTS):
            left = loads - self._extended @ x.astype(np.longdouble)
            x = x + linalg.lu_solve(self._factor, left.astype(np.float64))
        return np.asarray(x)

    @cached_property
    def spread(self) -> FloatArray:
        """Factor S of the compliance, C = S Sᵀ."""
        values, vectors = np.linalg.eigh(0.5 * (self.compliance + self.compliance.T))
        compliant = values > _NO_COMPLIANCE * values[-1]
        return np.asarray(vectors[:, compliant] * np.sqrt(values[compliant]))

    @cached_property
    def size(self) -> FloatArray:
        """Scale of each deflection: the root of its own compliance, (d,)."""
        size = np.sqrt(np.abs(np.diag(self.compliance)))
        return np.where(size > 0.0, size, 1.0)


@lru_cache(maxsize=4)  # varied gearboxes mostly differ in their connectors' laws alone
def _held_structure(stiffness: bytes, directions: bytes, nominal: bytes, shape: tuple[int, int]) -> _HeldStructure:
    """Return a held structure by the content of its arrays; ``shape`` is that of the directions, (n, d)."""
    n, d = shape
    arrays = np.frombuffer(stiffness).reshape(n, n), np.frombuffer(directions).reshape(n, d)
    return _HeldStructure(*arrays, np.frombuffer(nominal).reshape(d, d))


@dataclass(frozen=True, eq=False)
class ConnectedStructure:
    """A linear structure with its loads and connectors.

    Attributes
    ----------
    stiffness : ndarray, shape (n, n)
        Stiffness K without the connectors.
    load : ndarray, shape (n,)
        Loads f.
    directions : ndarray, shape (n, d)
        Directions E of all connectors, side by side.
    laws : sequence of ConnectorLaw
    parts : sequence of slice
        Deflections of each law among all d.
    nominal : ndarray, shape (d, d)
        Nominal stiffness k₀.
    offset : ndarray, shape (d,)
        Offset z₀.
    """

    stiffness: FloatArray
    load: FloatArray
    directions: FloatArray
    laws: Sequence[ConnectorLaw]
    parts: Sequence[slice]
    nominal: FloatArray
    offset: FloatArray

    def equilibrium(self) -> tuple[FloatArray, int]:
        """Coordinates x in equilibrium, as nearly as rounding allows, shape (n,), and the number of steps.

        The caller has to prove the balance of forces: without an equilibrium this is the end of the search.
        """
        # The first radius of the search is the size of the motions under the loads.
        radius = max(float(np.sqrt(abs(self.load @ self._under_nominal_laws))), 1e-9)
        place, iterations = np.zeros(self._held.spread.shape[1]), 0
        for laws, tolerance in self._stages:
            minimum = minimise(partial(self._potential, laws), place, radius, tolerance)
            place, iterations = minimum.place, iterations + minimum.iterations
        x, steps = self._polished(self._start + self._held.spread @ place)
        return x, iterations + steps

    @cached_property
    def _held(self) -> _HeldStructure:
        arrays = self.stiffness, self.directions, self.nominal
        return _held_structure(*(array.tobytes() for array in arrays), self.directions.shape)

    @cached_property
    def _shift(self) -> FloatArray:
        """Force k₀ z₀ of the offsets, (d,)."""
        return np.asarray(self.nominal @ self.offset)

    @cached_property
    def _under_nominal_laws(self) -> FloatArray:
        """Coordinates under the loads with the nominal laws, (n,)."""
        return self._held.answer_to(self.load + self.directions @ self._shift)

    @cached_property
    def _start(self) -> FloatArray:
        """Deflections z_f under the nominal laws, (d,)."""
        return np.asarray(self.directions.T @ self._under_nominal_laws)

    def _beyond_nominal(self, z: FloatArray, laws: Sequence[ConnectorLaw]) -> tuple[float, FloatArray, FloatArray]:
        """Energy, force and tangent of the laws at deflections, minus those of the nominal laws."""
        energy, force, tangent = 0.0, np.zeros(z.size), np.zeros((z.size, z.size))
        for part, law in zip(self.parts, laws, strict=True):
            stored, law_force, slope = self._at(law, z[part])
            energy, force[part], tangent[part, part] = energy + stored, law_force, slope
        linear = self.nominal @ z - self._shift
        stored = 0.5 * float(z @ (self.nominal @ z)) - float(self._shift @ z)
        return energy - stored, force - linear, tangent - self.nominal

    @cached_property
    def _last(self) -> dict[int, tuple[bytes, tuple[float, FloatArray, FloatArray]]]:
        """Deflections at which each law was last evaluated, as bytes, and what it gave."""
        return {}

    def _at(self, law: ConnectorLaw, z: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        """Evaluate a law; Newton's method begins where the search of the minimum has ended."""
        last = self._last.get(id(law))
        if last is None or last[0] != z.tobytes():
            last = self._last[id(law)] = z.tobytes(), law.at(z)
        return last[1]

    @cached_property
    def _conservative_laws(self) -> list[ConnectorLaw]:
        # An unsymmetric stiffness has no energy; its nominal stiffness replaces it until Newton's method.
        return [
            replace_linear(law, LinearLaw(self.nominal[part, part]))
            for part, law in zip(self.parts, self.laws, strict=True)
        ]

    @property
    def _stages(self) -> list[tuple[list[ConnectorLaw], float]]:
        """Laws and tolerance of each stage of the search: meshes are linear while bearings settle, then at few phases.

        The nominal law of a bearing can be far off, as across its axial clearance; that of a mesh is close.
        """
        laws = self._conservative_laws
        meshes = [isinstance(law, FaceContactLaw) for law in laws]
        if not any(meshes):
            return [(laws, _TOLERANCE)]
        nominal = (OffsetLaw(LinearLaw(self.nominal[part, part]), self.offset[part]) for part in self.parts)
        linear = [other if mesh else law for law, other, mesh in zip(laws, nominal, meshes, strict=True)]
        coarse = [law.coarse if isinstance(law, FaceContactLaw) else law for law in laws]
        return [(linear, _SETTLED), (coarse, _COARSE), (laws, _TOLERANCE)]

    def _potential(self, laws: Sequence[ConnectorLaw], nu: FloatArray) -> Local:
        """Π(ν), its gradient and its second derivatives."""
        spread = self._held.spread
        energy, force, tangent = self._beyond_nominal(self._start + spread @ nu, laws)
        pushed = spread.T @ force
        noise = float(np.abs(self.load) @ np.abs(self._under_nominal_laws)) + 1e-12
        return Local(
            value=0.5 * float(nu @ nu) + energy,
            gradient=nu + pushed,
            hessian=np.eye(nu.size) + spread.T @ tangent @ spread,
            noise=noise + abs(energy),
            force=float(np.abs(nu).max(initial=0.0)) + float(np.abs(pushed).max(initial=0.0)) + 1e-300,
        )

    def _motions(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Coordinates under the loads and the connectors' forces at deflections z, and the tangents beyond nominal."""
        _, force, tangent = self._beyond_nominal(z, self.laws)
        # One solution, as the difference of two large ones would lose digits.
        return self._held.answer_to(self.load + self.directions @ (self._shift - force)), tangent

    def _imbalance(self, z: FloatArray) -> _Imbalance:
        x, tangent = self._motions(z)
        difference = (z - self.directions.T @ x) / self._held.size
        slope = np.eye(z.size) + self._held.compliance @ tangent * self._held.size / self._held.size[:, None]
        return _Imbalance(x, difference, slope, float(np.linalg.norm(difference)))

    def _polished(self, z: FloatArray) -> tuple[FloatArray, int]:
        """Newton's method with halved steps, to rounding: coordinates and the number of steps.

        A part loose in its clearance moves along directions of hardly any stiffness, in which the slope of Newton's
        equations is rounding. Where a whole step and its halves end farther off, steps leave these directions out.
        """
        imbalance, steps, cut_off = self._imbalance(z), 0, None
        for _ in range(_NEWTON_STEPS):
            before, size = imbalance.norm, float(np.linalg.norm(z / self._held.size))
            if before <= _ROUNDING * size:
                break
            step = self._held.size * np.linalg.lstsq(imbalance.slope, imbalance.difference, rcond=cut_off)[0]
            rounded = before <= _ROUNDED_DEFLECTION_ERROR * size
            for halving in range(1 if rounded else _HALVINGS):
                nearer = z - 0.5**halving * step
                trial = self._imbalance(nearer)
                if trial.norm < before:
                    z, imbalance, steps = nearer, trial, steps + 1
                    break
            if imbalance.norm == before and cut_off is None and not rounded:
                cut_off = _PLAY
            elif imbalance.norm == before or (rounded and imbalance.norm > _FALLS * before):
                break
        return imbalance.x, steps
