r"""Gradient of the sound power of a housing at a frequency: radiation resistance of all modes, and the adjoint load.

The sound power is a quadratic form of the rates q̇ of the modes' coordinates, and of the normal velocity v of the
radiating surface, v = iω T u with the transfer T from the displacements u of the housing's nodes:

    W = ½ q̇ᴴ R q̇ = ½ Re ∫ v* Z v dS.

R, real and symmetric, is that of the far field
(:attr:`gearwhine.housing.acoustics.boundary_elements.SoundField.resistance`). By reciprocity ∫ v₁ Z v₂ dS = ∫ v₂ Z v₁
dS, so Re Z alone has power, and the part of the pressure that has it is

    p_R = Re(Z) v = Σ q̇_j Re p_j,

with p_j the pressure by a unit rate of a mode, whose velocity is real. A change of the velocity then changes the power
by

    dW = Re ∫ dv* p_R dS,      dW = Re gᵀ du      with      g = iω Tᵀ ∫ φ p_R* dS,

φ the shape functions of the triangles' corners: g is the adjoint load, over the nodes of the whole skin (F. Fahy and
P. Gardonio, *Sound and Structural Vibration*, 2nd ed., 2007, section 2.4, on Re Z; Choi and Kim, *Structural
Sensitivity Analysis and Optimization 1*, 2005, section 5.4, on the adjoint load). For the equivalent radiated power
Z = ρc, and g is exact; for boundary elements it is as good as their reciprocity,
:attr:`~gearwhine.housing.acoustics.boundary_elements.SoundField.reciprocity_error`.

The radiating surface stays. Where the mesh slides along it, as on a wall beside one that gets thicker, it moves with
other points of the housing, and the power changes by their motion too. The change of the surface itself is left out: to
first order a wall that gets thicker inwards does not move it.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearwhine.housing.acoustics.boundary_elements import SoundField, surface_load
from gearwhine.housing.acoustics.radiation import EquivalentField, Field, HousingRadiation, RadiatedSound
from gearwhine.numerics.arrays import ComplexArray, FloatArray

_TWO_PI = 2.0 * np.pi


@dataclass(frozen=True, eq=False)
class PowerGradient:
    """Sound power of any motion of a housing at one frequency, and its gradient.

    Attributes
    ----------
    radiation : HousingRadiation
        Radiation with the modes.
    unit : RadiatedSound
        Sound of a unit rate of each mode's coordinate.
    """

    radiation: HousingRadiation
    unit: RadiatedSound

    @classmethod
    def at(cls, radiation: HousingRadiation, frequency_hz: float) -> "PowerGradient":
        """Solve for the sound of a unit rate of each mode at a frequency.

        Raises
        ------
        HousingError
            Where the triangles are too large for the frequency.
        """
        return cls(radiation, radiation.solve(frequency_hz, np.eye(radiation.modal[0].shape[1])))

    @property
    def frequency(self) -> float:
        """ω [rad/s]."""
        return _TWO_PI * self.unit.frequency_hz

    @cached_property
    def resistance(self) -> FloatArray:
        """R of the modes' rates [W s²/(kg m²)], real and symmetric, shape (n_modes, n_modes)."""
        return self.unit.resistance

    def sound(self, rates: ComplexArray) -> RadiatedSound:
        """Superpose the sound of the modes.

        Parameters
        ----------
        rates : ndarray of complex, shape (n_modes,)
            q̇.
        """
        fields = tuple(_superposed(field, rates[:, None]) for field in self.unit.fields)
        return replace(self.unit, fields=fields, coordinates=rates[:, None])

    def nodal_load(self, rates: ComplexArray) -> ComplexArray:
        """Adjoint load g of the power on the nodes [W/m], with dW = Re gᵀ du, shape (3 n_nodes,)."""
        loads = zip(self.radiation.skins, self._corner_loads(rates), strict=True)
        nodal = [np.asarray(points.transfer.T @ load.conj()) for points, load in loads]
        return np.asarray(1j * self.frequency * np.sum(nodal, axis=0))

    def by_sliding(self, rates: ComplexArray, motion: ComplexArray, velocity: FloatArray) -> float:
        """Differentiate the power as the housing's mesh slides along the radiating surface [W per unit].

        Parameters
        ----------
        rates : ndarray of complex, shape (n_modes,)
            q̇.
        motion : ndarray of complex, shape (n_nodes, 3)
            Displacement u of the nodes at these rates [m].
        velocity : ndarray, shape (n_nodes, 3)
            Velocity of the nodes per unit of a parameter [m].
        """
        loads = zip(self.radiation.skins, self._corner_loads(rates), strict=True)
        total = sum(np.vdot(points.sliding(velocity, motion), load) for points, load in loads)
        return float((-1j * self.frequency * total).real)

    def _corner_loads(self, rates: ComplexArray) -> list[ComplexArray]:
        """∫ φ p_R dS at the corners of each surface's triangles [N], shape (3 n_triangles,)."""
        return [
            surface_load(field.surface, field.pressure_at_corners.real @ rates[:, None])[:, 0]
            for field in self.unit.fields
        ]


def _superposed(field: Field, rates: ComplexArray) -> Field:
    if isinstance(field, EquivalentField):
        return replace(field, velocity=field.velocity @ rates)
    assert isinstance(field, SoundField)
    summed = {name: getattr(field, name) @ rates for name in ("velocity", "pressure", "inside")}
    return replace(field, **summed)
