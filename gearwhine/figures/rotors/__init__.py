"""Figures of rotors: Campbell diagram, mode shapes, critical speeds, responses; and all of a case as a set."""

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.figure import Figure

from gearwhine.case import Case, Segment
from gearwhine.coupling import Machine, ShaftGear
from gearwhine.coupling.description.parts import gear_disc
from gearwhine.figures.rotors.assembly import DrawnGear, DrawnUnbalance, RotorAssembly
from gearwhine.figures.rotors.campbell import draw_campbell
from gearwhine.figures.rotors.critical_speed_map import draw_critical_map
from gearwhine.figures.rotors.mode_shapes import (
    draw_rest_modes,
    draw_static_deflection,
    draw_torsional_modes,
    draw_whirl_modes,
)
from gearwhine.figures.rotors.responses import (
    ProbeResponse,
    TorsionalReading,
    draw_torsional_response,
    draw_unbalance_response,
)
from gearwhine.figures.rotors.shaft import draw_shaft
from gearwhine.figures.style import shortened
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.progress import Progress, silent
from gearwhine.output import file_stems
from gearwhine.rotors import Bearing, Rotor
from gearwhine.rotors import Segment as RotorSegment
from gearwhine.rotors.analyses.solved_rotor import SolvedRotor

_CIRCULAR_BACKWARD = -1.0 + 1e-6  # whirl on which unbalance does no work
_MODES = 6  # modes drawn of each kind, of bending at rest in each plane


def draw_rotors(
    solved: Sequence[SolvedRotor], assemblies: Sequence[RotorAssembly], progress: Progress = silent
) -> Iterator[tuple[str, Figure]]:
    """Draw each rotor: the shaft, its modes, its whirl at speed, and the results of its analyses.

    These are the Campbell diagram, the critical-speed map, the response to unbalance and bow, and the static
    deflection, each where it is solved.

    Parameters
    ----------
    solved : sequence of SolvedRotor
    assemblies : sequence of RotorAssembly
        Each rotor as it is drawn.
    progress : callable
        Receives the name of the rotor being drawn.

    Yields
    ------
    str
        Name of the figure: ``rotor-NAME-shaft`` and so on.
    matplotlib.figure.Figure
    """
    stems = file_stems([rotor.rotor.name for rotor in solved], "rotor-")
    for stem, rotor, assembly in zip(stems, solved, assemblies, strict=True):
        progress(f"drawing rotor {rotor.rotor.name}")
        for kind, figure in _figures(rotor, assembly):
            yield f"{stem}-{kind}", figure


def rotor_assembly(case: Case, rotor: Rotor, bearings: Sequence[Bearing]) -> RotorAssembly:
    """Return the assembly of a rotor of a case as it is drawn: its gears by their size rather than as discs."""
    name = rotor.name
    entry = case.rotor_named(name)
    on_it = [bearing for bearing in case.bearing if bearing.rotor == name]
    # The materials of a rotor's own file have no names in the case.
    rows = zip(rotor.segments, entry.segments, strict=True) if entry.saved is None else ()
    return RotorAssembly(
        rotor=rotor,
        bearings=bearings,
        gears=_drawn_gears(case.parts.gears_on(name), rotor),
        unbalances=[DrawnUnbalance(mass.at, mass.moment, mass.phase) for mass in entry.unbalance],
        rolling={bearing.name for bearing in on_it if bearing.rolling is not None},
        seats={bearing.name: bearing.seat for bearing in on_it if not bearing.grounded},
        materials={
            part.material: segment.material or entry.material or ""
            for part, segment in rows
            if isinstance(part, RotorSegment) and isinstance(segment, Segment)
        },
    )


def shaft_assembly(machine: Machine, name: str, bearings: Sequence[Bearing]) -> RotorAssembly:
    """Return the assembly of a shaft of a machine as it is drawn, with these bearings."""
    rotor, mounted = machine.rotor(name), [one for one in machine.bearings if one.rotor == name]
    return RotorAssembly(
        rotor=rotor,
        bearings=bearings,
        gears=_drawn_gears([gear for gear in machine.gears if gear.shaft == name], rotor),
        unbalances=[DrawnUnbalance(mass.at, mass.moment, mass.phase) for mass in machine.shaft(name).unbalances],
        rolling={one.bearing.name for one in mounted if one.rolling is not None},
        seats={one.bearing.name: one.seat for one in mounted if one.seat is not None},
    )


def _drawn_gears(gears: Sequence[ShaftGear], rotor: Rotor) -> list[DrawnGear]:
    return [
        DrawnGear(
            name=mounted.name,
            at=mounted.at,
            face_width=mounted.gear.face_width,
            # The teeth of a ring are inside its body.
            tip_diameter=2.0 * mounted.gear.outer_radius,
            pitch_diameter=2.0 * abs(mounted.gear.pitch_radius),
            root_diameter=2.0 * max(mounted.gear.root_circle_radius, -(mounted.gear.rim_outer_radius or 0.0)),
            teeth=mounted.gear.tooth_count,
            disc=gear_disc(mounted, rotor),
        )
        for mounted in gears
    ]


def _figures(solved: SolvedRotor, assembly: RotorAssembly) -> list[tuple[str, Figure]]:
    figures = [
        ("shaft", draw_shaft(assembly)),
        ("modes", draw_rest_modes(assembly, solved.rest, most=2 * _MODES)),
        ("torsion", draw_torsional_modes(assembly, solved.torsional, most=_MODES)),
    ]
    operation = solved.operation
    if operation is not None and solved.whirl[0].frequencies.size:
        figures.append(("whirl", draw_whirl_modes(assembly, solved.whirl[0], most=_MODES)))
    critical, directions = _critical_speeds(solved)
    name = f"Rotor {shortened(solved.rotor.name, 20)}"
    if solved.campbell is not None and solved.campbell.speeds.size > 1 and solved.campbell.eigenvalues.size:
        crossed, senses, orders = _with_other_orders(solved, solved.campbell.speeds, critical, directions)
        campbell = draw_campbell(
            f"{name}: Campbell diagram",
            solved.campbell,
            critical_speeds=crossed,
            critical_directions=senses,
            critical_orders=orders,
            orders=sorted({1.0, *solved.orders}),
            operating_speed=operation,
        )
        figures.append(("campbell", campbell))
    if solved.stiffness_map is not None:
        sheet = draw_critical_map(
            f"{name}: undamped critical-speed map",
            solved.stiffness_map.stiffnesses,
            solved.stiffness_map.speeds,
            bearings=solved.bearings,
            operating_speed=operation,
            whirl="forward" if solved.stiffness_map.direction > 0 else "backward",
        )
        figures.append(("critical-map", sheet))
    if solved.torsion is not None and solved.torsion.response.frequencies.size > 1:
        read = [
            TorsionalReading(reading.probe.name, np.abs(reading.angle), np.abs(reading.torque))
            for reading in solved.torsion.readings
        ]
        swing = draw_torsional_response(
            f"{name}: torsional response",
            solved.torsion.response.frequencies,
            read,
            natural_frequencies=solved.torsional.frequencies[solved.torsional.frequencies > 0.0],
        )
        figures.append(("torsional-response", swing))
    if solved.response is not None and solved.response.response.speeds.size > 1:
        readings = [
            ProbeResponse(read.probe.name, read.amplitude, read.major_axis) for read in solved.response.readings
        ]
        running = None if operation is None else (abs(operation), abs(operation))
        response = draw_unbalance_response(
            f"{name}: response to unbalance" + (" and bow" if solved.response.response.bow is not None else ""),
            np.abs(solved.response.response.speeds),
            readings,
            critical_speeds=critical[directions > _CIRCULAR_BACKWARD],
            operating_range=running,
        )
        figures.append(("unbalance", response))
    if not isinstance(solved.weight, str):
        # The loads act on the bearings; the arrows show the reactions on the rotor.
        holding = -solved.weight.deflection.bearing_loads[:, :2]
        sheet = draw_static_deflection(assembly, solved.weight.places, solved.weight.displacement.T, holding)
        figures.append(("static", sheet))
    return figures


def _with_other_orders(
    solved: SolvedRotor, speeds: FloatArray, critical: FloatArray, directions: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return critical speeds of order 1, then of the other orders, with their senses and orders."""
    sense = -1.0 if speeds.min() < 0.0 else 1.0
    more = [
        crossing for crossings in solved.orders.values() if not isinstance(crossings, str) for crossing in crossings
    ]
    return (
        np.array([*critical, *(abs(crossing.speed) for crossing in more)]),
        np.array([*directions, *(sense * crossing.direction for crossing in more)]),
        np.array([1.0] * critical.size + [crossing.order for crossing in more]),
    )


def _critical_speeds(solved: SolvedRotor) -> tuple[FloatArray, FloatArray]:
    """Return critical speeds and their directions: damped, where the Campbell diagram meets 1×, or else undamped."""
    if solved.campbell is None or isinstance(solved.crossings, str):
        return solved.critical.speeds, solved.critical.direction
    sense = -1.0 if solved.campbell.speeds.min() < 0.0 else 1.0
    speeds = np.array([abs(crossing.speed) for crossing in solved.crossings])
    return speeds, sense * np.array([crossing.direction for crossing in solved.crossings])
