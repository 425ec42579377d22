"""Fit of a box to the measured frequencies of NASA's gear noise rig from one start, for studies of many boxes.

The search is that of `gearwhine update` (:mod:`gearwhine.housing.updating`): the same misfit, surrogate and trust
region. It differs in where it solves. Most steps are on elements of 24 mm, whose bias against elements of 12 mm is
corrected by that of the nominal box. They end where the dominant modes have the frequencies, clearly enough, and the
number of modes is the known one. A few steps on elements of 12 mm follow, until the dominant modes have the frequencies
there. Starts that are far off, and searches that do not come near, are given up.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case
from gearwhine.from_case.parametric_housing import HousingAtParameters, ParametricHousing, fitted_case
from gearwhine.housing import HousingError
from gearwhine.housing.updating import Misfit, Target, measure
from gearwhine.housing.updating.mesh_bias import Debiased, MeshBias, debiased
from gearwhine.housing.updating.parameters import values_at
from gearwhine.housing.updating.trust_region import Effort, search
from gearwhine.from_case.mesh import build_mesh
from gearwhine.solve.updating import measurement_of

FloatArray = npt.NDArray[np.float64]

SEARCHED_ON, CHECKED_ON = 24e-3, 12e-3
"""Sizes of the elements [m]."""
START_RMS_PERCENT = 12.0
"""Root-mean-square error of the frequencies at a start above which it is refused."""
SEARCHED_RMS_PERCENT = 4.0
"""Likewise after each round of the search on coarse elements, above which it is given up."""

_MODES = 36  # beyond the band of the dominant modes wherever the number of modes below 3 kHz is near the known one
# On coarse elements: firmness, trust region, solves, noise beside the given. The least misfit may lie just outside the
# errors allowed, where the prior outweighs the frequencies; the last round gives these more weight.
_ROUNDS = ((0.4, 0.25, 4, 1.0), (1.0, 0.2, 6, 1.0), (3.0, 0.1, 6, 1.0), (3.0, 0.1, 5, 0.5))
_FIRM, _FINE_TRUST, _FINE_SOLVES = 3.0, 0.08, 3  # the same on fine ones
_TIGHT = 0.75  # of the error allowed there, so that what the bias leaves does not lose what the search has met
_CLEAR = 0.04  # gap of dominance, for the same reason
_STARTS = 16  # on the surrogate


@dataclass(frozen=True)
class BoxFit:
    """Result of a fit.

    Attributes
    ----------
    document : dict or None
        Case of the fitted box; None where there is none.
    parameters : dict of str to float
        Its fitted values by name, in SI.
    outcome : str
        ``fitted``, ``refused`` at the start, ``given up`` before the fine mesh, or ``missed`` on it.
    start_rms_percent : float
        Root-mean-square error of the frequencies at the start.
    largest_percent : float
        Largest error of the dominant modes on the fine mesh; infinite where it was not solved.
    solves, fine_solves : int
        Solutions on the coarse and on the fine mesh.
    seconds : float
        Processor time.
    """

    document: dict[str, Any] | None
    parameters: dict[str, float]
    outcome: str
    start_rms_percent: float
    largest_percent: float
    solves: int
    fine_solves: int
    seconds: float


def meshes_of(case: Case) -> tuple[ParametricHousing, ParametricHousing]:
    """Parametric housings of a case on the coarse mesh of the search and on the fine one of the checks."""
    coarse = ParametricHousing(fitted_case(case, SEARCHED_ON), _MODES, threads=1, draft=True)
    return coarse, replace(coarse, case=fitted_case(case, CHECKED_ON), as_written=True)


def bias_of(case: Case) -> MeshBias:
    """Bias of the coarse mesh at a case's own design."""
    coarse, fine = meshes_of(case)
    return MeshBias.between(coarse.solve(coarse.start).state, fine.solve(fine.start).state)


def fit_box(
    case: Case, bias: MeshBias | None, within: float, progress: Callable[[str], None] = lambda message: None
) -> BoxFit:
    """Fit a box until all frequencies of its dominant modes on the fine mesh are within a relative error.

    Parameters
    ----------
    case : Case
        The start, with its `[update]`: parameters, prior, noise, gap and number of modes.
    bias : MeshBias or None
        Of the coarse mesh, from a design nearby.
    within : float
        Largest relative error of a frequency.
    progress : callable
        Called with a line of text for each solution.
    """
    begin = time.process_time()
    coarse, fine = meshes_of(case)
    target = measurement_of(case.measured, case.update, lambda: build_mesh(case.housing, case.material, case.input_files)).target
    solves = fine_solves = 0
    start_rms = largest = float("inf")

    def ended(outcome: str, values: Sequence[float] | None = None) -> BoxFit:
        document = None if values is None else fine.case.document_at(values)
        named = dict(zip((one.name for one in fine.parameters), values or (), strict=values is not None))
        seconds = time.process_time() - begin
        return BoxFit(document, named, outcome, start_rms, largest, solves, fine_solves, seconds)

    try:
        here = Debiased(coarse.solve(coarse.start), bias)
        soft = replace(target, firmness=_ROUNDS[0][0])
        start_rms = measure(soft, here.state, here.coordinates).rms_percent
        if not start_rms <= START_RMS_PERCENT:
            return ended("refused")
        for number, (firmness, trust, most, part) in enumerate(_ROUNDS):
            found = search(
                debiased(coarse.solve, bias),
                replace(target, firmness=firmness, noise=part * target.noise),
                coarse.parameters,
                here,
                Effort(solves=most, starts=_STARTS, trust=trust, seed=number + 1),
                progress,
                lambda design: _is_met(target, design, _TIGHT * within),
            )
            solves += len(found.steps)
            here = found.design
            if _is_met(target, here, _TIGHT * within):
                break
            if measure(soft, here.state, here.coordinates).rms_percent > SEARCHED_RMS_PERCENT:
                return ended("given up")
        else:
            return ended("given up")
        design = fine.solve(here.coordinates)
        fine_solves = 1
        progress(f"on fine elements: {_judged(target, design).in_words}")
        if _judged(target, design).max_percent > 100.0 * within:
            ending = search(
                lambda point, _: fine.solve(point),
                replace(target, firmness=_FIRM, noise=part * target.noise),
                fine.parameters,
                design,
                Effort(solves=_FINE_SOLVES, starts=_STARTS, trust=_FINE_TRUST),
                progress,
                lambda trial: _judged(target, trial).max_percent <= 100.0 * within,
            )
            fine_solves += len(ending.steps)
            design = ending.design
        largest = _judged(target, design).max_percent
    except HousingError:
        return ended("missed")
    if largest > 100.0 * within:
        return ended("missed")
    return ended("fitted", _written(fine, design.coordinates))


def _is_met(target: Target, design: Debiased[HousingAtParameters], within: float) -> bool:
    """Whether the dominant modes, clearly so, have the frequencies, and the number of modes is the known one."""
    judged, known = _judged(target, design), target.count
    counted = known is None or known.least <= judged.count <= known.most
    return counted and judged.gap >= _CLEAR and judged.max_percent <= 100.0 * within


def _judged(target: Target, design: HousingAtParameters | Debiased[HousingAtParameters]) -> Misfit:
    """Misfit of a design's dominant modes."""
    return measure(replace(target, firmness=_FIRM), design.state, design.coordinates, strict=True)


def _written(designs: ParametricHousing, coordinates: FloatArray) -> list[float]:
    """Values of the parameters as a case has them."""
    values = values_at(designs.parameters, coordinates).tolist()
    return [number.as_written(value) for number, value in zip(designs.case.numbers, values, strict=True)]
