"""Contact law of two gears with a tooth stiffness model."""

from __future__ import annotations

import numpy as np

from coupling.gears.face_slices import FaceSlices
from coupling.gears.pair_curves import tooth_pair_curves
from coupling.gears.pair_geometry import GearPairGeometry
from coupling.gears.pair_variants import pair_variants
from coupling.gears.pitch_gaps import back_flank_pitch_gaps, pitch_gaps
from coupling.gears.stiffness_models import StiffnessModel, shared_compliance
from coupling.gears.tooth_contact import ToothContact


def tooth_contact(
    geometry: GearPairGeometry,
    model: StiffnessModel,
    damping: float = 0.0,
    *,
    corner_contact: bool = False,
    faces: FaceSlices | None = None,
) -> ToothContact:
    """Contact law of a gear pair.

    Parameters
    ----------
    geometry : GearPairGeometry
    model : StiffnessModel
        See `coupling.gears.stiffness_models`.  A model of the whole mesh (range exactly one base pitch, when
        the contact ratio is not) has no single pairs: the profile deviation is then zero.  Pitch deviations remain,
        one pair for each mesh period.
    damping : float
        Damping coefficient [N s/m], e.g. from `mesh_damping`.
    corner_contact : bool
        Whether pairs touch beyond their path of contact as well, where a load closes the gap to a corner.
    faces : FaceSlices or None
        From `face_slices`, where the face is not loaded evenly; None for a uniform load.

    Returns
    -------
    ToothContact

    Raises
    ------
    GearError
        Damaged teeth or corner contact with a model of the whole mesh, which has no single pairs.
    """
    variants = pair_variants(geometry)
    stiffness = model.pair_stiffness(geometry)
    kinds = tooth_pair_curves(geometry, stiffness, variants.faults, corner_contact)
    none = np.zeros(0)
    deviating = any(geometry.driver.pitch_deviations) or any(geometry.driven.pitch_deviations)
    return ToothContact(
        float(stiffness.knots[-1]),
        kinds[0].stiffness,
        kinds[0].deviation,
        damping,
        geometry.back_flank_offset,
        pitch_gaps(geometry) if deviating else none,
        back_flank_pitch_gaps(geometry) if deviating else none,
        variants=kinds[1:],
        pair_variants=variants.of_pair if len(kinds) > 1 else none.astype(np.int64),
        back_pair_variants=variants.of_back_pair if len(kinds) > 1 else none.astype(np.int64),
        faces=faces,
        module=geometry.driver.module,
        shared_compliance=shared_compliance(model, geometry),
    )
