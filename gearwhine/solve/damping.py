"""Damping of the parts of a case: what each has, whether the case gives it, and the source of a default.

Damping decides the height of resonances and does not follow from drawings. Defaults, and measured ranges beside them:

- housing: 1 % of critical in every mode, between those of welded or bolted and of cast ones, see
  :data:`gearwhine.numerics.materials.STRUCTURAL_DAMPING`.
- shafts: 0.5 % of critical in bending and twisting (Lin, Huston and Coy 1988, *On dynamic loads in parallel shaft
  transmissions*, have 0.5 to 0.75 %).
- meshes: ratio of the two gears against each other; 3 to 17 % was measured (Kasuba and Evans 1981; Wang and Cheng
  1981).
- rolling bearings by their elements: stiffness times 0.8e-5 s (Krämer 1993: 0.25e-5 to 2.5e-5 s); bearings of typed
  stiffness have none.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from gearwhine.case import Case, GearPair
from gearwhine.coupling.gears.geometry.pair import pair_label
from gearwhine.numerics.materials import STRUCTURAL_DAMPING
from gearwhine.numerics.result_warnings import warning


@dataclass(frozen=True)
class PartDamping:
    """Damping of a part of a case.

    Attributes
    ----------
    part : str
        Kind and name of the part.
    key : str
        Key of the case that gives it.
    text : str
        Damping in words, with the range or the source of a default.
    is_given : bool
        Whether the case gives it.
    """

    part: str
    key: str
    text: str
    is_given: bool


def part_dampings(case: Case) -> tuple[PartDamping, ...]:
    """Return the damping of the housing, and of each rotor, bearing and gear pair."""
    parts = []
    if case.housing is not None:
        word, ratio = case.housing.damping_ratio, case.housing.modal_damping
        text = f"{100.0 * ratio:.3g} % of critical in every mode" if isinstance(ratio, float | int) else "by its modes"
        if isinstance(word, str):
            text += f" ({word}: {STRUCTURAL_DAMPING[word].source})"
        parts.append(PartDamping("housing", "housing.damping_ratio", text, _gives(case.housing, "damping_ratio")))
    if (reduced := case.reduced_housing) is not None:
        text = f"{100.0 * reduced.damping_ratio:.3g} % of critical in every mode"
        text += " beside its damping matrix" if reduced.reduced.damping is not None else ""
        parts.append(PartDamping("housing", "housing.damping_ratio", text, _gives(reduced, "damping_ratio")))
    for number, rotor in enumerate(case.rotor):
        text = f"{100.0 * rotor.damping_ratio:.3g} % of critical"
        if rotor.internal_damping > 0.0:
            text += f", and internal damping of {1e6 * rotor.internal_damping:.3g} µs times its stiffness"
        key = f"rotor[{number}].damping_ratio"
        parts.append(PartDamping(f"rotor {rotor.name}", key, text, _gives(rotor, "damping_ratio")))
    for number, bearing in enumerate(case.bearing):
        text = "as given"
        if bearing.damping_time > 0.0:
            text = f"{1e6 * bearing.damping_time:.3g} µs times its stiffness"
        elif bearing.damping is None:
            text = "none"
        parts.append(
            PartDamping(f"bearing {bearing.name}", f"bearing[{number}].damping", text, bearing.damping is not None)
        )
    for number, pair in enumerate(case.gear_pair):
        text = f"{100.0 * pair.damping_ratio:.3g} % of critical" if pair.damping is None else "as given"
        is_given = pair.damping is not None or _gives(pair, "damping_ratio")
        key = f"gear_pair[{number}].damping_ratio"
        parts.append(PartDamping(f"mesh {pair.driver} → {pair.driven}", key, text, is_given))
    return tuple(parts)


def damping_document(parts: Iterable[PartDamping]) -> list[dict[str, Any]]:
    """Return the damping of each part for JSON: part, key of the case, words, and whether the case gives it."""
    return [{"part": part.part, "key": part.key, "damping": part.text, "given": part.is_given} for part in parts]


def damping_warnings(dampings: Iterable[PartDamping]) -> list[dict[str, Any]]:
    """Warn of damping that nobody gave, in one sentence for all parts."""
    missing = [part for part in dampings if not part.is_given]
    if not missing:
        return []
    by_text: dict[str, list[str]] = {}
    for part in missing:
        by_text.setdefault(part.text, []).append(part.part)
    parts = "; ".join(f"{', '.join(names)}: {text}" for text, names in by_text.items())
    message = (
        f"damping that nobody gave: {parts}. Resonances are as high as damping lets them; the band of a line has its "
        "level with all damping doubled and halved"
    )
    return [warning("damping", message, keys=[part.key for part in missing])]


def assumed_mesh_damping(pairs: Iterable[GearPair]) -> tuple[str, ...]:
    """Return the gear pairs whose mesh damping the case leaves to the default."""
    return tuple(
        pair_label(pair.driver, pair.driven)
        for pair in pairs
        if not (_gives(pair, "damping_ratio") or _gives(pair, "damping"))
    )


def _gives(table: Any, key: str) -> bool:
    """Whether a table of the case has a key."""
    return key in table.model_fields_set
