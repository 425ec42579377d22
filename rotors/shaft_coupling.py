"""Flexible coupling between two shafts on one axis."""

from dataclasses import dataclass

from .errors import require_finite

DAMPINGS = ("lateral_damping", "tilt_damping", "torsional_damping", "axial_damping")


@dataclass(frozen=True)
class Coupling:
    """A flexible coupling between two shafts on one axis, in their row of segments.

    Its compliances are spread evenly over its length, as those of a massless beam with κGA = k L, EI = k_t L,
    GJ = k_θ L and EA = k_z L; half of its mass is at either end.

    Parameters
    ----------
    length
        From hub to hub, m.
    lateral_stiffness, axial_stiffness
        k and k_z, N/m.
    tilt_stiffness, torsional_stiffness
        k_t against an angle between the axes and k_θ about them, N·m/rad.
    mass, polar_inertia, diametral_inertia
        Of the whole coupling, kg and kg·m².
    lateral_damping, axial_damping, tilt_damping, torsional_damping
        Dashpots beside the stiffnesses, N·s/m and N·m·s/rad: c of the coupled system, which turn with the shaft.

    Raises
    ------
    RotorError
        A length or stiffness that is not positive and finite, or a negative inertia or damping.
    """

    length: float
    lateral_stiffness: float
    tilt_stiffness: float
    torsional_stiffness: float
    axial_stiffness: float
    mass: float = 0.0
    polar_inertia: float = 0.0
    diametral_inertia: float = 0.0
    lateral_damping: float = 0.0
    tilt_damping: float = 0.0
    torsional_damping: float = 0.0
    axial_damping: float = 0.0

    def __post_init__(self) -> None:
        for what in ("length", "lateral_stiffness", "tilt_stiffness", "torsional_stiffness", "axial_stiffness"):
            require_finite(f"coupling {what}", getattr(self, what), positive=True)
        for what in ("mass", "polar_inertia", "diametral_inertia", *DAMPINGS):
            require_finite(f"coupling {what}", getattr(self, what), minimum=0.0)

    @property
    def is_damped(self) -> bool:
        """Whether it has damping."""
        return any(getattr(self, what) > 0.0 for what in DAMPINGS)

    @property
    def mass_centre(self) -> float:
        """Distance of the centre of mass from the left end, m."""
        return 0.5 * self.length

    @property
    def polar_centre(self) -> float:
        """Distance of the centre of the polar inertia from the left end, m."""
        return 0.5 * self.length
