"""Choice of the tooth stiffness model by name: stiffness of one pair of teeth along the path of contact.

Every model is a small frozen dataclass with one method, ``pair_stiffness(geometry)``, that returns the stiffness of a
single pair [N/m along the line of action] as a function of the position in base pitches.  Its range is the range of
contact: the contact ratio, or exactly 1 for models that describe the whole mesh as one spring.

============================  =====================================================================
name                          model
============================  =====================================================================
``"potential-energy"``        energy method, Sainsot's body, constant contact (Ma et al. 2014)
``"elastic-ring"``            energy method on an exact elastic ring, Weber's contact
``"cornell"``                 Cornell (1981), as in NASA's gear dynamics
``"weber-banaschek"``         Weber and Banaschek (1953)
``"iso6336"``                 ISO 6336-1 method B: its maximum c' and its mean c_gamma, as a parabola
``"square"``                  every pair the same constant: a square wave in the mesh
``"constant"``                the whole mesh one constant spring
``"table"``                   given values, of a pair or of the whole mesh
============================  =====================================================================

The first four, subclasses of `CompliantTeeth`, know the bodies of the gears, which pairs in contact at once share
(`shared_compliance`).  The others state the stiffness of a pair or of the mesh as it is given, and the pairs act in
parallel. The given springs, `GIVEN_SPRINGS`, lie evenly over the face, without coupling of its slices.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np

from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.gears.errors import StiffnessModelError
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry
from gearwhine.coupling.gears.piecewise_cubic import PiecewiseCubic
from gearwhine.coupling.gears.stiffness.compliant_teeth import CompliantTeeth, RimCompliance
from gearwhine.coupling.gears.stiffness.foundation import require_thick_ring
from gearwhine.coupling.gears.stiffness.iso6336 import Iso6336Stiffness, iso6336_stiffness
from gearwhine.coupling.gears.stiffness.tooth_compliance import (
    CornellStiffness,
    ElasticRingStiffness,
    PotentialEnergyStiffness,
    WeberBanaschekStiffness,
)
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.own_copies import keep_arrays


class StiffnessModel(Protocol):
    """Stiffness of a pair of teeth along its path of contact."""

    def pair_stiffness(self, geometry: GearPairGeometry) -> PiecewiseCubic:
        """Stiffness [N/m] by position in base pitches, from 0 to the contact ratio (or 1)."""
        ...


@runtime_checkable
class SharingModel(StiffnessModel, Protocol):
    """A stiffness model with the compliance that pairs in contact at once share: that of the gears' bodies."""

    def shared_compliance(self, geometry: GearPairGeometry) -> float:
        """Compliance that pairs of teeth in contact at once share [m/N]."""
        ...


def shared_compliance(model: StiffnessModel, geometry: GearPairGeometry) -> float:
    """Compliance that pairs of teeth in contact at once share [m/N]; 0 for a model that states stiffnesses alone."""
    return model.shared_compliance(geometry) if isinstance(model, SharingModel) else 0.0


_VARIATION_OF_A_RIM = 0.1
"""Variation of a rim's compliance between bolts, over a pair's compliance, above which a warning tells it."""


def ring_support_warning(model: StiffnessModel | str, geometry: GearPairGeometry) -> str | None:
    """Sentence where the bolts or pins of a ring vary the mesh beyond its mean, or the model knows none; else None."""
    named = stiffness_model(model) if isinstance(model, str) and model in _KNOW_BODIES else model
    middle = 0.5 * geometry.contact_ratio
    radii = geometry.driver_radius(middle), geometry.driven_radius(middle)
    for gear, radius in zip((geometry.driver, geometry.driven), radii, strict=True):
        support = gear.ring_support
        if support is None or support.kind in ("clamped", "housing"):
            continue
        if not isinstance(named, CompliantTeeth):
            name = named if isinstance(named, str) else getattr(named, "name", type(named).__name__)
            return (
                f"{geometry.label}: the stiffness model {name!r} does not know the support of the ring {gear.name!r} "
                f"by {support.kind}; choose one that does: {', '.join(_KNOW_BODIES)}"
            )
        course, pair = named.support_course(gear, float(radius)), float(named.pair_compliance(geometry, middle))
        if float(np.ptp(course)) > _VARIATION_OF_A_RIM * pair:
            softest, stiffest = (1e-6 / (pair - course.mean() + end) for end in (course.max(), course.min()))
            return (
                f"{geometry.label}: between the {support.count} {support.kind} of the ring {gear.name!r} a pair of "
                f"teeth is {softest:.4g} to {stiffest:.4g} MN/m stiff by its place; the mesh has the mean over all "
                f"places, {1e-6 / pair:.4g} MN/m, and its change as the mesh passes them does not excite"
            )
    return None


def rim_compliances(model: StiffnessModel | str, geometry: GearPairGeometry) -> tuple[RimCompliance, RimCompliance]:
    """Parts of `shared_compliance` by which the rims of the driver and of the driven gear move on their hubs.

    They depend on no load, so a model may be given by its name.
    """
    named = stiffness_model(model) if isinstance(model, str) else model
    if isinstance(named, CompliantTeeth):
        return named.rim_compliances(geometry)
    return RimCompliance(), RimCompliance()


@dataclass(frozen=True)
class SquareStiffness:
    """Each pair has the same stiffness while it touches; of helical teeth in proportion to the part that touches.

    Parameters
    ----------
    value : float
        Stiffness of one pair [N/m].
    contact_ratio : float or None
        Contact ratio in place of the geometry's, where a source prints the ratio but not the teeth.
    """

    name: ClassVar[str] = "square"
    value: float
    contact_ratio: float | None = None

    def __post_init__(self) -> None:
        """Check the stiffness and the contact ratio."""
        _require_positive(self)
        if self.contact_ratio is not None and not 1.0 <= self.contact_ratio < math.inf:
            raise StiffnessModelError(
                f"stiffness model 'square': contact_ratio must be at least 1, got {self.contact_ratio!r}"
            )

    def pair_stiffness(self, geometry: GearPairGeometry) -> PiecewiseCubic:
        """Stiffness [N/m] by position."""
        return piecewise.constant(self.value, self.contact_ratio or geometry.contact_ratio)


@dataclass(frozen=True)
class ConstantStiffness:
    """The mesh is one spring of constant stiffness `value` [N/m]."""

    name: ClassVar[str] = "constant"
    value: float

    def __post_init__(self) -> None:
        """Check the stiffness."""
        _require_positive(self)

    def pair_stiffness(self, geometry: GearPairGeometry) -> PiecewiseCubic:
        """Stiffness [N/m] over one mesh period."""
        del geometry
        return piecewise.constant(self.value, 1.0)


@dataclass(frozen=True, eq=False)
class TableStiffness:
    """Stiffness from a table, of the whole mesh over a period or of one pair over its contact.

    Parameters
    ----------
    position : ndarray, shape (n,)
        Positions in base pitches (mesh periods), from 0, increasing.  Ending at 1 the table is of the whole mesh;
        ending at the contact ratio it is of one pair.
    stiffness : ndarray, shape (n,)
        Stiffness [N/m], positive.
    """

    name: ClassVar[str] = "table"
    position: FloatArray
    stiffness: FloatArray

    def __post_init__(self) -> None:
        """Keep own copies, and check the columns of the table."""
        keep_arrays(self, "position", "stiffness")
        position, stiffness = self.position, self.stiffness
        if position.ndim != 1 or position.size < 2 or position.shape != stiffness.shape:
            raise StiffnessModelError(
                f"a stiffness table needs two equally long columns of at least 2 rows, "
                f"got {position.shape} and {stiffness.shape}"
            )
        if position[0] != 0.0 or not np.all(np.diff(position) > 0.0) or not np.isfinite(position[-1]):
            raise StiffnessModelError("stiffness table: positions must start at 0 and increase")
        if not (np.all(np.isfinite(stiffness)) and np.all(stiffness > 0.0)):
            raise StiffnessModelError(
                f"stiffness table: every stiffness must be positive, got a least of {np.min(stiffness):.4g} N/m"
            )

    def pair_stiffness(self, geometry: GearPairGeometry) -> PiecewiseCubic:
        """Stiffness [N/m] by position.

        Raises
        ------
        StiffnessModelError
            When the table ends neither at 1 nor at the pair's contact ratio.
        """
        end = float(self.position[-1])
        for wanted in (1.0, geometry.contact_ratio):
            if math.isclose(end, wanted, rel_tol=1e-3):
                # A table printed with a few digits ends exactly where the contact does.
                return piecewise.through_points(self.position * (wanted / end), self.stiffness)
        raise StiffnessModelError(
            f"{geometry.label}: the stiffness table ends at {end:.6g} base pitches; expected 1 (whole mesh) "
            f"or the contact ratio {geometry.contact_ratio:.6g} (one pair)"
        )


STIFFNESS_MODELS: dict[str, Callable[..., StiffnessModel]] = {
    model.name: model
    for model in (
        PotentialEnergyStiffness,
        ElasticRingStiffness,
        CornellStiffness,
        WeberBanaschekStiffness,
        Iso6336Stiffness,
        SquareStiffness,
        ConstantStiffness,
        TableStiffness,
    )
}
"""All models by their names in cases: a new model is added here."""

_KNOW_BODIES = tuple(
    name for name, model in STIFFNESS_MODELS.items() if isinstance(model, type) and issubclass(model, CompliantTeeth)
)

GIVEN_SPRINGS = (ConstantStiffness, SquareStiffness, TableStiffness)
"""Models that state a spring as it is given, of the mesh or of every pair, in place of the teeth."""


def stiffness_model(name: str, **parameters: object) -> StiffnessModel:
    """Model by name, e.g. ``stiffness_model("square", value=2e8)``.

    Raises
    ------
    StiffnessModelError
        For an unknown name, or parameters that the model does not take or misses.
    """
    require_known_model(name)
    try:
        return STIFFNESS_MODELS[name](**parameters)
    except TypeError as error:
        raise StiffnessModelError(f"stiffness model {name!r}: {error}") from error


def require_known_model(name: str) -> None:
    """Raise `StiffnessModelError` for a name that no model has."""
    if name not in STIFFNESS_MODELS:
        raise StiffnessModelError(f"unknown stiffness model {name!r}; expected one of {', '.join(STIFFNESS_MODELS)}")


def require_model_fit(name: str, geometry: GearPairGeometry) -> None:
    """Refuse gears that a model by name does not cover, before it is solved.

    Raises
    ------
    StiffnessModelError
        For a thin ring under "potential-energy", or profile shifts beyond those of "iso6336".
    """
    if name == PotentialEnergyStiffness.name:
        for gear in (geometry.driver, geometry.driven):
            if not gear.is_internal:
                require_thick_ring(gear)
    elif name == Iso6336Stiffness.name:
        iso6336_stiffness(geometry)


def stiffness_under_load(name: str, geometry: GearPairGeometry, force: float) -> StiffnessModel:
    """Model by name at the load of a pair, where it depends on the load.

    Parameters
    ----------
    name : str
        A key of `STIFFNESS_MODELS`.
    geometry : GearPairGeometry
    force : float
        Mean load along the line of action [N]; 0 for the model's own reference load.

    Raises
    ------
    StiffnessModelError
        See `stiffness_model`.
    """
    model = stiffness_model(name)
    if force > 0.0 and isinstance(model, Iso6336Stiffness):
        # F_t / b: tangential force at the reference circle over the common width, as the norm's load per width.
        tangential = force * geometry.driver.base_radius / geometry.driver.pitch_radius
        return replace(model, specific_load=tangential / geometry.face_width)
    if force > 0.0 and isinstance(model, CompliantTeeth) and model.contact == "weber":
        # The Hertzian contact stiffens with the load; it is frozen where one pair carries all of it.
        return replace(model, force=force)
    return model


def follows_load(stiffness: StiffnessModel | str) -> bool:
    """Whether the stiffness of a pair follows its load, see `stiffness_under_load`: that of a model by name alone."""
    model = stiffness_model(stiffness) if isinstance(stiffness, str) else None
    return isinstance(model, Iso6336Stiffness) or (isinstance(model, CompliantTeeth) and model.contact == "weber")


def _require_positive(model: SquareStiffness | ConstantStiffness) -> None:
    if not (math.isfinite(model.value) and model.value > 0.0):
        raise StiffnessModelError(f"stiffness model {model.name!r}: value must be above 0 N/m, got {model.value!r}")
