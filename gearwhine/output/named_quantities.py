"""Quantities by names such as ``sensor.top.level_db``: what they are of, and how tables and figures show them."""

from gearwhine.output.quantity import UNITS, unit_of

_SCALES = {"m": ("µm", 1e6), "Pa": ("MPa", 1e-6), "N/m": ("N/µm", 1e-6), "rad": ("µrad", 1e6)}
"""Units that tables and figures show in place of those of the names, and the factors to them."""
_LEVELS = {"level_db": "highest level over speed", "motion_level_db": "level of the motion"}
_SYMBOLS = {"k_h_beta": "K_Hβ", "mesh_load_factor": "mesh load factor K_γ"}


def part_of(name: str) -> str:
    """Return what a quantity is of: ``sensor top`` of ``sensor.top.level_db``."""
    kind, _, rest = name.rpartition(".")[0].partition(".")
    return rest if kind == "gear_pair" else f"{kind} {rest}".strip()


def shown_quantity(name: str) -> tuple[str, float]:
    """Return a quantity's name in words with the unit that is shown, and the factor to that."""
    unit, factor = _SCALES.get(unit_of(name), (unit_of(name), 1.0))
    last = name.rpartition(".")[2]
    end = max((end for end in UNITS if last.endswith(end)), key=len, default="")
    words = _SYMBOLS.get(last, last.removesuffix(end).replace("_", " "))
    if last.endswith("level_db"):
        words, unit = _LEVELS[last], "dB re 1 µm/s²"
    return (f"{words} [{unit}]" if unit else words), factor


def shown_unit(unit: str) -> tuple[str, float]:
    """Return the unit in which values of a varied key are shown, and the factor to it."""
    return {**_SCALES, "um": ("µm", 1.0), "N*m": ("N m", 1.0)}.get(unit, (unit, 1.0))
