"""Two spur gears in mesh: working centre distance, path of contact, and who touches where.

Position along the path of contact is counted in base pitches: a pair of teeth comes into contact at
``s = 0`` (the driven gear's tip meets the driver's root) and leaves at ``s = contact_ratio`` (the driver's
tip).  The dimensionless phase ``p = z_k theta_k / (2 pi)`` counts mesh periods; at phase ``p`` the pairs in
contact are at ``s = frac(p) + j``, j = 0, 1, ... while ``s < contact_ratio``.  The pair that enters at phase n
joins tooth ``n mod z_k`` of the driver and ``n mod z_i`` of the driven gear.

With base radii ``rb_k, rb_i``, centre distance ``a`` and working pressure angle ``w``, the distance of the
contact from the driver's tangent point is ``xi_k = xi_0 + s p_b`` with
``xi_0 = a sin(w) - sqrt(r_a,i^2 - rb_i^2)``, and ``xi_i = a sin(w) - xi_k`` from the driven's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.gears.errors import GearError, InterferenceError, MismatchedGearsError, NoContactError
from coupling.gears.geometry import Gear
from coupling.gears.involute import inverse_involute, involute

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True)
class GearPairGeometry:
    """A driver and a driven gear on parallel shafts.

    Parameters
    ----------
    driver, driven : Gear
    centre_distance : float or None
        Distance of the shafts [m]; None for the distance without backlash.

    Raises
    ------
    MismatchedGearsError
        Unequal module or pressure angle.
    InterferenceError
        Contact below the involute's start on either gear, or teeth thicker than their spaces.
    NoContactError
        Contact ratio below one.
    """

    driver: Gear
    driven: Gear
    centre_distance: float | None = None

    def __post_init__(self) -> None:
        self._check_match()
        self._check_distance()
        self._check_contact()

    # ---------------------------------------------------------- working values

    @property
    def label(self) -> str:
        """What messages call the pair."""
        return f"gear pair {self.driver.name!r} -> {self.driven.name!r}"

    @property
    def ratio(self) -> float:
        """Teeth of the driven over teeth of the driver: speeds divide by it."""
        return self.driven.teeth / self.driver.teeth

    @property
    def base_pitch(self) -> float:
        """Distance between neighbouring pairs along the line of action [m]."""
        return self.driver.base_pitch

    @property
    def close_pressure_angle(self) -> float:
        """Pressure angle of the mesh without backlash [rad].

        ``inv(w) = inv(alpha) + 2 tan(alpha) (x_k + x_i) / (z_k + z_i)``.
        """
        alpha = self.driver.pressure_angle
        shift = self.driver.profile_shift + self.driven.profile_shift
        value = involute(alpha) + 2.0 * math.tan(alpha) * shift / (self.driver.teeth + self.driven.teeth)
        if value < 0.0:
            raise InterferenceError(
                f"{self.label}: with profile shifts that sum to {shift:.4g} the teeth do not close at any distance"
            )
        return inverse_involute(value)

    @property
    def working_centre_distance(self) -> float:
        """Distance of the shafts [m]."""
        if self.centre_distance is not None:
            return self.centre_distance
        return self._base_radii_sum / math.cos(self.close_pressure_angle)

    @property
    def working_pressure_angle(self) -> float:
        """Angle of the line of action to the common tangent of the pitch circles [rad]."""
        if self.centre_distance is None:
            return self.close_pressure_angle
        return math.acos(self._base_radii_sum / self.centre_distance)

    @property
    def normal_backlash(self) -> float:
        """Gap of the idle flanks along their line of action, from the centre distance alone [m].

        ``2 (rb_k + rb_i) (inv(w) - inv(w_close))``; negative where the teeth would jam.
        """
        return (
            2.0 * self._base_radii_sum * (involute(self.working_pressure_angle) - involute(self.close_pressure_angle))
        )

    # --------------------------------------------------------- path of contact

    @property
    def path_length(self) -> float:
        """Length of the path of contact [m]."""
        return self._tip_reach(self.driver) + self._tip_reach(self.driven) - self._tangent_distance

    @property
    def contact_ratio(self) -> float:
        """Mean number of pairs in contact: path of contact over base pitch."""
        return self.path_length / self.base_pitch

    @property
    def pitch_point_position(self) -> float:
        """Position of the pitch point on the path of contact, in base pitches."""
        to_pitch_point = self.driver.base_radius * math.tan(self.working_pressure_angle)
        return (to_pitch_point - self._start_distance) / self.base_pitch

    @property
    def back_flank_offset(self) -> float:
        """Phase ``b`` such that the idle flanks' pairs are at ``s = frac(b - p) + j``, in 0 ... 1.

        The idle flanks are the mirror image of the working ones in the line of centres, running backwards:
        they touch the driver's tip first.  A tooth whose working flank is at ``xi`` has its idle flank at
        ``2 rb_k (w + psi_k) - xi``, ``psi_k`` half its angle on the base circle.
        """
        return self._back_flank_shift % 1.0

    def meeting_teeth(self, number: npt.ArrayLike) -> tuple[IntArray, IntArray]:
        """Teeth of driver and driven gear in the pairs that enter at whole phases `number`."""
        n = np.asarray(number, dtype=np.int64)
        return n % self.driver.teeth, n % self.driven.teeth

    def meeting_back_teeth(self, number: npt.ArrayLike) -> tuple[IntArray, IntArray]:
        """Teeth whose idle flanks meet in the pairs that enter at whole phases `number` of the idle flanks.

        With B the offset before its whole periods are dropped, the idle flank of driver tooth n is at
        ``s = B - p + n`` and so belongs to the pair that enters at ``-n - floor(B)`` of ``frac(B) - p``.  Its mate is
        the driven tooth that follows, n + 1: n itself is on the other side.
        """
        n = -np.asarray(number, dtype=np.int64) - math.floor(self._back_flank_shift)
        return n % self.driver.teeth, (n + 1) % self.driven.teeth

    def line_of_action_angle(self, centre_line_angle: float, sense: int = 1) -> float:
        """Angle from x of the unit vector along which the driver pushes the driven gear [rad].

        ``psi + s (pi/2 - w)``, with `centre_line_angle` psi the angle of the line from the driver's centre to
        the driven's and `sense` s = +1 where the driver turns counter-clockwise, -1 where clockwise.
        """
        if sense not in (1, -1):
            raise GearError(f"{self.label}: sense must be +1 or -1, got {sense!r}")
        return centre_line_angle + sense * (math.pi / 2.0 - self.working_pressure_angle)

    def driver_roll_angle(self, position: npt.ArrayLike) -> FloatArray:
        """Roll angle of the driver's contact point [rad] at `position` in base pitches."""
        return self._driver_distance(position) / self.driver.base_radius

    def driven_roll_angle(self, position: npt.ArrayLike) -> FloatArray:
        """Roll angle of the driven gear's contact point [rad] at `position` in base pitches."""
        return (self._tangent_distance - self._driver_distance(position)) / self.driven.base_radius

    def driver_radius(self, position: npt.ArrayLike) -> FloatArray:
        """Distance of the contact from the driver's centre [m] at `position` in base pitches."""
        return self.driver.base_radius * np.sqrt(1.0 + self.driver_roll_angle(position) ** 2)

    def driven_radius(self, position: npt.ArrayLike) -> FloatArray:
        """Distance of the contact from the driven gear's centre [m] at `position` in base pitches."""
        return self.driven.base_radius * np.sqrt(1.0 + self.driven_roll_angle(position) ** 2)

    def driver_position(self, roll_angle: float) -> float:
        """Position in base pitches where the driver's contact point has `roll_angle` [rad]."""
        return (roll_angle * self.driver.base_radius - self._start_distance) / self.base_pitch

    def driven_position(self, roll_angle: float) -> float:
        """Position in base pitches where the driven gear's contact point has `roll_angle` [rad]."""
        distance = self._tangent_distance - roll_angle * self.driven.base_radius
        return (distance - self._start_distance) / self.base_pitch

    # ------------------------------------------------------------------ inside

    @property
    def _base_radii_sum(self) -> float:
        return self.driver.base_radius + self.driven.base_radius

    @property
    def _tangent_distance(self) -> float:
        """Distance of the tangent points of the line of action on the two base circles [m]."""
        return self._base_radii_sum * math.tan(self.working_pressure_angle)

    @property
    def _back_flank_shift(self) -> float:
        """Sum of the positions of a driver tooth's working and idle flanks when it enters at phase 0 [base pitches]."""
        sum_of_distances = 2.0 * self.driver.base_radius * (self.working_pressure_angle + self.driver.base_half_angle)
        return (sum_of_distances - 2.0 * self._start_distance) / self.base_pitch

    @property
    def _start_distance(self) -> float:
        """Distance of the start of contact from the driver's tangent point [m]."""
        return self._tangent_distance - self._tip_reach(self.driven)

    @staticmethod
    def _tip_reach(gear: Gear) -> float:
        """Distance from a gear's tangent point to where its tip circle cuts the line of action [m]."""
        return math.sqrt(gear.tip_radius**2 - gear.base_radius**2)

    def _driver_distance(self, position: npt.ArrayLike) -> FloatArray:
        return self._start_distance + self.base_pitch * np.asarray(position, dtype=np.float64)

    def _check_match(self) -> None:
        for quantity, unit, scale in (("module", "mm", 1e3), ("pressure_angle", "degrees", 180.0 / math.pi)):
            first, second = getattr(self.driver, quantity), getattr(self.driven, quantity)
            # A thousandth is what printed sizes are rounded to (module 3.175 mm for 8 teeth per inch).
            if not math.isclose(first, second, rel_tol=1e-3):
                raise MismatchedGearsError(
                    f"{self.label}: both gears need the same {quantity}, "
                    f"got {first * scale:.8g} and {second * scale:.8g} {unit}"
                )

    def _check_distance(self) -> None:
        distance = self.centre_distance
        if distance is None:
            return
        if not (math.isfinite(distance) and distance > self._base_radii_sum):
            raise InterferenceError(
                f"{self.label}: the centre distance must exceed the sum of the base radii, "
                f"{self._base_radii_sum * 1e3:.6g} mm, got {distance * 1e3:.6g} mm"
            )
        # One per cent of a module is what cutting thins a tooth for backlash anyway.
        if self.normal_backlash < -0.01 * self.driver.module:
            close = self._base_radii_sum / math.cos(self.close_pressure_angle)
            raise InterferenceError(
                f"{self.label}: the teeth jam at a centre distance of {distance * 1e3:.6g} mm; "
                f"they mesh without backlash at {close * 1e3:.6g} mm"
            )

    def _check_contact(self) -> None:
        if self.contact_ratio < 1.0:
            raise NoContactError(
                f"{self.label}: the contact ratio is {self.contact_ratio:.4f}, below 1, at a centre distance of "
                f"{self.working_centre_distance * 1e3:.6g} mm; bring the shafts closer or lengthen the teeth"
            )
        ends = (
            (self.driver, self.driven, self._start_distance),
            (self.driven, self.driver, self._tangent_distance - self._tip_reach(self.driver)),
        )
        for rooted, tip, lowest in ends:
            form = rooted.roll_angle(rooted.form_radius) * rooted.base_radius
            if lowest < form - 1e-9 * rooted.module:
                raise InterferenceError(
                    f"{self.label}: the tip of {tip.name!r} reaches {(form - lowest) * 1e3:.4g} mm (along the line "
                    f"of action) below the involute of {rooted.name!r}; reduce the addendum of {tip.name!r} or "
                    f"the root_radius of {rooted.name!r}"
                )
            root_gap = self.working_centre_distance - tip.tip_radius - rooted.root_circle_radius
            if root_gap < 0.0:
                raise InterferenceError(
                    f"{self.label}: the tip of {tip.name!r} hits the root of {rooted.name!r} "
                    f"by {-root_gap * 1e3:.4g} mm"
                )
