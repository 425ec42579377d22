r"""Swing of flanks over a turn of the carriers: mesh excitation that changes with the angle of the carrier.

What stands still, such as a force or a housing that is not alike all round, changes the load and the gap over the face
of a planet's mesh as its carrier turns, slowly beside the mesh frequency Ω. At an angle θ = f t of the carrier the mesh
has the force F(θ) and the slope of its flanks there, and about that state a transmission error e(p, θ) under load, a
stiffness κ(p, θ) and moments of its load (:mod:`gearwhine.coupling.machine.load_shuttling`). They are periodic in the
phase p and in θ,

    e = Σ_{n,m} e_{n,m} e^{i(nΩ + m·f)t},

and so are κ and the moments: a mesh excites sidebands by itself, even where all that stands still is alike all round.
What flanks yield in the mean at each angle, n = 0, is that of the equilibrium over a turn. e and κ are those under the
mean force on each gap, as what F(θ) changes in e is by κ; the moments and the friction have F(θ). The linear law of
tilting has the mean stiffness over the phase; what the change of it with the phase makes of the slope at θ is in e and
in the moments here. Against a set of rigid bodies with helical or spur faces that is integrated as it stands, lines at
mesh harmonics and their sidebands are within 5 % where faces carry all over, and within a tenth where the stiffness
swings by a fifth.
"""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from gearwhine.coupling.gears import ToothContact, loaded_transmission_error
from gearwhine.coupling.gears.loaded.transmission_error import (
    mesh_period_phases,
    polygon_phasors,
    transmission_error_phasors,
)
from gearwhine.coupling.machine.connectors import ContactConnector, TurningPart
from gearwhine.coupling.machine.coupled_system import CoupledSystem, HarmonicLoad
from gearwhine.coupling.machine.mesh_face import MeshFace
from gearwhine.coupling.machine.tooth_friction import alike_teeth
from gearwhine.coupling.statics.mean_mesh import MeanMesh, equilibrium_over_turn
from gearwhine.numerics.arrays import ComplexArray, FloatArray

_POINTS = 200  # number of phases of a mesh period, as in the mean mesh
_HARMONICS = 6  # largest number of mesh harmonics, as of load shuttling
_TURNS = 3  # turns of carriers, all together, that the swing over a turn is known of


def turn_waves(system: CoupledSystem) -> dict[float, ComplexArray]:
    """Weights of `CoupledSystem.turn_times` whose sums are the amplitudes of e^{iwt}, (t,), by w = m·f [rad/s]."""
    times, rates = system.turn_times, system.base_rates
    turns = itertools.product(range(-_TURNS, _TURNS + 1), repeat=len(rates))
    shifts = [float(np.dot(some, rates)) for some in turns if sum(map(abs, some)) <= _TURNS]
    return {shift: np.exp(-1j * shift * times) / times.size for shift in shifts}


LawsOverTurn = Mapping[int, Sequence[tuple[ToothContact, float]]]
"""Law of teeth alike and force [N] at each angle of a turn, by the number of the contact."""


def swinging_laws(
    system: CoupledSystem, rest: tuple[Sequence[MeanMesh | None], FloatArray] | None = None
) -> LawsOverTurn:
    """Laws of teeth alike and forces of the contacts whose gap over the face changes over a turn of the carriers.

    Left out are contacts whose flanks part at an angle: their mean law stands.

    Parameters
    ----------
    system : CoupledSystem
    rest : tuple, optional
        That of `gearwhine.coupling.statics.mean_mesh.equilibrium_over_turn`, if it is known.
    """
    angles = len(system.turn_times)
    laws = [contact.contact for contact in system.contacts]
    swinging = [
        number
        for number, law in enumerate(laws)
        if angles > 1 and law.faces is not None and len(law.faces.changes) == angles
    ]
    found = dict[int, list[tuple[ToothContact, float]]]()
    for number, forces in forces_over_turn(system, rest).items() if swinging else ():
        faces = laws[number].faces
        if number in swinging and faces is not None and np.all(forces > 0.0):
            gaps = [replace(faces, gap=faces.gap + change, changes=np.zeros((1, 1))) for change in faces.changes]
            found[number] = [
                (replace(laws[number].teeth_alike, faces=gap), force)
                for gap, force in zip(gaps, forces.tolist(), strict=True)
            ]
    return found


def forces_over_turn(
    system: CoupledSystem, rest: tuple[Sequence[MeanMesh | None], FloatArray] | None = None
) -> dict[int, FloatArray]:
    """Force of each contact at rest, at each of `CoupledSystem.turn_times` [N], shape (t,), by the slope of its curve.

    It is 0 at angles where the flanks are parted. Left out are contacts without a mean force. ``rest`` is as of
    `swinging_laws`.
    """
    means, motions = equilibrium_over_turn(system) if rest is None else rest
    moved = np.array([q @ at.contact_directions for q, at in zip(motions, system.over_turn, strict=True)])
    return {
        number: np.maximum(mean.force + mean.secant * (moved[:, number] - contact.clearance - mean.deflection), 0.0)
        for number, (contact, mean) in enumerate(zip(system.contacts, means, strict=True))
        if mean is not None and mean.force > 0.0
    }


def swinging_errors(
    contact: ContactConnector,
    mean: MeanMesh,
    laws: Sequence[tuple[ToothContact, float]],
    waves: Mapping[float, ComplexArray],
) -> list[HarmonicLoad]:
    """Return the loads k e_{n,m}, m not 0, of a contact whose flanks swing.

    e is that under the mean force on the gaps of a turn: in motion the law has what the load's swing changes.

    Parameters
    ----------
    contact : ContactConnector
        With the parts of its direction that turn.
    mean : MeanMesh
    laws, waves
        As of `swinging_shuttling`.
    """
    orders = np.arange(1, _HARMONICS + 1)
    meshes = [loaded_transmission_error(law, mean.force, mesh_period_phases(law, _POINTS)) for law, _ in laws]
    errors = np.array([transmission_error_phasors(mesh, _HARMONICS, 1) for mesh in meshes])
    by_shift = {
        shift: mean.stiffness * (wave @ contact.at_time_zero(errors, orders))[None]
        for shift, wave in waves.items()
        if shift != 0.0
    }
    directions = _by_rate(contact.direction[:, None], contact.turning)
    return _loads(contact, by_shift, directions, "transmission_error")


def swinging_friction(
    contact: ContactConnector, laws: Sequence[tuple[ToothContact, float]], waves: Mapping[float, ComplexArray]
) -> list[HarmonicLoad]:
    """Return the loads by friction on the gaps of a turn beside that on the mean gap, which is in the contact law.

    Both are under the force F(θ). There are none without friction.

    Parameters
    ----------
    contact : ContactConnector
        With the mean law, and the parts of its directions that turn.
    laws, waves
        As of `swinging_shuttling`.
    """
    if contact.sliding is None:
        return []
    orders = np.arange(1, _HARMONICS + 1)

    def phasors(on_gap: ContactConnector, force: float) -> ComplexArray:
        mesh, friction = alike_teeth(on_gap, force)
        assert friction is not None
        return contact.at_time_zero(polygon_phasors(mesh.phases, friction, orders), orders)

    beside = np.array([phasors(contact.with_law(law), force) - phasors(contact, force) for law, force in laws])
    by_shift = {shift: -np.tensordot(wave, beside, 1) for shift, wave in waves.items()}
    directions = _by_rate(contact.sliding.directions, contact.sliding.turning)
    return _loads(contact, by_shift, directions, "friction")


def _by_rate(directions: FloatArray, turning: Sequence[TurningPart]) -> list[tuple[float, ComplexArray]]:
    """Directions (n, d) as sums of such that turn by e^{iwt}, each with its w [rad/s]."""
    stands = directions - sum((part.cosine for part in turning), np.zeros_like(directions))
    found: list[tuple[float, ComplexArray]] = [(0.0, stands.astype(np.complex128))]
    for part in turning:
        found += [(turn * part.rate, np.asarray(0.5 * (part.cosine - 1j * turn * part.sine))) for turn in (1.0, -1.0)]
    return found


def _loads(
    contact: ContactConnector,
    by_shift: Mapping[float, ComplexArray],
    directions: Sequence[tuple[float, ComplexArray]],
    mechanism: Literal["transmission_error", "friction"],
) -> list[HarmonicLoad]:
    """Make loads along directions (n, d) by amplitudes (d, h) at h mesh harmonics, of each shift by the carriers."""
    rate = 2.0 * np.pi * abs(contact.mesh_frequency)
    return [
        HarmonicLoad(harmonic * rate + shift + turning, direction @ amplitude, "turning", mechanism)
        for shift, amplitudes in by_shift.items()
        for harmonic, amplitude in enumerate(amplitudes.T, 1)
        for turning, direction in directions
    ]


def swinging_shuttling(
    face: MeshFace,
    contact: ContactConnector,
    laws: Sequence[tuple[ToothContact, float]],
    waves: Mapping[float, ComplexArray],
) -> list[HarmonicLoad]:
    """Moments of load shuttling at mesh harmonics and their sidebands, of a contact whose flanks swing.

    Of teeth that differ those at mesh harmonics are of the mean law, which has their differences.

    Parameters
    ----------
    face : MeshFace
        With the mean law.
    contact : ContactConnector
    laws : sequence of (ToothContact, float)
        See `LawsOverTurn`.
    waves : mapping of float to ndarray of complex, shape (t,)
        See `turn_waves`.
    """
    by_angle = [
        {
            one.frequency: one
            for one in replace(face, contact=law).shuttling(force, contact.phase, contact.mesh_frequency)[1]
        }
        for law, force in laws
    ]
    loads, differ = list[HarmonicLoad](), face.contact.hunting_period > 1
    if differ:
        mean = float(np.mean([force for _, force in laws]))
        loads += face.shuttling(mean, contact.phase, contact.mesh_frequency)[1]
    for frequency, load in sorted({w: load for loads in by_angle for w, load in loads.items()}.items()):
        nothing = np.zeros_like(load.amplitude)
        amplitudes = np.array([one[frequency].amplitude if frequency in one else nothing for one in by_angle])
        loads += [
            replace(load, frequency=frequency + shift, amplitude=wave @ amplitudes)
            for shift, wave in waves.items()
            if shift != 0.0 or not differ
        ]
    return loads
