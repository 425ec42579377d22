"""The bundled spur pair with a third gear behind its wheel, which is an idler then: both meshes have one frequency."""

from importlib.resources import files
from pathlib import Path

BEHIND = """
[[rotor]]
name = "third"
axis = ["133.35 mm", "0 mm"]
start = "-100 mm"
material = "steel"
segments = [{ length = "200 mm", diameter = "30 mm" }]

[[bearing]]
name = "third-back"
rotor = "third"
at = "20 mm"
stiffness = { xx = "1.2e8 N/m", yy = "1.2e8 N/m" }
damping = { xx = "500 N*s/m", yy = "500 N*s/m" }

[[bearing]]
name = "third-front"
rotor = "third"
at = "180 mm"
stiffness = { xx = "1.2e8 N/m", yy = "1.2e8 N/m" }
damping = { xx = "500 N*s/m", yy = "500 N*s/m" }

[[gear]]
name = "end"
rotor = "third"
at = "100 mm"
teeth = 28
module = "3.175 mm"
face_width = "6.35 mm"
pressure_angle = "20 deg"
bore = "30 mm"

[[gear_pair]]
driver = "wheel"
driven = "end"
stiffness = { model = "potential-energy" }
damping_ratio = 0.05
"""


def idler(folder: Path) -> str:
    """Return the path of a case file of three equal gears in a row."""
    spur_pair = files("gearwhine.cases").joinpath("spur-pair.toml").read_text(encoding="utf-8")
    path = folder / "idler.toml"
    path.write_text(spur_pair + BEHIND, encoding="utf-8")
    return str(path)
