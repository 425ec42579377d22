"""The pictures of a case's rotors: which there are, and the files they go to."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure
from scipy.optimize import linear_sum_assignment

import rotors as room
from gearwhine.case import Case, RollingStiffness, Segment
from gearwhine.figures.assembly import DrawnGear, DrawnUnbalance, RotorAssembly
from gearwhine.figures.campbell import draw_campbell
from gearwhine.figures.mode_shapes import draw_lateral_modes, draw_torsional_modes
from gearwhine.figures.shaft import draw_shaft
from gearwhine.figures.style import save, shortened
from gearwhine.figures.whirl_shapes import draw_whirl_modes
from gearwhine.output import file_stems
from gearwhine.progress import Progress, silent
from gearwhine.stages.build import gear_inertia
from gearwhine.stages.rotors import SolvedRotor

FloatArray = npt.NDArray[np.float64]

_MODES = 6  # drawn of each kind
_ADDENDUM, _DEDENDUM, _WIDTH = 1.0, 1.25, 10.0  # of a drawn tooth and of a gear without a face width, in modules


def draw_rotors(folder: Path, case: Case, solved: Sequence[SolvedRotor], progress: Progress = silent) -> list[str]:
    """Draw each rotor: the shaft, its lateral and torsional modes, its whirl at speed, its Campbell diagram.

    Whirl is drawn where the case has an operation, the Campbell diagram where operation and sweep hold two speeds
    or more.

    Parameters
    ----------
    folder : path
        Where the files go, as ``rotor-NAME-shaft.png`` and so on.
    case : Case
    solved : sequence of SolvedRotor
        Of the case.
    progress : callable
        Told which rotor is drawn.

    Returns
    -------
    list of str
        The files' names.
    """
    files = []
    stems = file_stems([one.rotor.name for one in solved], "rotor-")
    for stem, one in zip(stems, solved, strict=True):
        progress(f"drawing rotor {one.rotor.name}")
        files += [save(figure, folder / f"{stem}-{kind}.png") for kind, figure in _figures(case, one)]
    return files


def rotor_assembly(case: Case, one: SolvedRotor) -> RotorAssembly:
    """A solved rotor as it is drawn: its gears by their size rather than as discs."""
    name = one.rotor.name
    given = case.rotor_named(name)
    gears = []
    for gear in case.gear:
        if gear.rotor != name or gear.at is None:
            continue
        module, shift = gear.tooth_module, gear.profile_shift
        gears.append(
            DrawnGear(
                name=gear.name,
                at=gear.at,
                face_width=gear.face_width or _WIDTH * module,
                tip_diameter=2.0 * (gear.pitch_radius + (_ADDENDUM + shift) * module),
                pitch_diameter=2.0 * gear.pitch_radius,
                root_diameter=2.0 * (gear.pitch_radius - (_DEDENDUM - shift) * module),
                teeth=gear.teeth,
                disc=room.Disc(gear.at, *gear_inertia(case, gear)),
            )
        )
    on_it = [bearing for bearing in case.bearing if bearing.rotor == name]
    # The materials of a rotor's own file have no names in the case.
    rows = zip(one.rotor.segments, given.segments, strict=True) if given.saved is None else ()
    return RotorAssembly(
        rotor=one.rotor,
        bearings=one.bearings,
        gears=gears,
        unbalances=[DrawnUnbalance(at.at, at.moment, at.phase) for at in given.unbalance],
        rolling={bearing.name for bearing in on_it if isinstance(bearing.stiffness, RollingStiffness)},
        seats={bearing.name: bearing.seat for bearing in on_it if not bearing.grounded},
        materials={
            part.material: segment.material or given.material or ""
            for part, segment in rows
            if isinstance(part, room.Segment) and isinstance(segment, Segment)
        },
    )


def _figures(case: Case, one: SolvedRotor) -> list[tuple[str, Figure]]:
    assembly = rotor_assembly(case, one)
    figures = [
        ("shaft", draw_shaft(assembly)),
        ("modes", draw_lateral_modes(assembly, one.lateral, most=_MODES)),
        ("torsion", draw_torsional_modes(assembly, one.torsional, most=_MODES)),
    ]
    operation = None
    if case.operation is not None and one.whirl[0].frequencies.size:
        operation = one.whirl[0].speed
        figures.append(("whirl", draw_whirl_modes(assembly, one.whirl[0], most=_MODES)))
    whirl = list({modes.speed: modes for modes in sorted(one.whirl, key=lambda modes: abs(modes.speed))}.values())
    if len(whirl) > 1 and min(modes.frequencies.size for modes in whirl):
        frequencies, directions, ratios = whirl_branches(whirl)
        campbell = draw_campbell(
            f"Rotor {shortened(one.rotor.name, 20)}: Campbell diagram",
            [modes.speed for modes in whirl],
            frequencies,
            directions,
            ratios,
            critical_speeds=one.critical.speeds,
            critical_directions=one.critical.direction,
            operating_speed=operation,
        )
        figures.append(("campbell", campbell))
    return figures


def whirl_branches(whirl: Sequence[room.WhirlModes]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Frequencies, directions and damping ratios, each (s, w), of modes that stay themselves from speed to speed.

    Neighbours belong together whose modal coordinates overlap most in sum. It goes down from the highest speed,
    because at rest the shapes of double roots are any.
    """
    count = min(modes.frequencies.size for modes in whirl)
    order = [np.arange(count)]
    for above, below in zip(whirl[:0:-1], whirl[-2::-1], strict=True):
        overlap = np.abs(above.coordinates[order[0]].conj() @ below.coordinates.T)
        order.insert(0, linear_sum_assignment(-overlap)[1])
    picked = list(zip(whirl, order, strict=True))
    return (
        np.array([modes.frequencies[kept] for modes, kept in picked]),
        np.array([modes.direction[kept] for modes, kept in picked]),
        np.array([modes.damping_ratios[kept] for modes, kept in picked]),
    )
