"""Mesh harmonics: response of a machine about its operating point to loaded transmission error and load shuttling.

About the operating point a mesh under its mean force F acts as its mean mesh stiffness k and damping c, driven by its
loaded transmission error e(t) and by the moments of its shuttling load. At a mesh harmonic ω the motion q of the
machine is

    Z q = f,      Z = K + iωC - ω² I,      f = Σ k e d + moments of shuttling,

K and C with the tangents of bearings and meshes, d the directions of the meshes. Both excitations of a mesh are
periodic with it, and their phases are those of one mesh period: at a harmonic they add as complex numbers, and one may
be far above the other at a sensor. A transmissibility by transmission error alone misses the second.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import linalg

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears.loaded.transmission_error import (
    LoadedMesh,
    hunting_period_mesh,
    loaded_transmission_error,
    mesh_period_phases,
    transmission_error_phasors,
)
from gearwhine.coupling.statics.mean_mesh import ContactState, linear_matrices, mean_contact

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

HARMONICS = 12
"""Largest number of harmonics of a mesh."""
_POINTS = 200  # number of phases of a mesh period, as in the mean mesh
_SAME_FREQUENCY_DIFFERENCE = 1e-9  # relative difference below which frequencies are equal


@dataclass(frozen=True, eq=False)
class Response:
    """Motion of the machine at a mesh harmonic.

    Attributes
    ----------
    frequency : float
        Circular frequency ω [rad/s].
    causes : tuple of (int, int)
        For each mesh that drives the motion, number of its contact in the system and harmonic of its mesh frequency.
    motion : ndarray of complex, shape (n,)
        Motion q by the coordinates of the system.
    """

    frequency: float
    causes: tuple[tuple[int, int], ...]
    motion: ComplexArray


@dataclass(frozen=True, eq=False)
class ResponseParts(Response):
    """Motion of the machine at a mesh harmonic, and its parts.

    Attributes
    ----------
    by_error, by_shuttling : ndarray of complex, shape (n,)
        Motions by the transmission errors and by the load shuttling of the meshes that drive it; q is their sum.
    """

    by_error: ComplexArray
    by_shuttling: ComplexArray


@dataclass(frozen=True, eq=False)
class MeshLoad:
    """Load on the machine at a mesh harmonic, by all meshes that drive it.

    Attributes
    ----------
    frequency : float
        Circular frequency ω [rad/s].
    causes : tuple of (int, int)
        As of a `Response`.
    load : ndarray of complex, shape (n,)
        Load f on the coordinates of the system.
    """

    frequency: float
    causes: tuple[tuple[int, int], ...]
    load: ComplexArray


@dataclass(frozen=True, eq=False)
class MeshHarmonicModel:
    """A machine linear about its mean load, driven by its loaded meshes.

    Attributes
    ----------
    machine : CoupledMachine
        Assembled about its operating point.
    """

    machine: CoupledMachine

    @cached_property
    def contact(self) -> ContactState:
        """Contacts about their mean forces."""
        return mean_contact(self.machine.system)

    @cached_property
    def loaded(self) -> tuple[int, ...]:
        """Numbers of the contacts that carry a mean force and turn."""
        force = self.contact.force
        contacts = self.machine.system.contacts
        return tuple(
            n
            for n, contact in enumerate(contacts)
            if force is not None and force[n] > 0.0 and contact.mesh_frequency != 0.0
        )

    def loads(self, limit: float) -> tuple[MeshLoad, ...]:
        """Return the loads f of the mesh harmonics up to a limit [rad/s], ascending."""
        return tuple(MeshLoad(w, causes, self._load(causes)) for w, causes in self._harmonics(limit))

    def responses(self, limit: float) -> tuple[Response, ...]:
        """Solve the motions at the mesh harmonics up to a limit [rad/s], ascending."""
        return tuple(
            Response(w, causes, linalg.solve(self._dynamic(w), self._load(causes)))
            for w, causes in self._harmonics(limit)
        )

    def parts(self, limit: float) -> tuple[ResponseParts, ...]:
        """Solve the motions of `responses` with their parts by transmission error and by load shuttling."""
        parts = []
        for w, causes in self._harmonics(limit):
            loads = np.stack([self._error_load(causes), self._shuttling_load(causes)], axis=1)
            by_error, by_shuttling = linalg.solve(self._dynamic(w), loads).T
            parts.append(ResponseParts(w, causes, by_error + by_shuttling, by_error, by_shuttling))
        return tuple(parts)

    def dynamic_stiffness(self, frequency: float) -> ComplexArray:
        """Z at a frequency [rad/s], shape (n, n)."""
        return self._dynamic(frequency)

    def transmission_error(
        self, number: int, mesh: LoadedMesh, *, hunting_period: int, count: int = HARMONICS
    ) -> ComplexArray:
        """Harmonics of a loaded mesh's transmission error at t = 0 [m], shape (count,).

        Parameters
        ----------
        number : int
            Number of the contact in the system, which gives the phase and the mesh frequency.
        mesh : LoadedMesh
            Loaded mesh of the flanks of this contact, or of flanks in their place.
        hunting_period : int
            Number of mesh periods that the phases of ``mesh`` cover.
        count : int
        """
        contact = self.machine.system.contacts[number]
        phasors = transmission_error_phasors(mesh, count, hunting_period)
        phasors = phasors.conj() if contact.mesh_frequency < 0.0 else phasors
        orders = np.arange(1, count + 1)
        return np.asarray(phasors * np.exp(2j * np.pi * np.sign(contact.mesh_frequency) * orders * contact.phase))

    def shuttling_loads(self, number: int, law: ToothContact, force: float) -> dict[int, ComplexArray]:
        """Moments of load shuttling by harmonic, of the flanks ``law`` under a force [N], shape (n,) each."""
        rate = abs(self.machine.system.contacts[number].mesh_frequency)
        loads = self.machine.shuttling(number, law, force)[1]
        return {round(load.frequency / (2.0 * np.pi * rate)): load.amplitude for load in loads}

    def _dynamic(self, w: float) -> ComplexArray:
        stiffness, damping = self._matrices
        return np.asarray(stiffness + 1j * w * damping - w**2 * np.eye(len(stiffness)))

    @cached_property
    def _matrices(self) -> tuple[FloatArray, FloatArray]:
        return linear_matrices(self.machine.system, self.contact)

    def _harmonics(self, limit: float) -> list[tuple[float, tuple[tuple[int, int], ...]]]:
        """Frequencies of the mesh harmonics up to a limit [rad/s], ascending, and the meshes that drive each."""
        harmonics: list[tuple[float, tuple[tuple[int, int], ...]]] = []
        every = [
            (2.0 * np.pi * h * abs(self.machine.system.contacts[n].mesh_frequency), (n, h))
            for n in self.loaded
            for h in range(1, HARMONICS + 1)
        ]
        for w, cause in sorted(every):
            if w > limit * (1.0 + _SAME_FREQUENCY_DIFFERENCE):
                break
            if harmonics and w <= harmonics[-1][0] * (1.0 + _SAME_FREQUENCY_DIFFERENCE):
                harmonics[-1] = (harmonics[-1][0], (*harmonics[-1][1], cause))
            else:
                harmonics.append((w, (cause,)))
        return harmonics

    def _load(self, causes: tuple[tuple[int, int], ...]) -> ComplexArray:
        """Return f by the meshes alone, shape (n,): torque ripple of a mesh's frequency has no part in it."""
        return self._error_load(causes) + self._shuttling_load(causes)

    def _error_load(self, causes: tuple[tuple[int, int], ...]) -> ComplexArray:
        """Return Σ k e d, shape (n,)."""
        system = self.machine.system
        total = np.zeros(system.size, dtype=np.complex128)
        for number, harmonic in causes:
            direction = system.contacts[number].direction
            total += self.contact.stiffness[number] * self._errors[number][harmonic - 1] * direction
        return total

    def _shuttling_load(self, causes: tuple[tuple[int, int], ...]) -> ComplexArray:
        """Return the moments of load shuttling, shape (n,)."""
        total = np.zeros(self.machine.system.size, dtype=np.complex128)
        for number, harmonic in causes:
            if harmonic in self._shuttling[number]:
                total += self._shuttling[number][harmonic]
        return total

    @cached_property
    def _errors(self) -> dict[int, ComplexArray]:
        """Return e of every loaded contact by harmonic."""
        contacts = self.machine.system.contacts
        return {n: self._error(n, self._mesh(n, contacts[n].contact)) for n in self.loaded}

    @cached_property
    def _shuttling(self) -> dict[int, dict[int, ComplexArray]]:
        """Return the moments of every loaded contact by harmonic."""
        assert self.contact.force is not None
        contacts, force = self.machine.system.contacts, self.contact.force
        return {n: self.shuttling_loads(n, contacts[n].contact, float(force[n])) for n in self.loaded}

    def _mesh(self, number: int, law: ToothContact, points: int = _POINTS) -> LoadedMesh:
        """Mesh of the contact law ``law`` under the mean force of a contact."""
        assert self.contact.force is not None
        force = float(self.contact.force[number])
        if law.hunting_period > 1:
            return hunting_period_mesh(law, force)
        return loaded_transmission_error(law, force, mesh_period_phases(law, points))

    def _error(self, number: int, mesh: LoadedMesh) -> ComplexArray:
        """Harmonics of the transmission error of a contact at t = 0 [m], shape (harmonics,)."""
        period = self.machine.system.contacts[number].contact.hunting_period
        return self.transmission_error(number, mesh, hunting_period=period)
