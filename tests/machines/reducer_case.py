"""A two-stage spur reducer as the text of a case: three shafts on bearings on the ground, without a housing."""

from collections.abc import Sequence

_MODULE = 2.0  # mm


def reducer(teeth: Sequence[int] = (21, 72, 19, 56), *, unbalanced: str = "") -> str:
    """The case's text, of gears a to d; one shaft may be unbalanced."""
    first, second = (0.5 * _MODULE * (one + other) for one, other in (teeth[:2], teeth[2:]))
    lines = [
        'title = "Two-stage reducer"',
        "[material.steel]",
        'youngs_modulus = "206 GPa"',
        "poisson_ratio = 0.3",
        'density = "7850 kg/m^3"',
    ]
    # The output shaft begins beyond the wheel b, which reaches as far as its axis.
    shafts = (("input", -first, 0, 200), ("middle", 0.0, 0, 200), ("output", second, 80, 120))
    for name, place, start, length in shafts:
        lines += [
            "[[rotor]]",
            f'name = "{name}"',
            f'axis = ["{place} mm", "0 mm"]',
            f'start = "{start} mm"',
            'material = "steel"',
            "modes = 1",
            "damping_ratio = 0.01",
            f'segments = [{{ length = "{length} mm", diameter = "30 mm" }}]',
        ]
        if name == unbalanced:
            lines.append('unbalance = [{ at = "100 mm", moment = "2e-5 kg*m" }]')
        for at in (20, length - 20):
            lines += [
                "[[bearing]]",
                f'name = "{name}-{at}"',
                f'rotor = "{name}"',
                f'at = "{at} mm"',
                'stiffness = { xx = "2e8 N/m", yy = "2e8 N/m" }',
                'damping = { xx = "2000 N*s/m", yy = "2000 N*s/m" }',
            ]
    for name, rotor, at, number in zip(
        "abcd", ("input", "middle", "middle", "output"), (60, 60, 140, 60), teeth, strict=True
    ):
        lines += [
            "[[gear]]",
            f'name = "{name}"',
            f'rotor = "{rotor}"',
            f'at = "{at} mm"',
            f"teeth = {number}",
            f'module = "{_MODULE} mm"',
            'face_width = "20 mm"',
            'bore = "25 mm"',
        ]
    for driver, driven in ("ab", "cd"):
        lines += ["[[gear_pair]]", f'driver = "{driver}"', f'driven = "{driven}"', "damping_ratio = 0.05"]
    lines += ["[operation]", 'speed = "3000 rpm"', 'torque = "60 N*m"', ""]
    return "\n".join(lines)
