"""Modal coordinates of rotors and housing in a coupled motion.

A component's own coordinates are those of the shaft freed of its bearings. The modes of TM-101442, Eqs. 7 to 10, are
those on averaged supports: x = Σ A_i φ_i, y = Σ B_i φ_i, and for torsion θ = Σ D_i φ_t,i (Eq. 11) of the free shaft.
Both span the same motions. With the component's lateral coordinates q, whose shapes are the columns of Φᵀ V,

    A = V q,    V = `RotorComponent.mixture`, orthogonal,

so a row of V, at the position of the rotor's coordinates, is a row of :class:`coupling.TransientOutputs`. The housing's
coordinates are those of its modes.
"""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError
from coupling.machine import CoupledMachine
from coupling.settings import MotionRecord, TransientOutputs

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class ModalRows:
    """Output rows of a rotor's modal coordinates over the n coordinates of the machine.

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


def modal_rows(machine: CoupledMachine, rotor: str) -> ModalRows:
    """Output rows of the modal coordinates of one rotor, for ``TransientOutputs.displacement``.

    Raises
    ------
    CouplingError
        Where no rotor has the name.
    """
    part = next((part for part in machine.rotors if part.name == rotor), None)
    if part is None:
        names = ", ".join(part.name for part in machine.rotors)
        raise CouplingError(f"no rotor is named {rotor!r}; there are: {names}")
    lateral, torsional = part.modal.lateral, part.modal.torsional
    planar, twisting = lateral.certificate.found, torsional.certificate.found
    own = np.eye(part.size)
    x, y = (part.mixture[:planar] @ own[plane * lateral.count : (plane + 1) * lateral.count] for plane in (0, 1))
    torsion = own[2 * lateral.count : 2 * lateral.count + twisting]
    return ModalRows(*(machine.rows(rotor, rows) for rows in (x, y, torsion)))


@dataclass(frozen=True)
class ModalRecord:
    """Modal motion on record at even spacing, s samples.

    Attributes
    ----------
    coordinates : dict of str to ndarray, shape (s,)
        Such as ``input: torsion 1`` [rad √(kg m²)], ``input: bending 1, x`` or ``housing: mode 1`` [m √kg].
    housing_acceleration : ndarray, shape (s, m)
        Of all modes of the housing [m √kg / s²].
    """

    coordinates: dict[str, FloatArray]
    housing_acceleration: FloatArray

    @property
    def columns(self) -> FloatArray:
        """All signals as columns, shape (s, k)."""
        moved = [coordinate[:, None] for coordinate in self.coordinates.values()]
        return np.concatenate([*moved, self.housing_acceleration], axis=1)

    def with_columns(self, columns: FloatArray) -> "ModalRecord":
        """The same signals with other samples, from columns as in :attr:`columns`."""
        coordinates = {name: columns[:, i] for i, name in enumerate(self.coordinates)}
        return ModalRecord(coordinates, columns[:, len(coordinates) :])


def with_modal_rows(
    machine: CoupledMachine, outputs: TransientOutputs, count: int = 0, *, housing: bool = True
) -> TransientOutputs:
    """Outputs and, after them, the accelerations of the housing's modes, and the first modal coordinates of each part.

    Parameters
    ----------
    machine : CoupledMachine
    outputs : TransientOutputs
    count : int
        Number of modes of each kind of a rotor, and of the housing, whose displacement is recorded.
    housing : bool
        Whether the accelerations of the housing's modes are recorded.
    """
    accelerations = _housing_rows(machine)[: None if housing else 0]
    rows = np.array(list(_coordinate_rows(machine, count).values())).reshape(-1, machine.system.size)
    return replace(
        outputs,
        displacement=np.concatenate([outputs.displacement, rows]),
        acceleration=np.concatenate([outputs.acceleration, accelerations]),
    )


def modal_record(machine: CoupledMachine, result: MotionRecord, count: int = 0, *, housing: bool = True) -> ModalRecord:
    """Modal motion by name from the record of a transient with :func:`with_modal_rows`."""
    names = list(_coordinate_rows(machine, count))
    moved = result.displacement[:, result.displacement.shape[1] - len(names) :]
    first = result.acceleration.shape[1] - (len(_housing_rows(machine)) if housing else 0)
    return ModalRecord({name: moved[:, i] for i, name in enumerate(names)}, result.acceleration[:, first:])


def _coordinate_rows(machine: CoupledMachine, count: int) -> dict[str, FloatArray]:
    """The first rows of each kind of each part, by name."""
    if count == 0:
        return {}
    named = {}
    for rotor in machine.rotors:
        rows = modal_rows(machine, rotor.name)
        for number, row in enumerate(rows.torsion[:count], start=1):
            named[f"{rotor.name}: torsion {number}"] = row
        for axis, plane in (("x", rows.x), ("y", rows.y)):
            for number, row in enumerate(plane[:count], start=1):
                named[f"{rotor.name}: bending {number}, {axis}"] = row
    if machine.housing is not None:
        for number, row in enumerate(_housing_rows(machine)[:count], start=1):
            named[f"{machine.housing.name}: mode {number}"] = row
    return named


def _housing_rows(machine: CoupledMachine) -> FloatArray:
    """Rows of the housing's modes, without its residual attachments, shape (m, n)."""
    if machine.housing is None:
        return np.zeros((0, machine.system.size))
    modes = sum(kind == "housing" for kind in machine.housing.kinds)
    return machine.rows(machine.housing.name, np.eye(machine.housing.size)[:modes])
