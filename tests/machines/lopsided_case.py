"""A gearbox with nothing alike: two stages on three shafts at odd angles, unequal bearings, sensors and unbalances.

What swaps two axes, signs, shafts, bearings or gear pairs changes its numbers. The housing is a coarse box.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import cos, pi, radians, sin

MODULE = 2e-3
PRESSURE_ANGLE = radians(20.0)
SPEED, TORQUE = 3000.0 * pi / 30.0, 45.0
LENGTH, START = 0.2, -0.1
DENSITY, BORE = 7850.0, 0.024
HELD_AT = {"back": 0.02, "front": 0.18}
"""Distance of the bearings from the left end of every shaft [m]."""
STIFFNESS = {
    # xx, yy, xy, yx in N/m
    ("input", "back"): (1.1e8, 1.6e8, 1.2e7, -0.4e7),
    ("input", "front"): (1.4e8, 0.9e8, -0.7e7, 0.3e7),
    ("middle", "back"): (1.7e8, 1.2e8, 0.5e7, 0.9e7),
    ("middle", "front"): (0.8e8, 1.3e8, 0.2e7, -0.6e7),
    ("output", "back"): (1.3e8, 1.9e8, -0.8e7, 0.4e7),
    ("output", "front"): (1.5e8, 1.0e8, 0.6e7, 0.1e7),
}


@dataclass(frozen=True)
class Gear:
    """A gear of the case: its shaft, its place on it [m] and its teeth."""

    rotor: str
    at: float
    teeth: int

    @property
    def base_radius(self) -> float:
        """In metres."""
        return 0.5 * MODULE * self.teeth * cos(PRESSURE_ANGLE)


GEARS = {
    "a": Gear("input", 0.06, 23),
    "b": Gear("middle", 0.06, 47),
    "c": Gear("middle", 0.13, 21),
    "d": Gear("output", 0.13, 50),
}
PAIRS = (("a", "b"), ("c", "d"))
_FIRST, _SECOND = 0.5 * MODULE * (23 + 47), 0.5 * MODULE * (21 + 50)
AXES = {
    "input": (-_FIRST * cos(radians(25.0)), 0.075 + _FIRST * sin(radians(25.0))),
    "middle": (0.0, 0.075),
    "output": (_SECOND * cos(radians(10.0)), 0.075 + _SECOND * sin(radians(10.0))),
}
"""x and y of each shaft [m]."""
SPEEDS = {"input": SPEED, "middle": -SPEED * 23 / 47, "output": SPEED * 23 / 47 * 21 / 50}
"""Signed [rad/s]."""
TORQUES = {("a", "b"): TORQUE, ("c", "d"): TORQUE * 47 / 23}
"""On each pair's driver [N m]."""
UNBALANCES = {"input": (0.05, 4e-5, 40.0), "output": (0.15, 9e-5, -70.0)}
"""Place [m], moment [kg m] and phase [deg]."""

FEW_WHIRLS = "rotor_analysis={ modes = 2, speed = ['3000 rpm'] }"
"""A setting for tests that look at no rotor alone, whose modes at many speeds take seconds."""


def force(pair: tuple[str, str]) -> float:
    """Mean force along the line of action of a pair [N]."""
    return TORQUES[pair] / GEARS[pair[0]].base_radius


def push(pair: tuple[str, str]) -> tuple[float, float]:
    """Unit vector of the force of the driver on the driven gear.

    At the pitch point the driver's surface moves along z x n (n from the driver's centre to the other's, for a turn
    counter-clockwise); the force is that direction turned by the pressure angle towards n.
    """
    driver, driven = (AXES[GEARS[name].rotor] for name in pair)
    nx, ny = driven[0] - driver[0], driven[1] - driver[1]
    size = (nx**2 + ny**2) ** 0.5
    nx, ny = nx / size, ny / size
    sense = 1.0 if SPEEDS[GEARS[pair[0]].rotor] > 0.0 else -1.0
    tx, ty = -sense * ny, sense * nx
    c, s = cos(PRESSURE_ANGLE), sin(PRESSURE_ANGLE)
    return tx * c + nx * s, ty * c + ny * s


def bearing_share(bearing: str, at: float) -> float:
    """Part of a force across the shaft at a place [m] that one of two bearings carries, by the lever."""
    back, front = HELD_AT["back"], HELD_AT["front"]
    part = (at - back) / (front - back)
    return part if bearing == "front" else 1.0 - part


def bearing_forces(mesh_forces: dict[tuple[str, str], complex]) -> dict[str, tuple[complex, complex]]:
    """x and y of the force of every shaft on its bearings under mesh forces alone, by statics."""
    found = {}
    for rotor in AXES:
        for bearing in HELD_AT:
            x = y = 0.0 + 0.0j
            for pair, size in mesh_forces.items():
                ex, ey = push(pair)
                for name, side in zip(pair, (-1.0, 1.0), strict=True):
                    gear = GEARS[name]
                    if gear.rotor == rotor:
                        share = side * size * bearing_share(bearing, gear.at)
                        x, y = x + share * ex, y + share * ey
            found[f"{rotor}-{bearing}"] = (x, y)
    return found


def imbalance(
    rotor: str,
    mesh_forces: Mapping[tuple[str, str], complex],
    forces: Mapping[str, Sequence[complex]],
    moments: Mapping[str, Sequence[complex]],
) -> tuple[complex, complex, complex, complex]:
    """What of the forces x, y on a shaft [N] and of their moments about x, y at its left end [N m] is left.

    Forces and moments are those of the shaft on its bearings, by the bearings' names.
    """
    left = [0.0 + 0.0j] * 4

    def add(at: float, x: complex, y: complex, about_x: complex = 0.0, about_y: complex = 0.0) -> None:
        for place, part in enumerate((x, y, about_x - at * y, about_y + at * x)):
            left[place] += part

    for pair, size in mesh_forces.items():
        ex, ey = push(pair)
        for name, side in zip(pair, (-1.0, 1.0), strict=True):
            if GEARS[name].rotor == rotor:
                add(GEARS[name].at, side * size * ex, side * size * ey)
    for end, at in HELD_AT.items():
        force_x, force_y = forces[f"{rotor}-{end}"]
        about_x, about_y = moments[f"{rotor}-{end}"]
        add(at, -force_x, -force_y, -about_x, -about_y)
    return left[0], left[1], left[2], left[3]


HALF_FACE = 0.009
"""Half the width of the gears' faces [m]: no further from their middle does a mesh force act."""


def polar_inertia(rotor: str) -> float:
    """Of a shaft's two lengths and its gears as rings from bore to pitch circle [kg m²]."""
    rings = [(0.09, 0.032, 0.0), (0.11, 0.026, 0.0)]
    rings += [(0.018, MODULE * gear.teeth, BORE) for gear in GEARS.values() if gear.rotor == rotor]
    return sum(DENSITY * length * pi / 32.0 * (outer**4 - inner**4) for length, outer, inner in rings)


def lopsided(*, housing: bool = True, spatial: bool = False, limit: float = 2500.0, more: str = "") -> str:
    """The case's text.

    Without the housing its bearings stand on the ground. Where it is spatial, the output's hold tilts and z too. The
    limit is of the housing's modes [Hz].
    """
    lines = [
        'title = "Lopsided gearbox"',
        "[material.steel]",
        'youngs_modulus = "206 GPa"',
        "poisson_ratio = 0.3",
        f'density = "{DENSITY} kg/m^3"',
    ]
    if housing:
        lines += [
            "[housing]",
            'material = "steel"',
            "damping_ratio = 0.02",
            f'frequency_limit = "{limit} Hz"',
            "[housing.box]",
            'size = ["270 mm", "150 mm", "160 mm"]',
            'wall = "10 mm"',
            'mesh_size = "50 mm"',
        ]
        lines += [
            line
            for rotor, (x, y) in AXES.items()
            for bearing, at in HELD_AT.items()
            for line in (
                "[[housing.seat]]",
                f'name = "{rotor}-{bearing}"',
                f'center = ["{x} m", "{y} m", "{START + at} m"]',
                'diameter = "42 mm"',
            )
        ]
        lines += [
            "[[housing.support]]",
            'name = "ground"',
            'surface = "bottom"',
            'stiffness = { x = "4e8 N/m", y = "6e8 N/m", z = "5e8 N/m" }',
            "[[housing.sensor]]",
            'name = "cover"',
            'position = ["30 mm", "150 mm", "20 mm"]',
            'direction = "y"',
            "[[housing.sensor]]",
            'name = "wall"',
            'position = ["135 mm", "60 mm", "-30 mm"]',
            'direction = "x"',
        ]
    for rotor, (x, y) in AXES.items():
        lines += [
            "[[rotor]]",
            f'name = "{rotor}"',
            f'axis = ["{x} m", "{y} m"]',
            f'start = "{START} m"',
            'material = "steel"',
            "modes = 3",
            "damping_ratio = 0.01",
            'segments = [{ length = "90 mm", diameter = "32 mm" }, { length = "110 mm", diameter = "26 mm" }]',
        ]
        if rotor in UNBALANCES:
            at, moment, phase = UNBALANCES[rotor]
            lines.append(f'unbalance = [{{ at = "{at} m", moment = "{moment} kg*m", phase = "{phase} deg" }}]')
    for (rotor, bearing), (xx, yy, xy, yx) in STIFFNESS.items():
        lines += [
            "[[bearing]]",
            f'name = "{rotor}-{bearing}"',
            f'rotor = "{rotor}"',
            f'at = "{HELD_AT[bearing]} m"',
            f"stiffness = {{ matrix = {_spatial(xx, yy, xy, yx)} }}"
            if spatial and rotor == "output"
            else f'stiffness = {{ xx = "{xx} N/m", yy = "{yy} N/m", xy = "{xy} N/m", yx = "{yx} N/m" }}',
            'damping = { xx = "900 N*s/m", yy = "600 N*s/m" }',
        ]
        if housing:
            lines.append(f'seat = "{rotor}-{bearing}"')
    for name, gear in GEARS.items():
        lines += [
            "[[gear]]",
            f'name = "{name}"',
            f'rotor = "{gear.rotor}"',
            f'at = "{gear.at} m"',
            f"teeth = {gear.teeth}",
            f'module = "{MODULE} m"',
            'face_width = "18 mm"',
            f'bore = "{BORE} m"',
        ]
    for driver, driven in PAIRS:
        lines += ["[[gear_pair]]", f'driver = "{driver}"', f'driven = "{driven}"', "damping_ratio = 0.06"]
    lines += ["[operation]", f'speed = "{SPEED} rad/s"', f'torque = "{TORQUE} N*m"', more, ""]
    return "\n".join(lines)


def _spatial(xx: float, yy: float, xy: float, yx: float) -> list[list[float]]:
    """Over x, y, z and the tilts about x and y [N/m, N m/rad]."""
    return [
        [xx, xy, 0.0, 0.0, 1.5e5],
        [yx, yy, 0.0, -2.5e5, 0.0],
        [0.0, 0.0, 4.0e7, 0.0, 0.0],
        [0.0, -2.5e5, 0.0, 3.0e4, 4.0e3],
        [1.5e5, 0.0, 0.0, -2.0e3, 5.0e4],
    ]
