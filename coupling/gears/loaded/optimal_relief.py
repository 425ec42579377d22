"""Optimal tip relief, with the least transmission error or the least weighted harmonics of it, and the Harris map.

Optimised are amount and length of the relief. The Harris map is the transmission error over a mesh period for a range
of loads (S. L. Harris, Proc. IMechE 172, 1958).

Without load the transmission error is the profile modification itself; under load the deflection of the teeth takes it
up. The curve is flat near the design load of the modification, and rises below and above it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize

from gearwhine.coupling.gears.contact.contact_law import ToothContact, slices_of_teeth, tooth_contact, with_flanks_of
from gearwhine.coupling.gears.contact.face_slices import FaceSlices, aligned_slices
from gearwhine.coupling.gears.errors import GearError, require_finite
from gearwhine.coupling.gears.geometry.modifications import ReliefShape, TipRelief
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry
from gearwhine.coupling.gears.loaded.transmission_error import (
    LoadedMesh,
    loaded_transmission_error,
    mesh_period_phases,
    transmission_error_phasors,
)
from gearwhine.coupling.gears.piecewise_cubic import PiecewiseCubic
from gearwhine.coupling.gears.stiffness.models import StiffnessModel, shared_compliance
from gearwhine.numerics.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class HarrisMap:
    """Static transmission error for f loads at n phases of a mesh period.

    Attributes
    ----------
    forces : ndarray, shape (f,)
        Loads along the line of action [N].
    phases : ndarray, shape (n,)
        Part of the mesh period.
    transmission_error : ndarray, shape (f, n)
        Static transmission error under each force [m].
    """

    forces: FloatArray
    phases: FloatArray
    transmission_error: FloatArray

    @property
    def peak_to_peak(self) -> FloatArray:
        """Largest less smallest transmission error at each load [m], (f,)."""
        return np.asarray(np.ptp(self.transmission_error, axis=1))

    @property
    def quietest(self) -> float:
        """Load with the least peak-to-peak transmission error of those given [N]."""
        return float(self.forces[int(self.peak_to_peak.argmin())])


def harris_map(contact: ToothContact, forces: npt.ArrayLike, phases: npt.ArrayLike | None = None) -> HarrisMap:
    """Compute the static transmission error over the mesh period at every load (Harris map).

    Parameters
    ----------
    contact : ToothContact
    forces : array_like, shape (f,)
        Mesh forces [N], at least 0.
    phases : array_like, shape (n,), or None
        Mesh periods; None for `mesh_period_phases` of 200 points.

    Raises
    ------
    GearError
        Without a load, or with a negative one.
    """
    loads = np.atleast_1d(np.asarray(forces, dtype=np.float64))
    if loads.size == 0:
        raise GearError("Harris map: at least one load is needed")
    at = mesh_period_phases(contact, 200) if phases is None else np.atleast_1d(np.asarray(phases, dtype=np.float64))
    states = contact.pairs(at)
    errors = [loaded_transmission_error(contact, float(load), at, states=states).transmission_error for load in loads]
    return HarrisMap(loads, at, np.array(errors))


def transmission_error_harmonics(mesh: LoadedMesh, count: int = 8) -> FloatArray:
    """Amplitudes of the first harmonics of the mesh frequency in the transmission error [m], (count,).

    Exact for the polygon through the points of one mesh period: a curve with a step has the harmonics of a step.

    Raises
    ------
    GearError
        Where the phases do not lie in one mesh period, ascending.
    """
    return np.abs(transmission_error_phasors(mesh, count))


_GRID = 14
_POINTS = 128
_HIGHEST_MULTIPLE = 32
"""Highest multiple of the mesh frequency with a weight."""
_LONGEST_RELIEF = 0.95
"""Longest relief from the tip, over half of the path of contact."""
_SETTLED_PLACE, _SETTLED_VALUE, _MOST_REFINED = 1e-4, 1e-6, 200
"""End of the refinement: moves as parts of the largest relief, changes as parts of the value, number of trials."""
_DEEPEST = 3.0
"""Largest amount of relief, in mean deflections at the largest load."""


class ReliefAim(Protocol):
    """Objective of a relief: a value of the loaded mesh over one mesh period."""

    def of(self, mesh: LoadedMesh, contact: ToothContact) -> float:
        """Value of the objective for a loaded mesh and its flanks, at least 0."""


@dataclass(frozen=True)
class PeakToPeak:
    """Aim at the peak-to-peak transmission error [m]."""

    def of(self, mesh: LoadedMesh, contact: ToothContact) -> float:
        """Peak-to-peak transmission error [m]."""
        return mesh.peak_to_peak_transmission_error


@dataclass(frozen=True)
class WeightedHarmonics:
    """Aim at √(Σ (w_n e_n)²), e_n the amplitude of the transmission error at the n-th multiple of the mesh frequency.

    Attributes
    ----------
    weights : mapping of int to float
        Weight w_n by harmonic n from 1; at least one above 0.

    Raises
    ------
    GearError
        For weights that are negative, not finite or all 0, or multiples that are not from 1 to 32.
    """

    weights: Mapping[int, float]

    def __post_init__(self) -> None:
        """Check the multiples of the mesh frequency and their weights."""
        for multiple, weight in self.weights.items():
            if not 1 <= multiple <= _HIGHEST_MULTIPLE:
                raise GearError(
                    f"relief aim: multiples of the mesh frequency must be 1 to {_HIGHEST_MULTIPLE}, got {multiple}"
                )
            require_finite(f"relief aim: the weight of multiple {multiple}", weight, minimum=0.0)
        if not any(self.weights.values()):
            raise GearError("relief aim: at least one multiple of the mesh frequency must have a weight above 0")

    def of(self, mesh: LoadedMesh, contact: ToothContact) -> float:
        """Weighted root of the sum of squares, in metres times the weights' unit."""
        amplitudes = transmission_error_harmonics(mesh, max(self.weights))
        return math.sqrt(sum((weight * amplitudes[n - 1]) ** 2 for n, weight in self.weights.items()))


@dataclass(frozen=True, eq=False)
class ReliefOptimum:
    """Optimal relief, the same on both gears, and the grid of the search.

    Attributes
    ----------
    relief : TipRelief or None
        Optimal relief, by its length along the line of action; None where no relief of the search is an improvement.
    geometry : GearPairGeometry
        The pair with the relief.
    value : ndarray, shape (f,)
        Objective with the relief at each load.
    value_unmodified : ndarray, shape (f,)
        Objective without any tip relief at each load; its largest value is never below that of `value`.
    peak_to_peak : ndarray, shape (f,)
        Peak-to-peak transmission error with the relief at each load [m].
    unmodified : ndarray, shape (f,)
        Peak-to-peak transmission error without any tip relief at each load [m].
    amounts, lengths : ndarray, shapes (a,), (l,)
        Grid of the search [m].
    tried : ndarray, shape (a, l)
        Largest objective over the loads on the grid.
    """

    relief: TipRelief | None
    geometry: GearPairGeometry
    value: FloatArray
    value_unmodified: FloatArray
    peak_to_peak: FloatArray
    unmodified: FloatArray
    amounts: FloatArray
    lengths: FloatArray
    tried: FloatArray


@dataclass(frozen=True, eq=False)
class _Known:
    """Stiffness of the pair, which relief does not change, computed once."""

    stiffness: PiecewiseCubic
    shared: float

    def shared_compliance(self, geometry: GearPairGeometry) -> float:
        return self.shared

    def pair_stiffness(self, geometry: GearPairGeometry) -> PiecewiseCubic:
        return self.stiffness


def optimal_tip_relief(
    geometry: GearPairGeometry,
    model: StiffnessModel,
    forces: Sequence[float],
    *,
    shape: ReliefShape = "linear",
    corner_contact: bool = True,
    faces: FaceSlices | None = None,
    searched_faces: FaceSlices | None = None,
    aim: ReliefAim | None = None,
    tried: Callable[[float], None] = lambda fraction: None,
) -> ReliefOptimum:
    """Tip relief of both gears that minimises an objective, its largest value over the given loads.

    Amount and length are varied on a grid, and its best point is improved by the method of Nelder and Mead. The result
    is compared with no relief at all, and returned only where it is better. Any tip relief that the gears have is
    replaced; their other modifications and deviations stay.

    Parameters
    ----------
    geometry : GearPairGeometry
    model : StiffnessModel
    forces : sequence of float
        Loads along the line of action [N], above 0; one, or the range of operation.
    shape : {"linear", "parabolic"}
    corner_contact, faces
        As for `tooth_contact`.
    searched_faces : FaceSlices or None
        Coarser slices of the same face for the search alone; the result is that of `faces`.
    aim : ReliefAim or None
        `PeakToPeak` where not given.
    tried : callable
        Called with the completed part of the search, from 0 to 1, before each trial.

    Raises
    ------
    GearError
        Without a load, or a load that is not above 0.
    """
    if not forces:
        raise GearError("optimal relief: at least one load is needed")
    for force in forces:
        require_finite("optimal relief: the load", force, minimum=0.0, strict=True)
    stiffness = _Known(model.pair_stiffness(geometry), shared_compliance(model, geometry))
    faces, searched_faces = (
        None if face is None else slices_of_teeth(face, model, geometry)
        for face in (faces or aligned_slices(geometry), searched_faces)
    )

    target: ReliefAim = PeakToPeak() if aim is None else aim

    def with_relief(relief: TipRelief | None) -> GearPairGeometry:
        return replace(
            geometry,
            driver=replace(geometry.driver, tip_relief=relief),
            driven=replace(geometry.driven, tip_relief=relief),
        )

    def meshes(contact: ToothContact) -> list[LoadedMesh]:
        # Both sides of each step and every corner of this contact are among the phases.
        at = mesh_period_phases(contact, _POINTS)
        states = contact.pairs(at)
        return [loaded_transmission_error(contact, force, at, states=states) for force in forces]

    def worst(amount: float, length: float) -> float:
        inside = 0.0 <= amount <= deepest and shortest <= length <= longest
        if not inside:
            return float("inf")
        pair = with_relief(TipRelief(amount, length=length, shape=shape))
        contact = with_flanks_of(coarse, pair)
        return max(target.of(mesh, contact) for mesh in meshes(contact))

    bare = with_relief(None)
    plain = tooth_contact(bare, stiffness, corner_contact=corner_contact, faces=faces)
    coarse = plain if searched_faces is None else replace(plain, faces=searched_faces)
    # Counted from first touch, which crowning or a deviation shifts from nominal motion.
    loaded, unloaded = (loaded_transmission_error(plain, force) for force in (max(forces), 0.0))
    deflection = loaded.mean_transmission_error - unloaded.mean_transmission_error
    longest = _LONGEST_RELIEF * 0.5 * geometry.path_length
    shortest, deepest = 0.05 * longest, _DEEPEST * deflection
    amounts, lengths = np.linspace(0.0, deepest, _GRID + 1)[1:], np.linspace(shortest, longest, _GRID)
    grid = np.zeros((amounts.size, lengths.size))
    most = grid.size + _MOST_REFINED
    for number, (row, column) in enumerate(np.ndindex(grid.shape)):
        tried(number / most)
        grid[row, column] = worst(float(amounts[row]), float(lengths[column]))
    row, column = (int(place) for place in np.unravel_index(int(grid.argmin()), grid.shape))
    refined = itertools.count(grid.size)

    def scaled(x: FloatArray) -> float:
        tried(min(next(refined) / most, 1.0))
        return worst(float(x[0]) * deepest, float(x[1]) * longest)

    start = np.array([amounts[row] / deepest, lengths[column] / longest])
    settled = _SETTLED_VALUE * float(grid.min())
    optimum = minimize(
        scaled,
        start,
        method="Nelder-Mead",
        options={"xatol": _SETTLED_PLACE, "fatol": settled, "maxfev": _MOST_REFINED},
    )
    relief: TipRelief | None = TipRelief(
        float(optimum.x[0] * deepest), length=float(optimum.x[1] * longest), shape=shape
    )
    pair = with_relief(relief)
    contact = with_flanks_of(plain, pair)
    # The comparison uses all slices of the face; the search may use fewer.
    with_it, without = meshes(contact), meshes(plain)
    value, value_without = (
        np.array([target.of(mesh, flanks) for mesh in loaded])
        for loaded, flanks in ((with_it, contact), (without, plain))
    )
    if not value.max() < value_without.max():
        relief, pair, with_it, value = None, bare, without, value_without
    swings, swings_without = (
        np.array([mesh.peak_to_peak_transmission_error for mesh in loaded]) for loaded in (with_it, without)
    )
    return ReliefOptimum(relief, pair, value, value_without, swings, swings_without, amounts, lengths, grid)
