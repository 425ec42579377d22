r"""Parametric stiffness: lines of meshes whose stiffness changes with their phase, and with the pitch of each tooth.

About its loaded transmission error e(p), at the phase p under the mean force F̄, a mesh that is pressed by u more has
the force F̄ + κ(p) u. A machine with the mean mesh stiffness k̄ in place of κ moves as by the further load −g d,

    g = (κ − k̄) u,      u = dᵀq − e.

With G(ω) = dᵀ Z(ω)⁻¹ d of the machine with k̄, L the load on the mesh and n the orders of its frequency Ω_z,

    u_n = G(nΩ_z) (L_n − g_n) − e_n,      g_n = Σ_m κ_{n−m} u_m,      κ_0 less k̄.

The orders couple in sets ρ + j, j whole: the mesh harmonics, ρ = 0, by the change of stiffness from one pair to two;
those of the hunting period of H meshes, ρ = k/H, likewise, and by what the pitch of single teeth changes in κ, which
acts on the vibration u of the mesh harmonics; and those of runout, at the turns of a gear. This is Hill's method for a
linear machine with periodic coefficients (Nayfeh and Mook, Nonlinear Oscillations, 1979, chapter 5), with pitch
deviations to first order. κ is the secant over a tenth of the mean force,

    κ(p) = 0.2 F̄ / (e(p; 1.1 F̄) − e(p; 0.9 F̄)),

which changes smoothly where a pitch deviation lets a pair meet a little earlier: the tangent jumps there. Over the
thousands of mesh periods of unequal teeth the table of the law, by which motions are integrated, takes a tenth of the
time of equilibria. There κ is the secant over a tenth of the mean compression; both agree where teeth hardly differ.

Left out: that flanks part, the torques at rest that follow from the mean of g (as of a free train, which has none), and
how meshes of different frequencies change one another's lines.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears.loaded.transmission_error import (
    HuntingCurve,
    LoadedMesh,
    loaded_transmission_error,
    period_mean,
)
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.numerics.arrays import ComplexArray, FloatArray

Cause = tuple[int, int]
"""Number of a contact in the system, and harmonic of its mesh frequency."""

_FURTHER = 3  # orders beyond the limit whose coupling counts
LEAST_REACH = 30
"""Number of harmonics at least: a mesh vibrates on its stiffness far above the modes of a housing.

Far below that resonance the twelve lines that are told are then within some 1e-3 of those with all orders.
"""
_SECANT = 0.1  # part of the mean force, or compression, over which the stiffness is taken
_WHOLE = 1e-9  # distance from a whole order below which a line is a mesh harmonic


@dataclass(frozen=True, eq=False)
class VaryingMesh:
    """A mesh with its stiffness and transmission error by orders of its frequency.

    Amplitudes x_n are two-sided: x(t) = Σ x_n e^{i n Ω_z t}.

    Attributes
    ----------
    number : int
        Number of the contact in the system.
    rate : float
        Mesh frequency Ω_z at nominal speed [rad/s], above 0 in either sense.
    fractions : ndarray, shape (r,)
        ρ of each set of orders, in [0, 1/2]; the first is 0.
    error : ndarray of complex, shape (r, 2 J + 1)
        e at the orders ρ - J ... ρ + J [m].
    stiffness : ndarray of complex, shape (r, 4 J + 1)
        κ less its mean k̄ at the orders ρ - 2 J ... ρ + 2 J [N/m].
    damped : ndarray of bool, shape (r,)
        Whether the damping of the mesh passes the error on, too, as that of runout.
    """

    number: int
    rate: float
    fractions: FloatArray
    error: ComplexArray
    stiffness: ComplexArray
    damped: npt.NDArray[np.bool_]

    @property
    def reach(self) -> int:
        """J."""
        return int(self.error.shape[1] // 2)

    @property
    def orders(self) -> FloatArray:
        """Orders n of the mesh frequency, shape (r, 2 J + 1)."""
        return np.asarray(self.fractions[:, None] + np.arange(-self.reach, self.reach + 1))

    @property
    def one_sided(self) -> npt.NDArray[np.bool_]:
        """Orders that hold each line once: at 0 and at half a mesh frequency a set has the conjugates, too."""
        return np.asarray((self.orders > 0.0) | ((self.fractions % 0.5 != 0.0)[:, None] & (self.orders < 0.0)))

    @property
    def coupling(self) -> ComplexArray:
        """κ_{n-m} from a mesh harmonic m to an order n, shape (r, 2 J + 1, 2 J + 1)."""
        return coupled(self.stiffness)

    def loads(self, stiffness: float, damping: float, ratio: float) -> ComplexArray:
        """Load (k̄ + i ω c) e at the part ``ratio`` of the nominal speed [N], shape (r, 2 J + 1)."""
        passed = np.where(self.damped[:, None], 1j * ratio * self.rate * self.orders * damping, 0.0)
        return np.asarray((stiffness + passed) * self.error)

    def up_to(self, limit: float, ratio: float) -> "VaryingMesh":
        """Return the mesh with the orders that count up to a limit [rad/s] at the part ``ratio`` of the speed."""
        less = self.reach - _reach(limit, ratio * self.rate)
        if less <= 0:
            return self
        stiffness = self.stiffness[:, 2 * less : -2 * less]
        return replace(self, error=self.error[:, less:-less], stiffness=stiffness)

    def forces(self, compression: ComplexArray, loads: ComplexArray, receptance: ComplexArray) -> ComplexArray:
        """Return the force -g at the orders [N], shape (r, 2 J + 1).

        Parameters
        ----------
        compression : ndarray of complex, shape (2 J + 1,)
            u of the mesh harmonics [m].
        loads : ndarray of complex, shape (r, 2 J + 1)
            As of `loads`.
        receptance : ndarray of complex, shape (r, 2 J + 1)
            G at the orders [m/N].
        """
        by_harmonics = self.coupling @ compression
        own, between = self.coupling[0], receptance[1:]
        moved = between * (loads[1:] - by_harmonics[1:]) - self.error[1:]
        further = np.linalg.solve(np.eye(len(own)) + between[:, :, None] * own, moved[:, :, None])[:, :, 0]
        return -np.concatenate([by_harmonics[:1], by_harmonics[1:] + further @ own.T])


def coupled(stiffness: ComplexArray) -> ComplexArray:
    """κ_{n-m} between orders, shape (..., 2 J + 1, 2 J + 1), of κ at the orders -2 J ... 2 J, shape (..., 4 J + 1)."""
    reach = (stiffness.shape[-1] - 1) // 4
    places = np.arange(2 * reach + 1)
    return np.asarray(stiffness[..., places[:, None] - places + 2 * reach])


def _reach(limit: float, rate: float) -> int:
    return max(int(np.ceil(limit / rate - _WHOLE)) + _FURTHER, LEAST_REACH)


def varying_mesh(
    number: int, contact: ContactConnector, mean: float, mesh: LoadedMesh, limit: float = 0.0, *, between: bool = True
) -> VaryingMesh:
    """Return a loaded mesh with the orders that count up to a limit.

    Parameters
    ----------
    number : int
        Number of the contact in the system.
    contact : ContactConnector
    mean : float
        Its mean mesh stiffness k̄ [N/m].
    mesh : LoadedMesh
        The mesh under its mean force over the mesh periods that differ.
    limit : float
        Highest frequency at nominal speed [rad/s].
    between : bool
        Whether the sets between the mesh harmonics are wanted.
    """
    rate, periods = 2.0 * np.pi * abs(contact.mesh_frequency), contact.contact.hunting_period
    reach = _reach(limit, rate)
    secant = _secant(contact.contact, mesh)
    count = (2 * reach + 1) * periods
    whole = np.arange(periods // 2 + 1 if between else 1)

    def two_sided(values: FloatArray, widest: int) -> ComplexArray:
        """Amplitudes at the orders k/H + j, j up to ``widest`` on either side, without the mean."""
        orders = np.arange(1, count + 1) if between else periods * np.arange(1, 2 * reach + 1)
        found = HuntingCurve.through(mesh.phases, values, periods).amplitudes(orders)
        found = 0.5 * found * np.exp(2j * np.pi * contact.phase / periods * orders)
        found = np.concatenate([[0.0], found if contact.mesh_frequency > 0.0 else found.conj()])
        at = whole[:, None] + (periods if between else 1) * np.arange(-widest, widest + 1)
        return np.asarray(np.where(at < 0, found[np.abs(at)].conj(), found[np.abs(at)]))

    error, stiffness = two_sided(mesh.transmission_error, reach), two_sided(secant, 2 * reach)
    stiffness[0, 2 * reach] = period_mean(mesh.phases, secant) - mean
    runout = list(_runout(contact.errors, rate, reach)) if between else []
    return VaryingMesh(
        number,
        rate,
        np.concatenate([whole / periods, [fraction for fraction, _ in runout]]),
        np.vstack([error, *(row for _, row in runout)]),
        np.vstack([stiffness, np.zeros((len(runout), stiffness.shape[1]))]),
        np.arange(len(whole) + len(runout)) >= len(whole),
    )


def _secant(law: ToothContact, mesh: LoadedMesh) -> FloatArray:
    """Stiffness k̄ + κ at the phases of a mesh [N/m]."""
    if law.hunting_period == 1:
        states = law.pairs(mesh.phases)
        pressed, eased = (
            loaded_transmission_error(law, part * mesh.force, mesh.phases, states=states).transmission_error
            for part in (1.0 + _SECANT, 1.0 - _SECANT)
        )
        return np.asarray(2.0 * _SECANT * mesh.force / (pressed - eased))
    from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force_history

    phases = np.array(mesh.phases)  # a kernel is compiled once more for an array that must not change
    still, away = np.zeros(phases.size), _SECANT * mesh.force / mesh.mean_mesh_stiffness
    more, less = (
        tooth_force_history(phases, mesh.transmission_error + by, still, *law.kernel_arguments)[:, 0]
        for by in (away, -away)
    )
    return np.asarray((more - less) / (2.0 * away))


def _runout(rows: FloatArray, rate: float, reach: int) -> Iterator[tuple[float, ComplexArray]]:
    """Fraction ρ of each runout's order, and its error at the orders ρ + j."""
    for amplitude, frequency, angle in rows[(rows[:, 0] != 0.0) & (rows[:, 1] != 0.0)].tolist():
        order, value = abs(frequency) / rate, 0.5 * amplitude * np.exp(1j * np.sign(frequency) * angle)
        if order % 1.0 > 0.5:
            order, value = -order, np.conj(value)
        place = int(np.floor(order + _WHOLE))
        error = np.zeros(2 * reach + 1, dtype=np.complex128)
        if abs(place) <= reach:
            error[place + reach] = value
            yield order - place, error


def harmonic_compressions(
    meshes: Sequence[VaryingMesh], compression: Sequence[ComplexArray], receptance: Sequence[Sequence[ComplexArray]]
) -> list[ComplexArray]:
    """Compressions u of meshes of one frequency at its harmonics with varying stiffness [m], shape (2 J + 1,) each.

    Parameters
    ----------
    meshes : sequence of VaryingMesh
    compression : sequence of ndarray of complex, shape (2 J + 1,)
        dᵀq - e of each in the machine with mean stiffness [m].
    receptance : sequence of sequence of ndarray of complex, shape (2 J + 1,)
        dᵀ Z⁻¹ d' of mesh and other mesh at the harmonics [m/N].
    """
    size = 2 * meshes[0].reach + 1
    matrix = np.eye(len(meshes) * size, dtype=np.complex128)
    for row, of_row in enumerate(receptance):
        for column, mesh in enumerate(meshes):
            block = slice(row * size, (row + 1) * size), slice(column * size, (column + 1) * size)
            matrix[block] += of_row[column][:, None] * mesh.coupling[0]
    return np.split(np.linalg.solve(matrix, np.concatenate(compression)), len(meshes))
