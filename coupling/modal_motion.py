"""Modal coordinates of a rotor in the coupled motion, by the modes that the sources plot.

A component's own coordinates are those of the shaft freed of its bearings. The modes of TM-101442, Eqs. 7 to 10, are
those on averaged supports: x = Σ A_i φ_i, y = Σ B_i φ_i, and for torsion θ = Σ D_i φ_t,i (Eq. 11) of the free shaft.
Both span the same motions. With the component's lateral coordinates q, whose shapes are the columns of Φᵀ V,

    A = V q,    V = `RotorComponent.mixture`, orthogonal,

so that a row of V, at the place of the rotor's coordinates, is all that :class:`coupling.TransientOutputs` needs.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError
from coupling.machine import Machine
from coupling.system import embed

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class ModalRows:
    """Rows that take a rotor's modal coordinates out of the n coordinates of the machine.

    Coordinates are in m √kg (lateral) and rad √(kg m²) (torsional): a shape is per unit modal mass.

    Attributes
    ----------
    x, y : ndarray, shape (m, n)
        A_i and B_i of the bending modes on averaged supports, ascending, without attachment vectors.
    torsion : ndarray, shape (t, n)
        D_i of the free shaft's torsional modes, the rigid rotation first, without attachment vectors.
    """

    x: FloatArray
    y: FloatArray
    torsion: FloatArray


def modal_rows(machine: Machine, rotor: str) -> ModalRows:
    """The rows of one rotor; stacked into ``TransientOutputs.displacement`` they are recorded as time passes.

    Raises
    ------
    CouplingError
        Where no rotor has the name.
    """
    components = machine.system.components
    found = next((number for number, part in enumerate(machine.rotors) if part.name == rotor), None)
    if found is None:
        names = ", ".join(part.name for part in machine.rotors)
        raise CouplingError(f"no rotor is named {rotor!r}; there are: {names}")
    part = machine.rotors[found]
    lateral, torsional = part.modal.lateral, part.modal.torsional
    planar, twisting = lateral.certificate.found, torsional.certificate.found
    own = np.eye(part.size)
    x, y = (part.mixture[:planar] @ own[plane * lateral.count : (plane + 1) * lateral.count] for plane in (0, 1))
    torsion = own[2 * lateral.count : 2 * lateral.count + twisting]
    return ModalRows(
        *(
            np.array([embed(components, found, row) for row in rows]).reshape(-1, machine.system.size)
            for rows in (x, y, torsion)
        )
    )
