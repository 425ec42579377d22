r"""Loaded tooth contact analysis of a pair whose flanks approach unevenly over the face: load, stiffness, mean energy.

Shafts bend and twist under load, so the flanks of a gear pair approach each other differently along the face. The
approach of a slice at z (from the middle of the face) of a tooth pair whose slice lies xi along the line of action from
the pitch point is

    a = sum_j N_j(z) y_j - h xi y_t,

y_j the approach at stations of the face along the line of action, N_j Lagrange's polynomials over them, y_t the
relative tilt of the two shafts in the plane of action [rad], and h the axial part of the tooth force over its
transverse part. The conjugate loads follow by virtual work, ``f_j = sum q w N_j`` and ``f_t = -h sum q w xi``, with q
the load per width on slices of the width w (:mod:`gearwhine.coupling.gears.contact.face_slices`).

Over a mesh period the number of pairs in contact changes while the torques, and so the mesh force ``F = sum_j f_j``,
stay, and so does the shape of the shafts. With the approach split into its mean over the face and its shape,
``y = g + c delta`` (c is 1 at the stations and 0 for the tilt), static equilibrium at each phase gives delta(p; F, g).
The mean over a period is again a contact with an energy: with U the energy of the teeth,

    V(F, g) = mean_p (F delta - U),     d = dV/dF = mean delta,     -dV/dg = mean f,
    Psi(g + c d) = F d - V,             dPsi/dy = mean f.

Psi is convex, as U is. So the mean approach of the flanks over a mesh period carries the mean loads, and the machine's
equilibrium under mean loads is the minimum of one potential.

The face load factor K_Hβ of ISO 6336-1 is the largest load per width over its mean. There the mesh is equally stiff all
over the face, so that flanks that approach evenly carry evenly. Helical ones do not quite: their lines of contact enter
and leave at the ends of the face, where they are short and press stiff teeth. ISO/TR 13989-1 counts this apart, as
buttressing. So it is here: with w the mean load per width over a mesh period, and w_0 that of the same force on flanks
that approach evenly, without helix modifications,

    K_Hβ = max w(z) / w_0(z).

w_0 of spur gears is the mean of w. A load that tilts over the face twists the teeth, and a twisted tooth presses back
at its ends, over sqrt(T / (k_b + k_h)), some third of a module (:mod:`gearwhine.coupling.gears.contact.face_slices`).
The middles of the slices stop short of the end; a parabola through the last three gives the load there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearwhine.coupling.gears.contact.contact_law import ToothContact, places_on_line_of_action
from gearwhine.coupling.gears.contact.face_slices import BalancedMeshes, SlicedMeshes, lagrange
from gearwhine.coupling.gears.errors import ContactAccuracyError, GearError
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry
from gearwhine.coupling.gears.loaded.transmission_error import LoadedMesh
from gearwhine.numerics.arrays import FloatArray

_PHASES = 48  # number of phases of a mesh period in the means
_CONVERGED_DEFLECTION_STEP = 1e-13  # last step of the mean deflection over the deflection
_ROUNDS = 60
_NO_ARM = 1e-12  # distance of the stiffness centre from the middle of the face that is rounding [m]
_TO_THE_END = np.array([15.0, -10.0, 3.0]) / 8.0
"""Parabola through values at 1/2, 3/2 and 5/2 slices from the end of the face, at the end."""


@dataclass(frozen=True, eq=False)
class FaceLoad:
    """Static equilibrium of a mesh at n phases, under one force and one shape of the approach.

    Attributes
    ----------
    force : float
        Mesh force F along the line of action, transverse [N].
    phases : ndarray, shape (n,)
        Part of the mesh period.
    deflection : ndarray, shape (n,)
        Mean approach over the face, delta [m]: the static transmission error of the teeth under load.
    loads : ndarray, shape (n, m)
        Conjugate loads: f_j of the stations [N], f_t of the tilt [N m].
    tangents : ndarray, shape (n, m, m)
        Derivatives of the loads by the approach, the shared compliance excluded.
    energy : ndarray, shape (n,)
        U [J].
    positions : ndarray, shape (n, p)
        Positions of the tooth pairs along the path of contact [base pitches].
    pair_line_loads : ndarray, shape (n, p, s)
        Load per width over the face of each tooth pair [N/m].
    """

    force: float
    phases: FloatArray
    deflection: FloatArray
    loads: FloatArray
    tangents: FloatArray
    energy: FloatArray
    positions: FloatArray
    pair_line_loads: FloatArray

    @property
    def line_load(self) -> FloatArray:
        """Transverse load per face width, all tooth pairs together [N/m], shape (n, s)."""
        return np.asarray(self.pair_line_loads.sum(axis=1))

    @property
    def peak_line_load(self) -> float:
        """Largest load per width of one tooth pair over its face and the mesh period [N/m]."""
        return float(self.pair_line_loads.max(initial=0.0))


def face_load_factor(load: FaceLoad, even: FaceLoad) -> float:
    """Face load factor K_Hβ: the largest mean load per width over that of an even approach.

    Both are relative to their means; the ratio is extrapolated from the three outer slices to the ends of the face.

    Parameters
    ----------
    load : FaceLoad
    even : FaceLoad
        Load at the same phases and about the same force on flanks that approach evenly (`FaceContact.evenly`).
    """
    mean, reference = load.line_load.mean(axis=0), even.line_load.mean(axis=0)
    ratio = mean / np.where(reference > 0.0, reference, reference.mean()) * (reference.mean() / mean.mean())
    ends = [float(_TO_THE_END @ side[:3]) for side in (ratio, ratio[::-1]) if ratio.size >= 3]
    return max(float(ratio.max()), *ends)


@dataclass(frozen=True, eq=False)
class FaceTangent:
    """Mean tangent of a mesh over its mean approach δ and y, the slope of the approach over the face and the tilt.

    The mean over a mesh period of the slices' tangents, the shared compliance included, is condensed onto δ: with the
    mean mesh stiffness κ, the loads by changes of the approach are

        dF = κ (dδ + a dy),     dM = a dF + K dy,       κ = K_δδ,       a = K_yδ / κ,       K = K_yy - κ a aᵀ.

    δ + a y is the approach at the stiffness centre: a force there tilts no flanks.

    Attributes
    ----------
    mean_stiffness : float
        κ [N/m].
    centre : ndarray, shape (2,)
        a [m]: place of the stiffness centre from the middle of the face, and from the pitch point times -h.
    stiffness : ndarray, shape (2, 2)
        K [N m/rad], symmetric and positive semidefinite.
    moments : ndarray, shape (2,)
        Mean loads M of slope and tilt at the state of linearisation [N m].
    """

    mean_stiffness: float
    centre: FloatArray
    stiffness: FloatArray
    moments: FloatArray

    def in_series(self, compliance: FloatArray) -> FaceTangent:
        """Return the tangent with a compliance (3, 3) over mean approach, slope and tilt behind it."""
        arms = np.append(1.0, self.centre)
        whole: FloatArray = np.asarray(self.mean_stiffness * np.outer(arms, arms), dtype=np.float64)
        whole[1:, 1:] += self.stiffness
        whole = np.asarray(np.linalg.solve(np.eye(3) + whole @ compliance, whole), dtype=np.float64)
        return _condensed(0.5 * (whole + whole.T), self.moments)


@dataclass(frozen=True, eq=False)
class MeanContactState:
    """Mean contact over a mesh period at an approach y: Psi, its gradient and its Hessian.

    Attributes
    ----------
    energy : float
        Psi [J].
    loads : ndarray, shape (m,)
        Mean loads dPsi/dy [N, N m].
    stiffness : ndarray, shape (m, m)
        Hessian of Psi [N/m, N, N m], symmetric and positive semidefinite.
    force : float
        Mesh force F [N]; 0 where the flanks are apart.
    """

    energy: float
    loads: FloatArray
    stiffness: FloatArray
    force: float


class FaceContact:
    """Tooth contact of a gear pair as a function of its flanks' approach over the face.

    Sound teeth without pitch deviations stand for all: the mean over a mesh period, not over the hunting period.

    Parameters
    ----------
    contact : ToothContact
        Contact law with face slices that are not misaligned.
    geometry : GearPairGeometry
    stations : ndarray, shape (j,)
        Stations of the approach from the middle of the face [m], two or more, ascending.
    axial : float
        h, axial part of the tooth force over its transverse part, as the driven gear feels it.
    phases : int
        Number of phases of a mesh period in the means.

    Raises
    ------
    GearError
        Where the contact has no face slices, or its stations lie outside the face.
    """

    def __init__(
        self,
        contact: ToothContact,
        geometry: GearPairGeometry,
        stations: FloatArray,
        axial: float,
        phases: int = _PHASES,
    ) -> None:
        if contact.faces is None:
            raise GearError("loaded tooth contact: the contact has no face slices; expected those of `face_slices`")
        if stations.size < 2 or np.any(np.abs(stations) > 0.5 * geometry.face_width * (1.0 + 1e-9)):
            raise GearError(
                f"loaded tooth contact: stations {stations.tolist()} m; expected two or more within the face"
            )
        self._contact = contact
        self._faces = contact.faces
        self._axial = axial
        self._geometry = geometry
        self._phases = phases
        self.z = contact.faces.z
        """Slices of the face, from its middle [m], shape (s,)."""
        self.stations = stations
        """From the middle of the face [m], shape (j,)."""
        self.over_face = lagrange(stations, self.z)
        """N_j at the slices, shape (s, j)."""
        # The last approach, its mesh force and the derivative of that, from which the next search starts.
        self._last: tuple[FloatArray, float, FloatArray] | None = None

    @property
    def tooth_contact(self) -> ToothContact:
        """Contact law of the loaded flanks, with slices that are not misaligned."""
        return self._contact

    @property
    def flank_gap(self) -> FloatArray:
        """Gap that the flanks' own helix modifications leave over the face [m], shape (s,)."""
        return self._faces.gap

    @property
    def size(self) -> int:
        """Number of components of the approach, m: the stations and the tilt."""
        return self.stations.size + 1

    @property
    def uniform(self) -> FloatArray:
        """c, the approach that is 1 all over the face, shape (m,)."""
        return np.append(np.ones(self.stations.size), 0.0)

    @cached_property
    def face_mean(self) -> FloatArray:
        """Mean over the face of an approach, as a row over its components, shape (m,)."""
        return np.append(self.over_face.mean(axis=0), 0.0)

    @cached_property
    def face_slope(self) -> FloatArray:
        """Slope of the best straight line through an approach over the face, as a row over its components, (m,)."""
        return np.append(self.z @ self.over_face / float(self.z @ self.z), 0.0)

    @cached_property
    def touch(self) -> float:
        """Mean over the mesh period of the approach at which even flanks first touch [m]."""
        return self._mean_phases.first_touch(np.zeros(self.size))

    @cached_property
    def linear(self) -> FloatArray:
        """Approaches that are linear over the face, by their mean, their slope and the tilt, shape (m, 3)."""
        linear = np.zeros((self.size, 3))
        linear[:-1, 0], linear[:-1, 1], linear[-1, 2] = 1.0, self.stations, 1.0
        return linear

    def tangent(self, load: FaceLoad) -> FaceTangent:
        """Mean tangent about a load over the approach, its slope over the face and the tilt."""
        moments = (load.loads @ self.linear).mean(axis=0)[1:]
        return _face_tangent(self.linear.T @ load.tangents @ self.linear, self._contact.shared_compliance, moments)

    @cached_property
    def unloaded_tangent(self) -> FaceTangent:
        """Mean tangent with all slices on the path of contact touching, as of the unloaded mean mesh stiffness."""
        prepared = self._mean_phases
        position = prepared.positions[prepared.owner, prepared.column][:, None] + self._faces.shift
        on_path = (position >= 0.0) & (position < self._contact.contact_ratio)
        tangents = prepared.meshes.tangents(prepared.meeting & on_path)
        return _face_tangent(self.linear.T @ tangents @ self.linear, self._contact.shared_compliance, np.zeros(2))

    def stiffness_of(self, load: FaceLoad) -> FloatArray:
        """Mesh stiffness at the phases of a load, all slices approaching alike, shared compliance included [N/m]."""
        stiffness = load.tangents @ self.uniform @ self.uniform
        return np.asarray(1.0 / (1.0 / stiffness + self._contact.shared_compliance))

    def under_force(self, force: float, shape: FloatArray, phases: FloatArray | None = None) -> FaceLoad:
        """Solve static equilibrium under a force, at the phases of a mesh period.

        Parameters
        ----------
        force : float
            Mesh force, above 0 [N].
        shape : ndarray, shape (m,)
            g, the approach but for its mean over the face.
        phases : ndarray, shape (n,), optional
            Mesh periods; by default equally spaced ones over a period.

        Raises
        ------
        ContactAccuracyError
            Where the touching slices do not converge.
        """
        prepared = self._mean_phases if phases is None else _Prepared(self, phases)
        return self._load(prepared, force, self._balanced(prepared, force, shape))

    def evenly(self, force: float, phases: FloatArray) -> FaceLoad:
        """Return static equilibrium under a force of flanks that approach evenly, without helix modifications.

        See `under_force`.
        """
        faces = replace(self._faces, gap=np.zeros_like(self._faces.gap))
        flat = FaceContact(replace(self._contact, faces=faces), self._geometry, self.stations, self._axial)
        return flat.under_force(force, np.zeros(self.size), phases)

    def loaded_mesh(self, load: FaceLoad) -> LoadedMesh:
        """Return a load of :mod:`gearwhine.coupling.gears.loaded.transmission_error`, for pressure and pattern."""
        stiffness = self.stiffness_of(load)
        return LoadedMesh(
            force=load.force,
            phases=load.phases,
            transmission_error=load.deflection,
            positions=load.positions,
            pair_forces=load.pair_line_loads.sum(axis=2) * self._faces.width,
            tangent_stiffness=stiffness,
            secant_stiffness=stiffness,
            line_loads=load.pair_line_loads,
        )

    def at(self, approach: FloatArray) -> MeanContactState:
        """Mean contact at an approach of the flanks, shape (m,).

        Raises
        ------
        ContactAccuracyError
            Where the mean deflection finds no force.
        """
        size, target = self.size, float(self.face_mean @ approach)
        shape, prepared = approach - self.uniform * target, self._mean_phases
        shared = self._contact.shared_compliance
        force, low, high = 0.0, 0.0, np.inf
        resumed = self._last is not None
        if self._last is not None:
            place, last_force, gradient = self._last
            force = last_force + float(gradient @ (approach - place))
        for _ in range(_ROUNDS):
            if force <= 0.0:
                # Without a guess, or with one below any force, the flanks may be apart.
                beyond = target - prepared.first_touch(shape)
                if beyond <= 0.0:
                    return MeanContactState(0.0, np.zeros(size), np.zeros((size, size)), 0.0)
                force = min(self._contact.unloaded_mean_mesh_stiffness * beyond, 0.5 * high)
            balanced, resumed = self._balanced(prepared, force, shape, resumed=resumed), True
            reached = float(balanced.compression.mean()) + shared * force
            slope = float(balanced.compliance.mean()) + shared
            if abs(reached - target) <= _CONVERGED_DEFLECTION_STEP * abs(target) + 1e-22:
                break
            low, high = (force, high) if reached < target else (low, force)
            step = force + (target - reached) / slope
            if abs(step - force) <= 4.0 * np.finfo(np.float64).eps * force:
                break
            if low < step < high:
                force = step
            elif step <= low == 0.0:
                force = 0.0
            else:
                force = 0.5 * (low + min(high, 4.0 * force + step))
        else:
            raise ContactAccuracyError(
                f"loaded tooth contact: no mesh force for a mean approach of {target:.6g} m; expected one"
            )
        return self._state(self._load(prepared, force, balanced), approach, force, target)

    def _balanced(
        self, prepared: _Prepared, force: float, shape: FloatArray, *, resumed: bool = False
    ) -> BalancedMeshes:
        """Equilibrium of the phases under a force, the shared compliance excluded."""
        return prepared.meshes.balance(np.full(prepared.phases.size, force), shape, resumed=resumed)

    def _load(self, prepared: _Prepared, force: float, balanced: BalancedMeshes) -> FaceLoad:
        """Return the load at the equilibrium of `_balanced`."""
        shared = self._contact.shared_compliance
        line_loads = np.zeros((*prepared.positions.shape, self.z.size))
        line_loads[prepared.owner, prepared.column] = balanced.faces.line_load
        return FaceLoad(
            force=force,
            phases=prepared.phases,
            deflection=balanced.compression + shared * force,
            loads=balanced.loads,
            tangents=balanced.tangents,
            energy=balanced.energy + 0.5 * shared * force**2,
            positions=prepared.positions,
            pair_line_loads=line_loads,
        )

    def _state(self, load: FaceLoad, approach: FloatArray, force: float, target: float) -> MeanContactState:
        from gearwhine.coupling.gears.contact.face_slice_kernels import mean_at_even_loads

        mean, uniform = self.face_mean, self.uniform
        by_force, by_shape = np.empty(self.size), np.empty((self.size, self.size))
        compliance = mean_at_even_loads(load.tangents, uniform, by_force, by_shape) + self._contact.shared_compliance
        # d = D_F dF + D_g dg and dg = (1 - c l) dy give dF/dy; D_g = -by_force.
        force_of = (mean + by_force - float(by_force @ uniform) * mean) / compliance
        stiffness = np.outer(by_force, force_of) + by_shape  # an even approach moves no part of by_shape
        complementary = float(np.mean(force * load.deflection - load.energy))
        self._last = approach, force, force_of
        return MeanContactState(
            energy=force * target - complementary,
            loads=load.loads.mean(axis=0),
            stiffness=0.5 * (stiffness + stiffness.T),
            force=force,
        )

    @cached_property
    def _mean_phases(self) -> _Prepared:
        return _Prepared(self, (np.arange(self._phases) + 0.5) / self._phases)

    @cached_property
    def coarse(self) -> FaceContact:
        """The same contact with means over a quarter of the phases, to search with."""
        return FaceContact(self._contact, self._geometry, self.stations, self._axial, self._phases // 4)


def _face_tangent(tangents: FloatArray, shared: float, moments: FloatArray) -> FaceTangent:
    """Mean of tangents (n, 3, 3) over mean approach, slope and tilt in series with a compliance, condensed."""
    # Rank-one update of the inverse: the shared compliance yields to the force alone.
    pull = tangents[:, :, 0]
    whole = tangents - pull[:, :, None] * pull[:, None, :] * (shared / (1.0 + shared * pull[:, 0]))[:, None, None]
    return _condensed(whole.mean(axis=0), moments)


def _condensed(whole: FloatArray, moments: FloatArray) -> FaceTangent:
    """Condense a tangent (3, 3) over mean approach, slope and tilt onto the mean approach."""
    centre = whole[1:, 0] / whole[0, 0]
    centre[np.abs(centre) < _NO_ARM] = 0.0
    stiffness = whole[1:, 1:] - whole[0, 0] * np.outer(centre, centre)
    return FaceTangent(float(whole[0, 0]), centre, 0.5 * (stiffness + stiffness.T), moments)


class _Prepared:
    """Slices of the pairs at n phases, with the approach of each by the components, (p, s, m)."""

    def __init__(self, mesh: FaceContact, phases: FloatArray) -> None:
        contact = mesh._contact
        states = contact.pairs(phases)
        assert states.faces is not None
        self.phases = phases
        self.positions = states.position
        self.owner, self.column = np.nonzero(states.present)
        self.first = np.searchsorted(self.owner, np.arange(phases.size))
        faces, self.meeting, self.gap = states.faces, states.faces.meeting, states.faces.gap
        along = places_on_line_of_action(contact, mesh._geometry, states.position[self.owner, self.column])
        basis = np.empty((*along.shape, mesh.size))
        basis[:, :, :-1] = mesh.over_face
        basis[:, :, -1] = -mesh._axial * along
        self.basis = basis
        self.meshes = SlicedMeshes(
            mesh._faces, faces.base, faces.gap, faces.meeting, self.owner, phases.size, basis, mesh.uniform
        )

    def first_touch(self, shape: FloatArray) -> float:
        """Mean over the phases of the approach at which the first slice touches [m]."""
        gap = np.where(self.meeting, self.gap - self.basis @ shape, np.inf).min(axis=1)
        return float(np.minimum.reduceat(gap, self.first).mean())
