"""Static deflection and bearing loads of a rotor under its weight and given forces.

The weight along a shaft element enters exactly, whatever its taper and axial force. With y' = (A₀ + ω²B) y
(`gearwhine.rotors.transfer_matrix.timoshenko`), y(0) = (1, 0, 0, 0) gives at ω = 0 the rigid translation y = (1, 0, 0,
0); its derivative with respect to ω² obeys (∂y)' = A₀ ∂y + B (1, 0, 0, 0): the field under the load ρA per unit
acceleration. So

    y_particular = g ∂T/∂ω²|₀ (1, 0, 0, 0),

where the derivative of the entire T is Im T(iε)/ε, to rounding for a tiny ε. Both planes and the axial direction go
through the equations of `gearwhine.rotors.whirl.equations` at λ = 0.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.rotors.analyses.harmonic_response import bearing_forces
from gearwhine.rotors.errors import RotorError, require, require_finite
from gearwhine.rotors.model.bearing import Bearing
from gearwhine.rotors.model.shaft import Rotor
from gearwhine.rotors.transfer_matrix.mode_shapes import require_positions
from gearwhine.rotors.whirl.circular_coordinates import BLOCK_COORDINATES, CIRCULAR, coupled_motions
from gearwhine.rotors.whirl.equations import WhirlEquations, whirl_equations, whirl_reach

STANDARD_GRAVITY = (0.0, -9.80665, 0.0)
# Imaginary step of ω² in the derivative: no difference is taken, so that it may be arbitrarily small.
TINY = 1e-30
# Part of the largest stiffness below which a rigid motion is free.
NOT_HELD = 1e-12


@dataclass(frozen=True)
class StaticForce:
    """A constant force [N] and moments (N·m, about x and about y) on the shaft at a place [m]."""

    at: float
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    about_x: float = 0.0
    about_y: float = 0.0

    def __post_init__(self) -> None:
        """Check that position, forces and moments are finite."""
        require_finite("force position", self.at, minimum=0.0)
        for attribute in ("x", "y", "z", "about_x", "about_y"):
            require_finite(f"force {attribute}", getattr(self, attribute))

    @property
    def circular(self) -> ComplexArray:
        """Loads over r+, β+, r−, β− and z."""
        return np.asarray(CIRCULAR @ np.array([self.x, self.y, self.z, self.about_x, self.about_y]))


@dataclass(frozen=True)
class StaticDeflection:
    """Static deflection of a rotor and the loads of its bearings.

    Attributes
    ----------
    gravity : ndarray, shape (3,)
        Acceleration over x, y, z [m/s²].
    bearings : tuple of str
        Names of the bearings.
    bearing_loads : ndarray, shape (bearings, 5)
        Load on the carrier of each bearing, over x, y, z [N] and about x and y [N·m].
    """

    gravity: FloatArray
    bearings: tuple[str, ...]
    bearing_loads: FloatArray
    equation_sets: tuple[WhirlEquations, ...] = field(repr=False)
    states: tuple[dict[int, ComplexArray], ...] = field(repr=False)

    def evaluate(self, z: npt.ArrayLike) -> FloatArray:
        """Displacement over x, y and z at positions z [m], (3, len(z)) [m]."""
        return self._read(z, (0, 2, 4), forces=False)[:3]

    def slopes(self, z: npt.ArrayLike) -> FloatArray:
        """Slopes of the section in x and in y at positions z [m], (2, len(z)) [rad]."""
        about = self._read(z, (1, 3), forces=False)[3:]
        return np.stack([about[1], -about[0]])

    def bending_moments(self, z: npt.ArrayLike) -> FloatArray:
        """Bending moments EI β' in the planes of x and of y, right of positions z [m], (2, len(z)) [N·m]."""
        about = self._read(z, (1, 3), forces=True)[3:]
        return np.stack([about[1], -about[0]])

    def shear_forces(self, z: npt.ArrayLike) -> FloatArray:
        """Transverse forces over x and y, right of positions z [m], (2, len(z)) [N]."""
        return self._read(z, (0, 2), forces=True)[:2]

    def _read(self, z: npt.ArrayLike, wanted: tuple[int, ...], *, forces: bool) -> FloatArray:
        """Components (5, len(z)) over x, y, z and about x and y; those not wanted are zero."""
        positions = require_positions(self.equation_sets[0].bending.nodes, z)
        whole = np.zeros((5, positions.size), dtype=np.complex128)
        for equations, states in zip(self.equation_sets, self.states, strict=True):
            members = [member for block in equations.blocks for member in BLOCK_COORDINATES[block]]
            numbers, fractions = equations.bending.places(positions)
            units, first = equations.units, 0
            for block in equations.blocks:
                width = len(BLOCK_COORDINATES[block])
                planar = equations.bending if block else equations.axial
                at = planar.transfer_matrices_to(numbers, fractions, np.array([TINY * 1j]))[:, 0]
                inside = np.einsum("zij,zj->zi", at.real, states[block][0, numbers])
                inside = inside + acceleration(self.gravity, block) / units[first] * at.imag[:, :, 0] / TINY
                for k in range(width):
                    if members[first + k] in wanted:
                        value = inside[:, width + k] / units[first + k] if forces else inside[:, k] * units[first + k]
                        whole[members[first + k]] = value
                first += width
        return np.asarray((CIRCULAR.conj().T @ whole).real)


def static_deflection(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    forces: Sequence[StaticForce] = (),
    *,
    gravity: Sequence[float] = STANDARD_GRAVITY,
    speed: float = 0.0,
) -> StaticDeflection:
    """Deflection and bearing loads under weight and constant forces.

    Parameters
    ----------
    rotor, bearings : Rotor, sequence of Bearing
        The rotor and its bearings; tables over speed are read at ``speed``.
    forces : sequence of StaticForce
        Constant forces on the shaft.
    gravity : sequence of float
        Acceleration over x, y, z [m/s²]. With a part along z, a bearing must hold the shaft along z.
    speed : float
        Speed of rotation Ω [rad/s].

    Raises
    ------
    RotorError
        A place off the shaft, or a rotor that its bearings do not hold.
    """
    pull = np.array(gravity, dtype=np.float64)
    require(pull.shape == (3,) and bool(np.isfinite(pull).all()), "gravity", list(gravity), "three finite numbers")
    for label, at in [(f"bearing {b.name!r}", b.at) for b in bearings] + [("force", f.at) for f in forces]:
        rotor.require_on_shaft(label, at)
    constant = [bearing.at_speed(speed) for bearing in bearings]
    sets = coupled_motions(constant)
    if (pull[2] != 0.0 or any(force.z for force in forces)) and not any(0 in blocks for blocks in sets):
        sets = (*sets, (0,))
    places = [force.at for force in forces]
    equation_sets, states = [], []
    loads = np.zeros((1, len(constant), 5), dtype=np.complex128)
    for blocks in sets:
        equations = whirl_equations(rotor, constant, blocks, whirl_reach(1e-6, 0.0), places)
        require_held(rotor, equations)
        solution, scale = _solve(equations, forces, pull)
        equation_sets.append(equations)
        at_rest = np.zeros(1, dtype=np.complex128)
        states.append(equations.states(solution, at_rest, at_rest, scale))
        loads += bearing_forces(equations, solution, scale)
    return StaticDeflection(pull, tuple(b.name for b in bearings), loads[0].real, tuple(equation_sets), tuple(states))


def acceleration(gravity: FloatArray, block: int) -> complex:
    """Component of gravity in r+, r− or z."""
    circular = CIRCULAR @ np.concatenate([gravity, np.zeros(2)])
    return complex(circular[BLOCK_COORDINATES[block][0]])


def require_held(rotor: Rotor, equations: WhirlEquations) -> None:
    """Raise `RotorError` unless the bearings resist every rigid motion of the rotor."""
    n = equations.size
    place = (equations.bending.nodes - equations.bending.nodes.mean()) / equations.bending.length_unit
    rigid, column = np.zeros((n, n, place.size)), 0
    for block in equations.blocks:
        rigid[column, column] = 1.0
        if block:
            rigid[column, column + 1] = place
            rigid[column + 1, column + 1] = 1.0
        column += len(BLOCK_COORDINATES[block])
    whole = np.zeros((n, n), dtype=np.complex128)
    for node_bearing in equations.node_bearings:
        shape = node_bearing.frame @ rigid[:, :, node_bearing.node]
        whole += shape.conj().T @ node_bearing.stiffness @ shape
    sizes = np.linalg.svd(whole, compute_uv=False)
    if sizes[-1] <= NOT_HELD * sizes[0] or sizes[0] == 0.0:
        raise RotorError(
            f"rotor {rotor.name!r} is free to move; expected bearings that hold it in every direction loaded"
        )


def _solve(
    equations: WhirlEquations, forces: Sequence[StaticForce], gravity: FloatArray
) -> tuple[ComplexArray, FloatArray]:
    zero = np.zeros(1, dtype=np.complex128)
    scale = equations.response_scale(zero)
    units, layout = equations.units, equations.layout
    members = [member for block in equations.blocks for member in BLOCK_COORDINATES[block]]
    sides = np.zeros((1, equations.pattern.order), dtype=np.complex128)
    first = 0
    for block in equations.blocks:
        width = len(BLOCK_COORDINATES[block])
        columns = slice(first, first + width)
        planar = equations.bending if block else equations.axial
        pull = acceleration(gravity, block) / units[first]
        particular = pull * planar.transfer_matrices(np.array([TINY * 1j]))[:, 0].imag[:, :, 0] / TINY
        particular[:, width:] /= scale[0]
        sides[0, layout.continuity[:, columns]] += particular[:, :width]
        sides[0, layout.balances[1:, columns]] += particular[:, width:]
        sides[0, layout.balances[:, first]] -= pull * planar.node_inertia[:, 0] / scale[0]
        first += width
    for force in forces:
        row = layout.balances[equations.bending.node_at(force.at)]
        sides[0, row] -= force.circular[members] * units / scale[0]
    return equations.pattern.solve(equations.values(zero, zero, scale), sides[:, None])[:, 0], scale
