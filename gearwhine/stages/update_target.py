"""Targets of an update: measured frequencies, and shapes where a survey holds some."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from gearwhine.case import Case, CaseError, Problem
from gearwhine.case.problems import UNSAID
from gearwhine.progress import Progress, silent
from gearwhine.stages.geometry import build_mesh
from gearwhine.stages.measured import map_measured, read_measured
from housing.correlation import dominance_band, real_shapes
from housing.measured import MeasuredModes, map_survey
from housing.updating import ModeCount, Target
from meshes import Mesh

_HERTZ = 2.0 * np.pi
_MARGIN = 1.0 / 3.0  # of the least gap, for the two measures beside the one that decides

Observer = Callable[[Mesh], sparse.csr_array]
"""From a mesh to the matrix of the degrees of freedom where shapes were measured, shape (n_dofs, 3 n_nodes)."""


@dataclass(frozen=True)
class Measurement:
    """Measured modes as the fit uses them.

    Attributes
    ----------
    target : Target
    observer : callable, optional
        None where no shapes were measured.
    left_out : int
        Degrees of freedom that were not measured in every mode, and take no part.
    """

    target: Target
    observer: Observer | None = None
    left_out: int = 0


def measurement_of(case: Case, progress: Progress = silent) -> Measurement:
    """Measured targets of a case's update.

    Shapes pair the modes where there are any, else the dominance between seats and skin does. Complex ones are turned
    on to the real axis.

    Raises
    ------
    CaseError
        Where the survey does not lie on the housing, shapes share too few degrees of freedom, or neither shapes nor
        bearing seats tell which modes are which.
    """
    given = case.update
    assert given is not None
    assert case.housing is not None
    measured = read_measured(case, progress)
    known = given.model_modes
    target = Target(
        frequencies=measured.frequencies,
        noise=np.full(len(measured.frequencies), given.frequency_noise),
        band=dominance_band(measured.frequencies),
        gap=given.gap,
        margin=_MARGIN * given.gap if given.gap else -np.inf,
        count=None if known is None else ModeCount(_HERTZ * known.below, known.least, known.most),
    )
    if measured.shapes is not None:
        return _with_shapes(case, target, measured)
    if not case.housing.seat:
        expected = "bearing seats: without measured shapes modes are paired by their strength between seats and skin"
        raise CaseError([Problem("housing.seat", (), expected)])
    return Measurement(target)


def _with_shapes(case: Case, target: Target, measured: MeasuredModes) -> Measurement:
    assert case.update is not None
    assert case.measured is not None
    assert measured.shapes is not None
    geometry = measured.geometry
    assert geometry is not None
    shared = np.flatnonzero(~np.isnan(measured.shapes).any(axis=0))
    if len(shared) <= len(measured.shapes):
        expected = (
            f"shapes that share more than {len(measured.shapes)} degrees of freedom, as many as there are modes; "
            f"{len(shared)} were measured in all of them"
        )
        raise CaseError([Problem("measured.file", UNSAID, expected)])
    # Aligned once: an alignment that followed each design would hide its changes of size.
    alignment = map_measured(case, build_mesh(case), geometry).alignment
    tolerance = case.measured.tolerance

    def observer(mesh: Mesh) -> sparse.csr_array:
        mapped = map_survey(mesh, geometry, alignment=alignment, tolerance=tolerance)
        return sparse.csr_array(mapped.matrix[shared])

    with_shapes = Target(
        frequencies=target.frequencies,
        noise=target.noise,
        band=target.band,
        shapes=real_shapes(measured.shapes[:, shared]),
        shape_noise=case.update.shape_noise,
        count=target.count,
    )
    return Measurement(with_shapes, observer, measured.shapes.shape[1] - len(shared))
