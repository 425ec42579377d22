"""Names of spectral lines by their causes: mesh harmonic, shaft order, load, rolling elements, sideband, free motion.

A line at an excitation frequency of the machine is named after its cause, the simplest one first: a mesh harmonic, a
low order of a shaft, a harmonic torque or motion of the base, the passing of the elements of a rolling bearing whose
law follows them, a sideband, any other whole order, a sum or difference of harmonics of two meshes, by which the motion
in one mesh modulates the force of the other. One that is much nearer to the line goes before a simpler one; causes that
are about as near and as simple are named together. Sidebands by the turning of planet carriers are those that the
machine forces (:func:`gearwhine.coupling.linear.carriers.carrier_sidebands.forced_sidebands`), and those of the mean
load are orders of the carrier. Orders of a shaft and their sidebands count where something excites them
(:func:`gearwhine.coupling.linear.excitation_orders.excited_shaft_orders`), and where no mode is nearer to the line. A
line at none of these is free vibration, named after its mode. Either may be near a mode, which is given apart from the
cause. A line that is near no mode either, whole turns of a carrier off a harmonic of its planets' meshes, is one of
their far sidebands, which parts that hand a motion on to each other leave.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.linear.carriers.carrier_sidebands import forced_sidebands
from gearwhine.coupling.linear.complex_modes import CoupledModes
from gearwhine.coupling.linear.excitation_orders import (
    ExcitedOrders,
    excitation_lines,
    excited_shaft_orders,
    joined_causes,
    rotations,
)
from gearwhine.coupling.machine.driving_frequencies import spall_strikes

LineKind = Literal["mean", "mesh", "shaft", "load", "bearing", "sideband", "mode", "other"]

_SHAFT_ORDERS = 4  # highest shaft order that takes precedence over a sideband of the same frequency
_SIDEBANDS = 4  # by gears and loads; those by turning carriers are as many as the machine has
_ELEMENT_PASSES = 4
_LOAD_MULTIPLES = 4
_COMBINED_HARMONICS = 7  # highest sum of the harmonics of two meshes in a combination
_HALF_WIDTHS = 3.0  # reach of a line that slip makes wide: four fifths of its power
_MUCH_NEARER = 0.25  # part of the distance from a cause within which another one is the cause
_SAME_FREQUENCY = 1e-9  # relative difference of frequencies that are one
_NONE = np.zeros(0, dtype=np.int64)
_HALF_POWER_WIDTHS = 2.0  # distance within which a line is near a mode


@dataclass(frozen=True)
class LineName:
    """Name and cause of a spectral line.

    Attributes
    ----------
    kind : str
        ``mean``, ``mesh``, ``shaft``, ``load``, ``bearing``, ``sideband``, ``mode`` for free vibration, or ``other``.
    name : str
        Name such as ``1× pinion -> wheel``; coinciding causes are joined by commas, but for the meshes of all planets
        on a carrier, ``1× planets' meshes``.
    order : float
        Cycles per revolution of the leading shaft.
    mode : int or None
        Number of the nearest coupled mode, where the line lies within two half-power widths of it.
    """

    kind: LineKind
    name: str
    order: float
    mode: int | None


def line_names(
    machine: CoupledMachine,
    frequencies: Sequence[float],
    tolerance: float | npt.NDArray[np.float64],
    modes: CoupledModes | None = None,
    *,
    near: float = 0.0,
) -> list[LineName]:
    """Names of spectral lines of a machine at its nominal speeds.

    Parameters
    ----------
    machine : CoupledMachine
    frequencies : sequence of float
        Frequencies [Hz].
    tolerance : float or ndarray, shape (l,)
        Largest distance of a line from the frequency of its cause [Hz]: what its own frequency is known within, a small
        part of the spacing where the record holds whole periods or the line is one tone, half of it otherwise.
    modes : CoupledModes, optional
        About the mean contact.
    near : float
        Distance within which a line is near a mode however little that is damped [Hz], where it is more than the
        tolerance: a free vibration that dies away is no sharp line.

    Raises
    ------
    CouplingError
        For a machine that stands still, or a tolerance that is not positive.
    """
    tolerances = np.broadcast_to(np.asarray(tolerance, dtype=np.float64), (len(frequencies),))
    if not np.all(np.asarray(tolerance) > 0.0):
        raise CouplingError(f"names of lines within {tolerance} Hz; expected more than 0")
    shaft_frequency = abs(machine.speed) / (2.0 * np.pi)
    highest = max(frequencies, default=0.0)
    meshes = [
        abs(contact.mesh_frequency) for contact in machine.system.contacts if contact.loaded and contact.mesh_frequency
    ]
    excited, by_carriers = excited_shaft_orders(machine), forced_sidebands(machine) or None
    # A sideband below the highest line may belong to a harmonic above it.
    off = [sum(number * abs(machine.speeds[carrier]) for carrier, number in one.turns) for one in by_carriers or ()]
    highest += max(map(abs, off), default=0.0) / (2.0 * np.pi)
    # The strikes of a spall are short, with harmonics as far as a record reaches.
    strikes = [one.frequency for one in spall_strikes(machine.system)]
    passes = max([_ELEMENT_PASSES, *(1 + int(highest / frequency) for frequency in strikes)])
    lines = excitation_lines(
        machine,
        shaft_orders=range(1, _SHAFT_ORDERS + 1),
        mesh_harmonics=range(1, 2 + int(highest / min(meshes))) if meshes else (),
        sidebands=_SIDEBANDS,
        element_passes=range(1, passes + 1),
        load_multiples=range(1, _LOAD_MULTIPLES + 1),
        excited=excited,
        by_carriers=by_carriers,
    )
    at = shaft_frequency * np.array([line.order for line in lines])
    widths = _HALF_WIDTHS * shaft_frequency * np.array([line.half_width for line in lines])
    kinds = np.array([line.kind for line in lines])
    named = []
    for frequency, within in zip(frequencies, tolerances.tolist(), strict=True):
        order = frequency / shaft_frequency
        if frequency <= 0.5 * within:
            named.append(LineName("mean", "mean", order, None))
            continue
        mode = _near(modes, frequency, max(within, near))
        of_shafts = within
        if modes is not None and mode is not None:
            # Excited or not, an order of a shaft that is further off than the mode is not the line's cause.
            of_shafts = min(within, abs(float(modes.eigenvalues[mode].imag) / (2.0 * np.pi) - frequency))
        reach: dict[LineKind, float] = {
            "mesh": within,
            "shaft": of_shafts,
            "load": within,
            "bearing": within,
            "sideband": of_shafts,
        }
        distances = np.abs(at - frequency)
        # What slip makes wide is near wherever it reaches.
        beyond = np.maximum(distances - widths, 0.0)
        found = {kind: np.flatnonzero((kinds == kind) & (beyond <= distance)) for kind, distance in reach.items()}
        # Of causes that the tolerance holds, those far beyond the nearest are none.
        nearest = min((distances[n] for numbers in found.values() for n in numbers if widths[n] == 0.0), default=np.inf)
        near_it = beyond <= nearest / _MUCH_NEARER + _SAME_FREQUENCY * frequency
        left = ((kind, numbers[near_it[numbers]]) for kind, numbers in found.items())
        kind, causes = next((one for one in left if one[1].size), (None, _NONE))
        whole, away = _whole_order(machine, excited, frequency, of_shafts)
        # A line that is no sideband but for the tolerance may be a whole order of another shaft.
        if kind is not None and not (kind == "sideband" and whole and away < _MUCH_NEARER * distances[causes].min()):
            fewest = min(lines[n].steps for n in causes)
            text = joined_causes(machine, [lines[n].name for n in causes if lines[n].steps == fewest])
            named.append(LineName(kind, text, order, mode))
        elif whole:
            named.append(LineName("shaft", whole, order, mode))
        elif combined := _mesh_combination(machine, frequency, of_shafts):
            named.append(LineName("sideband", combined, order, mode))
        elif modes is not None and mode is not None:
            named.append(LineName("mode", _label(modes, mode), order, mode))
        elif far := _far_sideband(machine, frequency, within):
            named.append(LineName("sideband", far, order, None))
        else:
            named.append(LineName("other", f"{order:.4g}× {machine.leading_rotor}", order, None))
    return named


def _label(modes: CoupledModes, mode: int) -> str:
    """Kind and place of a mode, in one word where they are equal."""
    kind, place = modes.kinds[mode], modes.where[mode]
    return f"{kind} mode" if place in ("", kind) else f"{kind} mode of {place}"


def _near(modes: CoupledModes | None, frequency: float, tolerance: float) -> int | None:
    """Return the number of the mode nearest to a frequency; None where none is near. Local compliance is no mode."""
    if modes is None:
        return None
    w = 2.0 * np.pi * frequency
    distance = np.abs(modes.eigenvalues - 1j * w)
    proper = np.array([kind not in ("residual", "rigid") for kind in modes.kinds]) & (modes.eigenvalues.imag > 0.0)
    reach = np.maximum(_HALF_POWER_WIDTHS * np.abs(modes.eigenvalues.real), 2.0 * np.pi * tolerance)
    proper &= np.abs(modes.eigenvalues.imag - w) <= reach
    return int(np.argmin(np.where(proper, distance, np.inf))) if proper.any() else None


def _whole_order(
    machine: CoupledMachine, excited: Mapping[str, ExcitedOrders], frequency: float, tolerance: float
) -> tuple[str, float]:
    """Return an excited multiple of a shaft's speed, or of that relative to a carrier, and how far it is off [Hz].

    The least multiple is the first; the name is empty where there is none.
    """
    orders = []
    for name, speed in rotations(machine).items():
        rotation_frequency = abs(speed) / (2.0 * np.pi)
        # Every line is near some multiple of a very slow shaft.
        if name not in excited or rotation_frequency <= 2.5 * tolerance:
            continue
        multiple = round(frequency / rotation_frequency)
        if multiple in excited[name] and abs(frequency - multiple * rotation_frequency) <= tolerance:
            orders.append((multiple, f"{multiple}× {name}", abs(frequency - multiple * rotation_frequency)))
    return min(orders)[1:] if orders else ("", np.inf)


def _mesh_combination(machine: CoupledMachine, frequency: float, tolerance: float) -> str:
    """Return the lowest sum or difference of harmonics of two meshes at a frequency; empty without one.

    Meshes on carriers are left out: each of their lines is a whole number of turns off another.
    """
    meshes = [
        (mesh.name, abs(machine.system.contacts[number].mesh_frequency))
        for number, mesh in zip(machine.loaded_contacts, machine.meshes, strict=True)
        if mesh.carrier is None
    ]
    found = []
    for pair in combinations(meshes, 2):
        (high, above), (low, below) = sorted(pair, key=lambda mesh: -mesh[1])
        # Every line is near some multiple of a very slow mesh; equal rates have no combinations.
        if below <= 2.5 * tolerance or above - below <= tolerance:
            continue
        for first in range(1, _COMBINED_HARMONICS):
            for sign in (1, -1):
                second = round((frequency - sign * first * above) / below)
                if abs(frequency - sign * first * above - second * below) > tolerance:
                    continue
                name = f"{first}× {high} {'-' if second < 0 else '+'} {abs(second)}× {low}"
                name = f"{second}× {low} - {first}× {high}" if sign < 0 else name
                if second and first + abs(second) <= _COMBINED_HARMONICS:
                    found.append((first + abs(second), name))
    return min(found)[1] if found else ""


def _far_sideband(machine: CoupledMachine, frequency: float, tolerance: float) -> str | None:
    """Return the nearest harmonic of planets' meshes from which a line is off by whole turns of their carrier."""
    found = []
    for carrier in dict.fromkeys(mesh.carrier for mesh in machine.meshes if mesh.carrier is not None):
        turn = abs(machine.speeds[carrier]) / (2.0 * np.pi)
        # Every line is near some multiple of a very slow carrier.
        if turn <= 2.5 * tolerance:
            continue
        for number, mesh in zip(machine.loaded_contacts, machine.meshes, strict=True):
            rate = abs(machine.system.contacts[number].mesh_frequency)
            harmonic = round(frequency / rate) if mesh.carrier == carrier and rate > 0.0 else 0
            turns = round((frequency - harmonic * rate) / turn)
            if harmonic > 0 and abs(frequency - harmonic * rate - turns * turn) <= tolerance:
                sense = "-" if turns < 0 else "+"
                found.append(f"{harmonic}× {mesh.name} {sense} {abs(turns)}× {carrier}")
    return joined_causes(machine, found) or None
