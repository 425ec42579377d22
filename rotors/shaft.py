"""The rotor as the user describes it: round segments end to end, and rigid discs on them."""

import math
from bisect import bisect_left
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, TypeVar, cast

import numpy as np
import numpy.typing as npt

from .errors import RotorError, require, require_finite
from .material import ShaftMaterial
from .profile import Profile, profile_of
from .segment import Segment
from .shaft_coupling import Coupling

FloatArray = npt.NDArray[np.float64]
MassModel = Literal["distributed", "lumped"]
Made = TypeVar("Made")

# Two positions closer than this fraction of the rotor's length are one station: sums of printed
# segment lengths differ from printed positions by rounding alone.
STATION_TOLERANCE = 1e-9
# So many things made of a rotor are held by it.
MOST_HELD = 16


@dataclass(frozen=True)
class Disc:
    """A rigid body fixed to the shaft at a point; with zero inertias, a point mass.

    Parameters
    ----------
    at
        Position from the rotor's left end, m.
    mass
        kg.
    polar_inertia, diametral_inertia
        About the axis and about a diameter, kg·m².
    """

    at: float
    mass: float
    polar_inertia: float = 0.0
    diametral_inertia: float = 0.0

    def __post_init__(self) -> None:
        require_finite("disc position", self.at, minimum=0.0)
        require_finite("disc mass", self.mass, minimum=0.0)
        require_finite("disc polar_inertia", self.polar_inertia, minimum=0.0)
        require_finite("disc diametral_inertia", self.diametral_inertia, minimum=0.0)

    @classmethod
    def from_dimensions(
        cls, at: float, width: float, outer_diameter: float, inner_diameter: float, density: float
    ) -> "Disc":
        """Disc of a round ring of the given width and diameters (m) and density (kg/m³)."""
        ring = Segment(width, outer_diameter, inner_diameter, ShaftMaterial(1.0, 0.5, density))
        return cls(at, ring.mass, ring.polar_inertia, ring.diametral_inertia)


@dataclass(frozen=True)
class Rotor:
    """A shaft of segments, left to right, carrying discs.

    Parameters
    ----------
    name
        What messages call it.
    segments
        At least one `Segment`, from the left end; a `Coupling` may stand between them.
    discs
        Any number of `Disc`; several may share a place.
    mass_model
        ``"distributed"``: every segment is an exact Timoshenko beam and rod with its own mass.
        ``"lumped"``: every segment is massless and its inertias go to its two ends (`rotors.lumped`).

    Raises
    ------
    RotorError
        No segments, a disc beyond the shaft, an unknown mass model, or a rotor without mass.
    """

    name: str
    segments: Sequence[Segment | Coupling]
    discs: Sequence[Disc] = ()
    mass_model: MassModel = "distributed"

    def __post_init__(self) -> None:
        object.__setattr__(self, "segments", tuple(self.segments))
        object.__setattr__(self, "discs", tuple(self.discs))
        where = f"rotor {self.name!r}"
        if not self.segments:
            raise RotorError(f"{where} has no segments; expected at least one")
        known = self.mass_model in ("distributed", "lumped")
        require(known, f"{where} mass_model", self.mass_model, "'distributed' or 'lumped'")
        for disc in self.discs:
            self.require_on_shaft(f"{where} disc", disc.at)
        require(self.mass > 0.0, f"{where} mass", self.mass, "a positive mass, of segments or of discs")

    def require_on_shaft(self, what: str, at: float) -> None:
        """Raise `RotorError` unless ``at`` (m from the left end) is a finite place on the shaft."""
        slack = STATION_TOLERANCE * self.length
        inside = math.isfinite(at) and -slack <= at <= self.length + slack
        require(inside, f"{what} position", at, f"a place on the shaft, 0 to {self.length:g} m")

    @cached_property
    def joints(self) -> FloatArray:
        """Positions of the segments' ends, (segments + 1,), m."""
        # Extended precision, because 400 rounded additions would move the right end.
        lengths = np.array([0.0, *(segment.length for segment in self.segments)], dtype=np.longdouble)
        return np.cumsum(lengths).astype(np.float64)

    @cached_property
    def profile(self) -> Profile:
        """Stiffness and inertia along the shaft, as its transfer matrices take them."""
        return profile_of(self.segments, self.joints)

    def once(self, make: Callable[..., Made], *given: Hashable) -> Made:
        """``make(rotor, *given)``, made the first time and held: for what does not change with speed or frequency.

        What is given must be of kinds that never change, as a rotor and its bearings. A few such things are held, those
        made last.
        """
        key = (make, *given)
        if key not in self._held:
            made = make(self, *given)
            if len(self._held) >= MOST_HELD:
                self._held.pop(next(iter(self._held)), None)
            self._held[key] = made
        return cast(Made, self._held[key])

    @cached_property
    def _held(self) -> dict[tuple[Hashable, ...], object]:
        return {}

    @property
    def length(self) -> float:
        """Length of the shaft, m."""
        return float(self.joints[-1])

    @property
    def stations(self) -> FloatArray:
        """Segment ends and disc positions, ascending, each place once, (stations,), m."""
        return merged_positions(self.joints, [disc.at for disc in self.discs])

    @cached_property
    def mass(self) -> float:
        """Total mass, kg."""
        return math.fsum([part.mass for part in self.segments] + [disc.mass for disc in self.discs])

    @cached_property
    def is_compressed(self) -> bool:
        """Whether an axial force compresses some part of the shaft."""
        return any(isinstance(part, Segment) and part.axial_force < 0.0 for part in self.segments)

    @property
    def polar_inertia(self) -> float:
        """Total moment of inertia about the axis, kg·m²."""
        return math.fsum([part.polar_inertia for part in self.segments] + [d.polar_inertia for d in self.discs])

    @property
    def centre_of_mass(self) -> float:
        """Distance of the centre of mass from the left end, m."""
        lefts = self.joints[:-1].tolist()
        moments = [part.mass * (left + part.mass_centre) for part, left in zip(self.segments, lefts, strict=True)]
        return math.fsum([*moments, *(disc.mass * disc.at for disc in self.discs)]) / self.mass


def merged_positions(joints: FloatArray, others: Sequence[float]) -> FloatArray:
    """Joints and other positions, ascending; one that lies on a joint or another position is that one.

    Parameters
    ----------
    joints
        Ascending positions that stay exactly as they are, (n,), m.
    others
        Further positions on the shaft, m.
    """
    known = joints.tolist()
    slack = STATION_TOLERANCE * known[-1]
    kept: list[float] = []
    for place in sorted(float(other) for other in others):
        right = min(max(bisect_left(known, place), 1), len(known) - 1)
        near = min(abs(place - known[right - 1]), abs(place - known[right])) <= slack
        if not near and (not kept or place - kept[-1] > slack):
            kept.append(place)
    return np.sort(np.concatenate([joints, kept])) if kept else joints


def station_index(stations: FloatArray, at: float) -> int:
    """Index of the station at the position ``at`` (m), which must be one of them."""
    return int(np.abs(stations - at).argmin())
