"""Load shuttling: motion of the centre of the tooth load along the face, and the moment by which it tilts the shafts.

The force F of a mesh acts where the load per width q of its contact lines has its centre, not at the middle of the
face. From the middle of the face along the shafts, and from the pitch point along the line of action, that is

    z̄ = ∫ z q dz / F,        ξ̄ = ∫ ξ q dz / F,

both periodic with the mesh in helical gears, and constant offsets besides where flanks are misaligned (load shuttling:
Borner and Houser, SAE 961816, 1996). With e the direction in which the driver pushes and h the axial part
of the force over F, a force F (e, h) at that place has the moment of the same force at the pitch point and

    M = F (z̄ - h ξ̄) (-e_y, e_x)

about the driven gear's centre; the moment on the driver is opposite. Both arms are those of static equilibrium under
the mean force, which stands for F in M: the dynamic part of the force would add a product of two small quantities.
The flanks are held there: their gap over the face is that of the mean load at every phase. How far the shafts yield to
the moments, and how the flanks answer that, is the machine's motion, in which the mesh resists tilting
(:mod:`gearwhine.coupling.machine.mesh_face`); so nothing counts twice. The moments act on the slope of the
approach over the face, which is the tilt of the shafts and their twist over the face, by z̄, and on their tilt by -h
ξ̄. The mean moments are those of the mesh's law over its face.

Teeth that are not alike, by pitch deviations or damage, have other arms in each mesh period. The harmonics of the mesh
are those of the mean of all mesh periods of the hunting period; the sidebands of the arms about them are left out.
"""

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.gears import GearError, GearPairGeometry, ToothContact, loaded_transmission_error
from gearwhine.coupling.gears.contact.contact_law import places_on_line_of_action
from gearwhine.coupling.gears.loaded.transmission_error import different_periods
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.numerics.arrays import FloatArray

_POINTS = 128  # number of phases of a mesh period
_PERIODS = 128  # largest number of mesh periods that are solved for the mean over the hunting period
_HARMONICS = 6  # largest number of mesh harmonics
_SMALL_HARMONIC_SHARE = 0.01  # part of the greatest harmonic below which the last ones are left out
_NO_ARM = 1e-9  # part of the face width that is rounding


def load_arms(contact: ToothContact, geometry: GearPairGeometry, force: float, phases: npt.ArrayLike) -> FloatArray:
    """Centre of the load of a mesh, z̄ along the face and ξ̄ along the line of action [m], shape (n, 2).

    Zeros where the contact does not resolve its face.

    Parameters
    ----------
    contact : ToothContact
    geometry : GearPairGeometry
    force : float
        Force along the line of action, above 0 [N].
    phases : array_like, shape (n,)
        Mesh periods.

    Raises
    ------
    GearError
        Where no teeth meet at some phase, or for a force below 0.
    """
    mesh = loaded_transmission_error(contact, force, phases)
    arms = np.zeros((mesh.phases.size, 2))
    if contact.faces is None or mesh.line_loads is None:
        return arms
    z, along = contact.faces.z, places_on_line_of_action(contact, geometry, mesh.positions)
    shares = mesh.line_loads / mesh.line_loads.sum(axis=(1, 2))[:, None, None]
    arms[:, 0] = (shares * z).sum(axis=(1, 2))
    # Slots without a pair carry no load, whatever their position.
    arms[:, 1] = np.where(shares > 0.0, shares * along, 0.0).sum(axis=(1, 2))
    return arms


def mean_load_arms(
    contact: ToothContact, geometry: GearPairGeometry, force: float, phases: npt.ArrayLike
) -> FloatArray:
    """Load arms at phases of a mesh period, each the mean over all mesh periods of the hunting period, shape (n, 2).

    See `load_arms`; `phases` (n,) are those of the first mesh period. Where more than `_PERIODS` mesh periods differ,
    as with pitch deviations of both gears, the mean is that of as many, evenly spread over the hunting period.
    """
    at = np.asarray(phases, dtype=np.float64)
    if contact.hunting_period == 1:
        return load_arms(contact, geometry, force, at)
    first, which = different_periods(contact)
    periods, counts = first, np.bincount(which)
    if first.size > _PERIODS:
        periods = np.arange(_PERIODS) * which.size // _PERIODS
        counts = np.ones(_PERIODS, dtype=np.int64)
    arms = np.array([load_arms(contact, geometry, force, at + period) for period in periods])
    return np.asarray(np.tensordot(counts / counts.sum(), arms, axes=1))


def shuttling_loads(
    contact: ToothContact,
    geometry: GearPairGeometry,
    force: float,
    axial: float,
    tilting: FloatArray,
    phase: float,
    mesh_frequency: float,
) -> tuple[FloatArray, list[HarmonicLoad]]:
    """Moments of a mesh's load about the middle of the face, as a constant load and harmonics of the mesh frequency.

    Parameters
    ----------
    contact : ToothContact
        Contact law of the loaded flanks.
    geometry : GearPairGeometry
        Geometry of the loaded flanks.
    force : float
        Mean mesh force F, above 0 [N].
    axial : float
        Axial part h of the force over F, as the driven gear feels it.
    tilting : ndarray, shape (n,) or (2, n)
        Compression of the mesh by each coordinate, for each metre that the load is off the middle of the face, and off
        the pitch point times -h: slope of the approach over the face and tilt of the shafts
        (:mod:`gearwhine.coupling.machine.mesh_face`). One row stands for both.
    phase : float
        Mesh phase at t = 0 [mesh periods].
    mesh_frequency : float
        [Hz]; negative for flanks met in the opposite order.

    Returns
    -------
    constant : ndarray, shape (n,)
    harmonics : list of HarmonicLoad
    """
    rows = np.broadcast_to(tilting, (2, tilting.shape[-1]))
    nothing = np.zeros(tilting.shape[-1])
    if contact.faces is None or not np.any(tilting):
        return nothing, []
    try:
        arms = (
            mean_load_arms(contact, geometry, force, np.arange(_POINTS) / _POINTS)
            if mesh_frequency != 0.0
            else load_arms(contact, geometry, force, [phase])
        )
    except GearError:
        return nothing, []
    arms = arms * [1.0, -axial]
    if np.abs(arms).max() <= _NO_ARM * contact.faces.face_width:
        return nothing, []
    spectrum = np.fft.rfft(arms, axis=0) / len(arms)
    orders = np.arange(1, min(_HARMONICS, len(spectrum) - 1) + 1)
    amplitudes = 2.0 * spectrum[orders]
    if mesh_frequency < 0.0:
        amplitudes = amplitudes.conj()
    amplitudes = amplitudes * np.exp(2j * np.pi * np.sign(mesh_frequency) * orders * phase)[:, None]
    size = np.abs(amplitudes).sum(axis=1)
    heard = size > max(_SMALL_HARMONIC_SHARE * size.max(initial=0.0), _NO_ARM * contact.faces.face_width)
    # The load on the coordinates is minus the force times the compression's gradient.
    harmonics = [
        HarmonicLoad(2.0 * np.pi * order * abs(mesh_frequency), -force * amplitude @ rows, "turning", "load_shuttling")
        for order, amplitude in zip(orders[heard].tolist(), amplitudes[heard], strict=True)
    ]
    return -force * spectrum[0].real @ rows, harmonics
