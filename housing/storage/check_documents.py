"""Checks of a solved housing as JSON values and back: its health report and its effective masses."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from gearwhine.housing.model.patches import RigidBody
from gearwhine.housing.model.supports import Grounding, SupportHold
from gearwhine.housing.modes.effective_mass import EffectiveMass
from gearwhine.housing.modes.health import HealthLine, HealthReport


def check_document(checked: HealthReport | EffectiveMass) -> dict[str, Any]:
    """Convert a health report, or effective masses, to JSON values, from which it comes back equal bit for bit."""
    document = _values(checked)
    assert isinstance(document, dict)
    return document


def health_of(document: Mapping[str, Any]) -> HealthReport:
    """Convert the document of a health report back."""
    body, ground = document["body"], document["grounding"]
    supports = [
        SupportHold(row["name"], row["fixes"], np.array(row["stiffness"]), np.array(row["share"]))
        for row in ground["supports"]
    ]
    return HealthReport(
        tuple(HealthLine(**line) for line in document["lines"]),
        RigidBody(body["mass"], np.array(body["center"]), np.array(body["inertia"])),
        Grounding(ground["free_motions"], tuple(ground["free_directions"]), tuple(supports)),
    )


def effective_mass_of(document: Mapping[str, Any]) -> EffectiveMass:
    """Convert the document of effective masses back."""
    arrays = {name: np.array(document[name], dtype=np.float64) for name in ("total", "free", "center")}
    return EffectiveMass(np.array(document["participation"], dtype=np.float64).reshape(-1, 6), **arrays)


def _values(value: Any) -> Any:
    if is_dataclass(value):
        return {field.name: _values(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return [_values(entry) for entry in value] if isinstance(value, tuple | list) else value
