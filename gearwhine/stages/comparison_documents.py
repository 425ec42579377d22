"""Model modes beside measured ones as the commands' JSON: the pairs, and what shapes say where there are any."""

from typing import Any

import numpy as np
import numpy.typing as npt

import housing as room
from gearwhine.stages.housing import SolvedHousing
from housing.correlation import LookAlikes, largest_off_diagonal

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi


def comparison_document(comparison: room.Comparison, solved: SolvedHousing) -> dict[str, Any]:
    """The comparison as the command's JSON."""
    shapes = comparison.shapes
    last = comparison.pairs[-1].measured if shapes is None else float(shapes.measured_frequencies[-1])
    # Counted below the next full kilohertz over the measured modes, as far as the model's modes are known.
    highest = float(np.ceil(last / _HERTZ / 1000.0) * 1000.0)
    highest = min(highest, solved.modes.certificate.limit / _HERTZ)
    document = {
        "pairs": [_pair(pair) for pair in comparison.pairs],
        "rms_error_percent": comparison.rms_error_percent,
        "max_error_percent": comparison.max_error_percent,
        "pairing": comparison.pairing,
        "band_hz": [edge / _HERTZ for edge in comparison.band],
        "gap": comparison.gap,
        "measures_agree": comparison.measures_agree,
        "model_modes": {
            "below_hz": highest,
            "count": int(np.count_nonzero(solved.modes.frequencies_hz < highest)),
        },
    }
    return document if shapes is None else document | shapes_document(shapes)


def shapes_document(shapes: room.ShapeCorrelation) -> dict[str, Any]:
    """What is missing, double, close or alike, and how good the survey is."""
    model, measured = shapes.model_frequencies / _HERTZ, shapes.measured_frequencies / _HERTZ
    crossed = shapes.cross_orthogonality
    return {
        "unpaired_measured": [
            {
                "measured_mode": number,
                "measured_hz": float(measured[number - 1]),
                "most_like": int(np.argmax(shapes.mac[:, number - 1])) + 1,
                "mac": float(shapes.mac[:, number - 1].max()),
            }
            for number in shapes.unpaired_measured
        ],
        "unpaired_model": [{"mode": number, "model_hz": float(model[number - 1])} for number in shapes.unpaired_model],
        "duplicates": [_look_alikes(pair) for pair in shapes.measured_look_alikes if pair.one_frequency],
        "look_alikes": {
            "measured": [_look_alikes(pair) for pair in shapes.measured_look_alikes if not pair.one_frequency],
            "model": [_look_alikes(pair) for pair in shapes.model_look_alikes],
        },
        "close_modes": [
            {
                "modes": list(group.model),
                "measured_modes": list(group.measured),
                "largest_angle_deg": float(np.degrees(group.largest_angle)),
            }
            for group in shapes.close
        ],
        "auto_mac_off_diagonal": {
            "model": largest_off_diagonal(_within(shapes)),
            "measured": largest_off_diagonal(shapes.measured_auto_mac),
        },
        "cross_orthogonality": {
            "modes": list(shapes.orthogonality_modes),
            "values": None if crossed is None else crossed.tolist(),
            "outside": None if shapes.outside is None else shapes.outside.tolist(),
            "missing_because": shapes.no_orthogonality or None,
        },
        "phase_collinearity": shapes.collinearity.tolist(),
        "mac": shapes.mac.tolist(),
    }


def _within(shapes: room.ShapeCorrelation) -> FloatArray:
    """The model's auto-MAC in the band: modes far outside it need not be told apart."""
    which = np.array(shapes.orthogonality_modes, dtype=np.int64) - 1
    return shapes.model_auto_mac[np.ix_(which, which)] if which.size else np.zeros((1, 1))


def _pair(pair: room.ModePair) -> dict[str, Any]:
    return {
        "measured_mode": pair.measured_mode,
        "measured_hz": pair.measured / _HERTZ,
        "model_hz": pair.model / _HERTZ,
        "error_percent": pair.error_percent,
        "mode": pair.mode,
        "mac": pair.mac,
        "confidence": pair.confidence,
        "close_modes": list(pair.close_modes),
        "mixed": pair.mixed,
        "strength": pair.strength,
    }


def _look_alikes(pair: LookAlikes) -> dict[str, Any]:
    return {"modes": [pair.first, pair.second], "mac": pair.mac}
