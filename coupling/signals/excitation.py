"""Excitation orders of a machine: shafts, mesh harmonics, sidebands, rolling elements; names of spectral lines by them.

A line at an excitation frequency of the machine is named after its cause, the simplest one first: a mesh harmonic, a
low order of a shaft, the passing of the elements of a rolling bearing whose law follows them, a sideband, any other
whole order. A line at none of these is free vibration, named after its
mode. Either may be near a mode, which is given apart from the cause.

Sidebands of a mesh harmonic come from the modulation of the mesh by a shaft, as by runout or misalignment of a gear. A
harmonic whose strength and phase vary with the shaft's turn, Re C (1 + a(t)) e^{i(wt + b(t))} with small a = m cos(Ωt +
..) and b = β cos(Ωt + ..), has the lines C u at w + Ω and C l at w - Ω. The envelope is 1 + u e^{iΩt} + l e^{-iΩt} ≈
1 + a + i b, so

    m = |u + l*|    and    β = |u - l*|,

the former exactly for a pure modulation of amplitude, the latter to first order in β (exactly 2 J₁(β)/J₀(β)); see
Randall, *Vibration-based Condition Monitoring*, 2011.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError
from coupling.linear.complex_modes import CoupledModes
from coupling.machine.assembly import CoupledMachine
from coupling.machine.connectors import RollingLaw
from coupling.signals.spectrum import Window, lines_at
from rotors.rolling_bearings import characteristic_frequencies

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class ExcitationLine:
    """An excitation whose frequency is proportional to the speed.

    Attributes
    ----------
    name : str
        Such as ``2× input``, ``3× pinion -> wheel`` or ``1× pinion -> wheel + 1× input`` for a sideband.
    kind : str
        ``shaft``, ``mesh``, ``sideband`` or ``bearing``.
    order : float
        Frequency over the speed of the leading rotor, positive.
    """

    name: str
    kind: Literal["shaft", "mesh", "sideband", "bearing"]
    order: float


def excitation_lines(
    machine: CoupledMachine,
    *,
    shaft_orders: Sequence[float] = (1.0, 2.0),
    mesh_harmonics: Sequence[int] = (1, 2, 3),
    sidebands: int = 0,
    element_passes: Sequence[int] = (),
) -> tuple[ExcitationLine, ...]:
    """Orders of all shafts, meshes and rolling elements in motion; shafts of equal speed share a line.

    Parameters
    ----------
    machine : CoupledMachine
    shaft_orders : sequence of float
        Multiples of each shaft's speed: 1 is its unbalance.
    mesh_harmonics : sequence of int
        Multiples of each mesh frequency.
    sidebands : int
        Number on either side of each harmonic of a mesh, at the distance of either gear's shaft speed.
    element_passes : sequence of int
        Multiples of the passing of rolling elements over the outer raceway, of bearings whose law follows them.

    Raises
    ------
    CouplingError
        For a machine that stands still.
    """
    speeds = machine.speeds
    leading = abs(speeds[machine.leading_rotor])
    if leading == 0.0:
        raise CouplingError(f"rotor {machine.leading_rotor!r} stands still; expected a machine that turns")
    ratios = {name: abs(speed) / leading for name, speed in speeds.items() if speed != 0.0}
    together: dict[float, list[str]] = {}
    for name, ratio in ratios.items():
        together.setdefault(round(ratio, 12), []).append(name)
    lines = [
        ExcitationLine(f"{multiple:g}× {', '.join(names)}", "shaft", multiple * ratios[names[0]])
        for names in together.values()
        for multiple in shaft_orders
    ]
    for mesh in machine.meshes:
        teeth = mesh.geometry.driver.teeth * ratios[mesh.driver.rotor]
        name = mesh.name
        shafts = {round(ratios[rotor], 12): rotor for rotor in (mesh.driven.rotor, mesh.driver.rotor)}
        for harmonic in mesh_harmonics:
            lines.append(ExcitationLine(f"{harmonic}× {name}", "mesh", harmonic * teeth))
            for rotor in shafts.values():
                for number in range(1, sidebands + 1):
                    for sign, word in ((-1, "-"), (1, "+")):
                        order = harmonic * teeth + sign * number * ratios[rotor]
                        text = f"{harmonic}× {name} {word} {number}× {rotor}"
                        lines.append(ExcitationLine(text, "sideband", order))
    for connector in machine.system.nonlinear:
        if isinstance(connector.law, RollingLaw) and connector.speed != 0.0:
            # Rows of one bearing are mostly alike.
            for order in sorted(
                {
                    round(characteristic_frequencies(row, connector.speed).outer_pass / leading, 12)
                    for row in connector.law.state.bearing.rows
                }
            ):
                lines += [
                    ExcitationLine(f"{multiple}× elements of {connector.name}", "bearing", multiple * order)
                    for multiple in element_passes
                ]
    return tuple(lines)


LineKind = Literal["mean", "mesh", "shaft", "bearing", "sideband", "mode", "other"]

_SHAFT_ORDERS = 4  # that take precedence over a sideband of the same frequency
_SIDEBANDS = 4
_ELEMENT_PASSES = 4
_HALF_POWER_WIDTHS = 2.0  # distance within which a line is near a mode


@dataclass(frozen=True)
class LineName:
    """Name and cause of a spectral line.

    Attributes
    ----------
    kind : str
        ``mean``, ``mesh``, ``shaft``, ``bearing``, ``sideband``, ``mode`` for free vibration, or ``other``.
    name : str
        Such as ``1× pinion -> wheel``, several joined by commas where they coincide.
    order : float
        Cycles per revolution of the leading shaft.
    mode : int or None
        Of the coupled modes, the nearest one, where the line lies within two half-power widths of it.
    """

    kind: LineKind
    name: str
    order: float
    mode: int | None


def line_names(
    machine: CoupledMachine, frequencies: Sequence[float], tolerance: float, modes: CoupledModes | None = None
) -> list[LineName]:
    """Names of spectral lines of a machine at its nominal speeds.

    Parameters
    ----------
    machine : CoupledMachine
    frequencies : sequence of float
        [Hz].
    tolerance : float
        Largest distance of a line from the frequency of its cause [Hz]: a small part of the spacing where the record
        holds whole periods, half of it otherwise.
    modes : CoupledModes, optional
        About the mean contact.

    Raises
    ------
    CouplingError
        For a machine that stands still, or a tolerance that is not positive.
    """
    if not tolerance > 0.0:
        raise CouplingError(f"names of lines within {tolerance} Hz; expected more than 0")
    shaft_frequency = abs(machine.speeds[machine.leading_rotor]) / (2.0 * np.pi)
    highest = max(frequencies, default=0.0)
    meshes = [
        abs(contact.mesh_frequency) for contact in machine.system.contacts if contact.loaded and contact.mesh_frequency
    ]
    excited = excitation_lines(
        machine,
        shaft_orders=range(1, _SHAFT_ORDERS + 1),
        mesh_harmonics=range(1, 2 + int(highest / min(meshes))) if meshes else (),
        sidebands=_SIDEBANDS,
        element_passes=range(1, _ELEMENT_PASSES + 1),
    )
    found = []
    for frequency in frequencies:
        order = frequency / shaft_frequency
        mode = _near(modes, frequency, tolerance)
        if frequency <= 0.5 * tolerance:
            found.append(LineName("mean", "mean", order, None))
            continue
        names = {
            kind: [
                line.name
                for line in excited
                if line.kind == kind and abs(line.order * shaft_frequency - frequency) <= tolerance
            ]
            for kind in ("mesh", "shaft", "bearing", "sideband")
        }
        kind = next((kind for kind in names if names[kind]), None)
        if kind is not None:
            text = ", ".join(names[kind] if kind != "sideband" else _nearest(names[kind]))
            found.append(LineName(kind, text, order, mode))  # type: ignore[arg-type]
        elif whole := _whole_order(machine, frequency, tolerance):
            found.append(LineName("shaft", whole, order, mode))
        elif modes is not None and mode is not None:
            found.append(LineName("mode", _label(modes, mode), order, mode))
        else:
            found.append(LineName("other", f"{order:.4g}× {machine.leading_rotor}", order, None))
    return found


def _label(modes: CoupledModes, mode: int) -> str:
    """Kind and place of a mode, once where they are one word."""
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


def _nearest(names: list[str]) -> list[str]:
    """Sidebands with the fewest steps from their carrier."""
    steps = [int(name.rsplit("×", 1)[0].rsplit(" ", 1)[1]) for name in names]
    return [name for name, step in zip(names, steps, strict=True) if step == min(steps)]


def _whole_order(machine: CoupledMachine, frequency: float, tolerance: float) -> str | None:
    """Return a multiple of a shaft's speed, the slowest multiple first."""
    found = []
    for name, speed in machine.speeds.items():
        each = abs(speed) / (2.0 * np.pi)
        # Every line is near some multiple of a very slow shaft.
        if each > 2.5 * tolerance and abs(frequency - round(frequency / each) * each) <= tolerance:
            found.append((round(frequency / each), f"{round(frequency / each)}× {name}"))
    return min(found)[1] if found else None


@dataclass(frozen=True)
class Sideband:
    """A pair of sidebands of a carrier.

    Attributes
    ----------
    carrier : float
        Frequency [Hz].
    number : int
        1 for the lines next to the carrier, at the distance of the modulating frequency; 2 for those at twice that.
    distance : float
        From the carrier [Hz].
    carrier_amplitude, lower, upper : float
        Peak amplitudes in the signal's unit.
    amplitude_modulation : float
        m, a part of the carrier; NaN without one.
    phase_modulation : float
        β [rad].
    """

    carrier: float
    number: int
    distance: float
    carrier_amplitude: float
    lower: float
    upper: float
    amplitude_modulation: float
    phase_modulation: float


def sidebands(
    signal: FloatArray,
    interval: float,
    carriers: Sequence[float],
    modulating: float,
    *,
    count: int = 3,
    window: Window = "uniform",
) -> list[Sideband]:
    """Sidebands of a signal of shape (s,), carrier by carrier, nearest first.

    Parameters
    ----------
    signal : ndarray, shape (s,)
    interval : float
        Between samples [s].
    carriers : sequence of float
        Mesh frequency and harmonics [Hz].
    modulating : float
        Frequency of a shaft [Hz].
    count : int
        Pairs for each carrier. Those that would reach 0 Hz or half the sampling rate are left out.
    window : {"uniform", "hann"}
        Uniform where the record holds whole periods of all these lines.

    Raises
    ------
    CouplingError
        Where the modulating frequency is not positive, or the record is too short to separate the lines.
    """
    length = signal.shape[-1] * interval
    apart = 1.0 if window == "uniform" else 2.0
    if not modulating * length >= apart * (1.0 - 1e-9):
        raise CouplingError(
            f"sidebands {modulating:g} Hz apart in a record of {length:g} s; expected one of {apart:g} periods at least"
        )
    places = [
        (carrier, number)
        for carrier in carriers
        for number in range(1, count + 1)
        if carrier - number * modulating > 0.0 and carrier + number * modulating < 0.5 / interval
    ]
    wanted = sorted({carrier + sign * n * modulating for carrier, n in places for sign in (-1, 0, 1)})
    found = dict(zip(wanted, lines_at(signal, interval, np.array(wanted), window).tolist(), strict=True))
    result = []
    for carrier, number in places:
        middle = found[carrier]
        lower, upper = found[carrier - number * modulating], found[carrier + number * modulating]
        below, above = (complex(np.nan, np.nan),) * 2 if middle == 0.0 else (lower / middle, upper / middle)
        result.append(
            Sideband(
                carrier=carrier,
                number=number,
                distance=number * modulating,
                carrier_amplitude=abs(middle),
                lower=abs(lower),
                upper=abs(upper),
                amplitude_modulation=abs(above + below.conjugate()),
                phase_modulation=abs(above - below.conjugate()),
            )
        )
    return result
