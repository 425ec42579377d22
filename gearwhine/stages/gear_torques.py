"""Harris maps of gear pairs over torque, and the optimal tip relief."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

import coupling.gears as room
from coupling.gears.gear_pair import LoadedGearPair
from gearwhine.progress import Progress, silent
from gearwhine.stages.gear_analysis import PairAnalysis

FloatArray = npt.NDArray[np.float64]

_SEARCHED_SLICES = 21  # of a face, while the best relief is sought
_LEAST, _MOST, _TORQUES = 0.1, 2.0, 20  # of the case's torque, in a Harris map


def solve_over_torques(
    pairs: Sequence[PairAnalysis], progress: Progress = silent, aims: Sequence[room.ReliefAim] = ()
) -> tuple[PairAnalysis, ...]:
    """The same pairs with their Harris maps and optimal reliefs, where the case has a torque.

    ``aims`` are those of the reliefs, one for each pair; all peak to peak where not given.
    """
    found = []
    for pair, aim in zip(pairs, aims or [room.PeakToPeak()] * len(pairs), strict=True):
        if pair.solved.static.force > 0.0:
            progress(f"Harris map of {pair.label}")
            pair = replace(pair, harris=_harris_map(pair.solved))
            if pair.solved.has_single_pairs:
                progress(f"best tip relief of {pair.label}")
                pair = replace(pair, optimum=_best_relief(pair.solved, aim))
        found.append(pair)
    return tuple(found)


def _harris_map(pair: LoadedGearPair) -> room.HarrisMap:
    contact = pair.contact
    if contact.hunting_period > 1:
        contact = room.tooth_contact(
            _alike(pair.geometry), pair.model, corner_contact=contact.has_corner_contact, faces=contact.faces
        )
    return room.harris_map(contact, pair.static.force * np.linspace(_LEAST, _MOST, _TORQUES))


def _best_relief(pair: LoadedGearPair, aim: room.ReliefAim) -> room.ReliefOptimum:
    given = pair.geometry.driver.tip_relief or pair.geometry.driven.tip_relief
    geometry, force, faces = _alike(pair.geometry), pair.static.force, pair.contact.faces
    corners = pair.contact.has_corner_contact
    return room.optimal_tip_relief(
        geometry,
        pair.model,
        [force],
        shape="linear" if given is None else given.shape,
        corner_contact=corners,
        faces=faces,
        searched_faces=None if faces is None else with_coarser_slices(faces, _SEARCHED_SLICES),
        aim=aim,
    )


def with_coarser_slices(faces: room.FaceSlices, count: int) -> room.FaceSlices:
    """The same face in at most `count` slices: quick enough to search with, and as good for finding a place."""
    if faces.z.size <= count:
        return faces
    z = faces.face_width * ((np.arange(count) + 0.5) / count - 0.5)
    shift, gap = (np.interp(z, faces.z, values) for values in (faces.shift, faces.gap))
    return replace(faces, z=z, width=faces.face_width / count, shift=shift, gap=gap)


def _alike(pair: room.GearPairGeometry) -> room.GearPairGeometry:
    """A pair of gears with all their teeth alike: a relief is cut for all of them."""
    driver, driven = (replace(gear, pitch_deviations=(), faults=()) for gear in (pair.driver, pair.driven))
    return replace(pair, driver=driver, driven=driven)
