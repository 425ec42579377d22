"""A shaft on two bearings under two belts, whose bearing forces are known by hand: the case of studies over its forces.

The left bearing carries 0.8 F1 + 0.2 F2, the right one 0.2 F1 + 0.8 F2.
"""

BELTED_SHAFT = """
title = "A shaft with two belts"
[material.steel]
youngs_modulus = "207 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"
[[rotor]]
name = "shaft"
material = "steel"
segments = [{ length = "500 mm", diameter = "30 mm" }]
[[bearing]]
name = "left"
rotor = "shaft"
at = "0 mm"
stiffness = { xx = "1e8 N/m", yy = "1e8 N/m" }
[[bearing]]
name = "right"
rotor = "shaft"
at = "500 mm"
stiffness = { xx = "1e8 N/m", yy = "1e8 N/m" }
[operation]
speed = "1000 rpm"
force = [
    { rotor = "shaft", at = "100 mm", x = "1000 N" },
    { rotor = "shaft", at = "400 mm", x = "500 N" },
]
"""
