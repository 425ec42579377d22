"""Tip relief that makes the transmission error least: how much, and from where."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize

from coupling.gears.errors import GearError, require_finite
from coupling.gears.face_slices import FaceSlices
from coupling.gears.gear_contact import tooth_contact
from coupling.gears.modifications import ReliefShape, TipRelief
from coupling.gears.pair_geometry import GearPairGeometry
from coupling.gears.piecewise import PiecewiseCubic
from coupling.gears.static import static_transmission_error
from coupling.gears.stiffness_models import StiffnessModel, shared_compliance
from coupling.gears.tooth_contact import ToothContact

FloatArray = npt.NDArray[np.float64]

_GRID = 14
_POINTS = 128
_LONGEST = 0.95
"""In halves of the path of contact: how far the relief may reach from the tip."""
_DEEPEST = 3.0
"""In mean deflections at the largest load: how deep the relief may be."""


@dataclass(frozen=True, eq=False)
class ReliefOptimum:
    """The best relief, the same on both gears, and what was tried on the way.

    Attributes
    ----------
    relief : TipRelief
        By its length along the line of action.
    geometry : GearPairGeometry
        The pair with it.
    peak_to_peak : ndarray, shape (f,)
        Transmission error with it at each load [m].
    unmodified : ndarray, shape (f,)
        The same without any tip relief [m].
    amounts, lengths : ndarray, shapes (a,), (l,)
        Tried on a grid [m].
    tried : ndarray, shape (a, l)
        Largest peak to peak over the loads there [m].
    """

    relief: TipRelief
    geometry: GearPairGeometry
    peak_to_peak: FloatArray
    unmodified: FloatArray
    amounts: FloatArray
    lengths: FloatArray
    tried: FloatArray


@dataclass(frozen=True, eq=False)
class _Known:
    """A stiffness that relief does not change, computed once."""

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
) -> ReliefOptimum:
    """Tip relief of both gears with the least transmission error, the largest over the given loads.

    Amount and length are tried on a grid, and the best place of it is improved by the method of Nelder and Mead. Any
    tip relief that the gears have is replaced; their other modifications and deviations stay.

    Parameters
    ----------
    geometry : GearPairGeometry
    model : StiffnessModel
    forces : sequence of float
        Loads along the line of action [N], above 0; one, or those between which the gears work.
    shape : {"linear", "parabolic"}
    corner_contact, faces
        As for `tooth_contact`.

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
    phases = np.arange(_POINTS) / _POINTS

    def contact_of(relief: TipRelief | None) -> tuple[GearPairGeometry, ToothContact]:
        pair = replace(
            geometry,
            driver=replace(geometry.driver, tip_relief=relief),
            driven=replace(geometry.driven, tip_relief=relief),
        )
        return pair, tooth_contact(pair, stiffness, corner_contact=corner_contact, faces=faces)

    def swings(contact: ToothContact) -> FloatArray:
        return np.array([static_transmission_error(contact, f, phases).peak_to_peak_transmission_error for f in forces])

    def worst(amount: float, length: float) -> float:
        inside = 0.0 <= amount <= deepest and shortest <= length <= longest
        if not inside:
            return float("inf")
        return float(swings(contact_of(TipRelief(amount, length=length, shape=shape))[1]).max())

    _, plain = contact_of(None)
    # Counted from first touch, which a crown or a deviation puts before or after nominal motion.
    loaded, unloaded = (static_transmission_error(plain, force, phases) for force in (max(forces), 0.0))
    deflection = loaded.mean_transmission_error - unloaded.mean_transmission_error
    longest = _LONGEST * 0.5 * geometry.path_length
    shortest, deepest = 0.05 * longest, _DEEPEST * deflection
    amounts, lengths = np.linspace(0.0, deepest, _GRID + 1)[1:], np.linspace(shortest, longest, _GRID)
    tried = np.array([[worst(float(amount), float(length)) for length in lengths] for amount in amounts])
    row, column = np.unravel_index(int(tried.argmin()), tried.shape)

    def scaled(x: FloatArray) -> float:
        return worst(float(x[0]) * deepest, float(x[1]) * longest)

    start = np.array([amounts[row] / deepest, lengths[column] / longest])
    found = minimize(scaled, start, method="Nelder-Mead", options={"xatol": 1e-4, "fatol": 1e-12, "maxfev": 200})
    relief = TipRelief(float(found.x[0] * deepest), length=float(found.x[1] * longest), shape=shape)
    pair, contact = contact_of(relief)
    return ReliefOptimum(relief, pair, swings(contact), swings(plain), amounts, lengths, tried)
