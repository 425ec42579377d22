"""Residual modes in a mode file: conversion to labelled arrays and back."""

from collections.abc import Mapping

import numpy as np

from housing.labelled import LabelledArray
from housing.reduction import ResidualModes, StaticProof

_ONE = ("attachment",)
_PORTS = ("loaded_motion", "moved_motion")


def residual_mode_arrays(residual_modes: ResidualModes | None) -> dict[str, LabelledArray]:
    """The arrays of residual modes and their proof; empty where there are none.

    An empty set, at ports whose response the modes hold already, keeps its proof; its arrays are left out, because a
    dimension of length 0 has another meaning in NetCDF.
    """
    if residual_modes is None:
        return {}
    proof = residual_modes.proof
    arrays = {
        "static_compliance": LabelledArray(_PORTS, proof.compliance, "m N-1", "elastic compliance at the ports"),
        "static_missing": LabelledArray(_PORTS, proof.missing, "m N-1", "the part of it that the modes lack"),
        "static_error": LabelledArray((), np.array(proof.error), "1", "bound on the compliance's relative error"),
        "static_overlap": LabelledArray((), np.array(proof.overlap), "1", "largest overlap of an attachment in mass"),
        "static_sweeps": LabelledArray((), np.array(proof.sweeps), "1", "solves that the attachments took"),
    }
    if len(residual_modes.frequencies):
        shape = ("attachment", "node", "component")
        arrays |= {
            "attachment_circular_frequency": LabelledArray(
                _ONE, residual_modes.frequencies, "rad s-1", "root of stiffness over mass; no natural frequency"
            ),
            "attachment_shape": LabelledArray(
                shape, residual_modes.shapes, "kg-0.5", "residual attachment modes of unit modal mass"
            ),
        }
    return arrays


def residual_modes_of(arrays: Mapping[str, LabelledArray], n_nodes: int) -> ResidualModes | None:
    """The residual modes that these arrays were made of, equal bit for bit.

    Raises
    ------
    KeyError
        Where a part is missing.
    """
    if "static_compliance" not in arrays:
        return None
    proof = StaticProof(
        compliance=arrays["static_compliance"].values,
        missing=arrays["static_missing"].values,
        error=arrays["static_error"].values.item(),
        overlap=arrays["static_overlap"].values.item(),
        sweeps=arrays["static_sweeps"].values.item(),
    )
    if "attachment_shape" not in arrays:
        return ResidualModes(np.empty(0), np.empty((0, n_nodes, 3)), proof)
    return ResidualModes(arrays["attachment_circular_frequency"].values, arrays["attachment_shape"].values, proof)
