r"""Level at a sensor by the flanks of one gear pair: aim of a tip relief.

About the mean load the motion at the n-th harmonic of a mesh is that of
:mod:`gearwhine.coupling.linear.mesh_harmonics`,

    Z q = f_n,      f_n = (k e_n - g_n) d + m_n,

e_n the transmission error, g_n the force by the stiffness that varies and m_n the moments of load shuttling of its
flanks. Other flanks have other e_n, m_n and
another law L over the mean approach of the face, its slope and the tilt, the rows Y of shape (3, n)
(:mod:`gearwhine.coupling.machine.mesh_face`), and with L another Z: of one contact, the update of rank three
Z + Yᵀ ΔL Y, whose inverse is that of Woodbury,

    sᵀ q = p·f - (p Yᵀ) ΔL (I + U Yᵀ ΔL)⁻¹ U f,      Zᵀ p = s,      Zᵀ Uᵀ = Yᵀ,

s the sensor. So Z is factored once for each harmonic, and a candidate takes no solution of the machine. With a damping
ratio c follows √k. The operating point stays: mean force, tangents of bearings and the gap over the face. The stiffness
of other meshes is the mean one, and friction is left out.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import linalg

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears import LoadedMesh, ToothContact
from gearwhine.coupling.gears.contact.contact_law import law_between_rims
from gearwhine.coupling.gears.loaded.transmission_error import loaded_transmission_error
from gearwhine.coupling.linear.carriers.frozen_directions import frozen_warnings
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel
from gearwhine.coupling.linear.parametric_stiffness import LEAST_REACH, harmonic_compressions, varying_mesh
from gearwhine.coupling.machine.mesh_face import MeshFace
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.result_warnings import ResultWarning


@dataclass(frozen=True, eq=False)
class SensorLevel:
    """Aim at the root mean square of a sensor's acceleration over harmonics of a mesh, √(½ Σ (w_n a_n)²) [m/s²].

    Attributes
    ----------
    model : MeshHarmonicModel
        Model of the machine, with any flanks.
    mesh : int
        Number of the gear mesh.
    sensor : str
    weights : mapping of int to float
        Weight w_n by harmonic n from 1.
    damping_follows : bool
        Whether the mesh damping is by a damping ratio, so that it follows the mesh stiffness.

    Raises
    ------
    CouplingError
        Where the machine has no such sensor, or the mesh carries no mean force or does not turn.
    """

    model: MeshHarmonicModel
    mesh: int
    sensor: str
    weights: Mapping[int, float]
    damping_follows: bool = True

    def __post_init__(self) -> None:
        """Check that the mesh drives the sensor."""
        machine = self.model.machine
        if self.sensor not in machine.sensor_rows:
            raise CouplingError(f"no sensor {self.sensor!r}; there are: {', '.join(machine.sensor_rows) or 'none'}")
        if not self._loaded:
            raise CouplingError(
                f"gear mesh number {self.mesh} carries no mean force or does not turn; expected one that drives sensors"
            )

    @property
    def warnings(self) -> tuple[ResultWarning, ...]:
        """Warnings: that the level is that of frozen carriers."""
        return frozen_warnings(self.model.machine.system, "levels at sensors, at which reliefs of tips aim,")

    def of(self, mesh: LoadedMesh, contact: ToothContact) -> float:
        """Level with the flanks of ``contact``, those that carry, all teeth alike [m/s²]."""
        total = sum((self.weights[n] * abs(a)) ** 2 for n, a in self.accelerations(mesh, contact).items())
        return math.sqrt(0.5 * total)

    def accelerations(self, mesh: LoadedMesh, contact: ToothContact) -> dict[int, complex]:
        """Complex amplitudes of the sensor's acceleration by the harmonic [m/s²], with the flanks of ``contact``.

        Parameters
        ----------
        mesh : LoadedMesh
            Loaded mesh of the flanks that carry over one mesh period.
        contact : ToothContact
            Contact law of these flanks by their own phase, see
            :attr:`gearwhine.coupling.gears.loaded.gear_pair.LoadedGearPair.carrying_flanks`.
        """
        model, number, force = self.model, self._loaded[0], mesh.force
        # The machine has the rims on their hubs beside its contacts.
        behind = model.machine.meshes[self.mesh].behind_rims
        stiffness, contact = mesh.mean_stiffness_without(behind), law_between_rims(contact, behind)
        orders = range(1, max(self._adjoints) + 1)
        error = model.transmission_error(number, mesh, hunting_period=1, count=len(orders))
        face = self._face(contact)
        shuttling = model.shuttling_loads(number, face, force)
        before, damping = float(model.contact.stiffness[number]), float(model.contact.damping[number])
        after = damping * math.sqrt(stiffness / before) if self.damping_follows else damping
        law, law_before = face.law(force, stiffness), self._law
        # Motions of the sensor and along the mesh by its excitation and by a unit force along it.
        at_sensor = np.empty((len(orders), 2), dtype=np.complex128)
        along = np.empty((len(orders), 2), dtype=np.complex128)
        leading = law[0] / stiffness  # the line of action over mean approach, slope and tilt
        for n, (w, by_sensor, by_rows) in self._adjoints.items():
            load = error[n - 1] * law[0] @ self._rows
            if n in shuttling:
                load = load + shuttling[n]
            loads = np.array([load, leading @ self._rows]).T
            change = (1.0 + 1j * w * after / stiffness) * law - (1.0 + 1j * w * damping / before) * law_before
            resisted = np.linalg.solve(np.eye(3) + (by_rows @ self._rows.T) @ change, by_rows @ loads)
            at_sensor[n - 1] = by_sensor @ loads - (by_sensor @ self._rows.T) @ change @ resisted
            along[n - 1] = leading @ resisted
        moved = at_sensor[:, 0]
        if model.stiffness_varies:
            forces = self._stiffness_forces(mesh, contact, stiffness, along[:LEAST_REACH])
            moved[:LEAST_REACH] += at_sensor[:LEAST_REACH, 1] * forces
        return {n: complex(-(self._adjoints[n][0] ** 2) * moved[n - 1]) for n in self.weights}

    def _stiffness_forces(
        self, mesh: LoadedMesh, contact: ToothContact, stiffness: float, along: ComplexArray
    ) -> ComplexArray:
        """Force -g by the stiffness of other flanks that varies, at the harmonics [N].

        Parameters
        ----------
        mesh : LoadedMesh
        contact : ToothContact
            Contact law between the rims.
        stiffness : float
            Mean mesh stiffness of this law [N/m].
        along : ndarray of complex, shape (J, 2)
            Motion along the mesh by its excitation [m], and by a unit force along it [m/N], at the harmonics.
        """
        standing = replace(
            self.model.machine.system.contacts[self._loaded[0]], contact=contact, errors=np.empty((0, 3))
        )
        if self.model.machine.meshes[self.mesh].behind_rims != 0.0:
            mesh = loaded_transmission_error(contact, mesh.force, mesh.phases)
        varying = varying_mesh(self._loaded[0], standing, stiffness, mesh, 0.0)
        receptance = np.concatenate([along[::-1, 1].conj(), [1.0 / stiffness], along[:, 1]])
        moved = 0.5 * np.concatenate([along[::-1, 0].conj(), [0.0], along[:, 0]])
        pressed = harmonic_compressions([varying], [moved - varying.error[0]], [[receptance]])[0]
        return np.asarray(-2.0 * (varying.coupling[0] @ pressed)[varying.reach + 1 :])

    def _face(self, contact: ToothContact) -> MeshFace:
        """Face of the flanks with another contact: its rows are found once for each division into slices."""
        division = b"" if contact.faces is None else contact.faces.z.tobytes()
        if division not in self._faces:
            self._faces[division] = self.model.machine.face(self._loaded[0], contact)
        return self._faces[division].with_contact(contact)

    @cached_property
    def _faces(self) -> dict[bytes, MeshFace]:
        return {}

    @cached_property
    def _own_face(self) -> MeshFace:
        """Face of the flanks in the model."""
        return self._face(self.model.machine.system.contacts[self._loaded[0]].contact)

    @cached_property
    def _rows(self) -> FloatArray:
        """Mean approach over the face of the mesh, its slope and the tilt by the coordinates, shape (3, n)."""
        return self._own_face.rows

    @cached_property
    def _law(self) -> FloatArray:
        """Linear law of the mesh in the model over `_rows`, (3, 3)."""
        number, contact = self._loaded[0], self.model.contact
        assert contact.force is not None
        return self._own_face.law(float(contact.force[number]), float(contact.stiffness[number]))

    @cached_property
    def _loaded(self) -> tuple[int, ...]:
        """Contacts of the mesh that carry a mean force: its drive flanks or its back flanks."""
        return tuple(number for number in self.model.loaded if self.model.machine.flanks(number)[0] == self.mesh)

    @cached_property
    def _adjoints(self) -> dict[int, tuple[float, ComplexArray, ComplexArray]]:
        """Frequency ω [rad/s] and solutions p, shape (n,), and U, shape (3, n), by harmonic."""
        machine, contact = self.model.machine, self.model.machine.system.contacts[self._loaded[0]]
        loads = np.vstack([machine.sensor_rows[self.sensor], self._rows]).T
        adjoints = {}
        for n in range(1, max(LEAST_REACH, *self.weights) + 1) if self.model.stiffness_varies else self.weights:
            w = 2.0 * np.pi * n * abs(contact.mesh_frequency)
            by_sensor, *by_rows = linalg.solve(self.model.dynamic_stiffness(w).T, loads).T
            adjoints[n] = (w, by_sensor, np.array(by_rows))
        return adjoints
