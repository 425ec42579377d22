r"""Face of a mesh: tilting stiffness of the flanks, stiffness centre, and the moments of a load off the middle.

The contact forces of a mesh are spread over its face. So the mesh resists not only the approach of its flanks, but also
the slope of the approach over the face and, with helical gears, the relative tilt of the shafts at the place on the
line of action where the teeth touch. With δ the mean approach over the face and y = (slope, tilt), the mean over a mesh
period of the loads under a mean force F is, linear in y about the mean load,

    force:   F(δ*),        δ* = δ + a (y - y₀),
    moments: M = M₀ + a (F(δ*) - F₀) + K (y - y₀),

with a the place of the stiffness centre, K the stiffness that resists tilting about it, F₀ and M₀ the mean force and
moments on flanks with the gap of the contact's face slices, all of
:class:`gearwhine.coupling.gears.loaded.face_load.FaceTangent`. The gap is that under the mean load, whether the case
gives it or the operating point found it, so y₀ is the mean slope in the machine under its mean load; the gap is none of
the tilt, of which y₀ is 0. The static equilibrium has the same law: its tangent is this one. So the mesh is two
connectors: the tooth contact F(δ*), whose kernel stays the scalar one and whose direction is that of the stiffness
centre, and a linear connector over y with the stiffness K and the offset M₀ - a F₀ - K y₀.

The modes of the shafts are exact in their static response to the force in the middle of the face. What they lack of the
response to the slope and the tilt, and to the spread of the force, is a compliance R over (δ, y) in series with the
slices' tangent (:mod:`gearwhine.coupling.machine.face_compliance`): (K⁻¹ + R)⁻¹, of which a and K are taken.
R has nothing from mesh to mesh of one gear; the shafts have ports at both ends of such a face, so that their modes lack
little there.

K resists as long as flanks touch. It is linear about the mean load, so it does not end where a mesh loses contact in
motion; linear analyses leave it out where the contact has parted. Flanks without a mean load have a and K of all
slices on the path of contact. The damping of K is that of the contact in proportion to the stiffness.

What the loads do over a mesh period beside their mean is load shuttling
(:mod:`gearwhine.coupling.machine.load_shuttling`), of flanks that are held at y₀; the machine's motion is
their answer. a and K are those of the mean over a mesh period.
"""

from dataclasses import dataclass, replace

import numpy as np

from gearwhine.coupling.gears import GearError, GearPairGeometry, ToothContact
from gearwhine.coupling.gears.contact.face_slices import face_stations, mean_and_slope
from gearwhine.coupling.gears.loaded.face_load import FaceContact, FaceTangent
from gearwhine.coupling.machine.connectors import ContactConnector, LinearConnector
from gearwhine.coupling.machine.coordinates import MachineCoordinates
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.machine.load_shuttling import shuttling_loads
from gearwhine.coupling.machine.mesh_kinematics import LineOfAction
from gearwhine.coupling.machine.mounted_parts import GearMesh
from gearwhine.numerics.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class MeshFace:
    """Face of one side of the teeth of a mesh in the machine.

    Attributes
    ----------
    contact : ToothContact
        Contact law of these flanks.
    geometry : GearPairGeometry
    line : LineOfAction
    approach : ndarray, shape (n,)
        Mean approach over the face by each coordinate.
    tilting : ndarray, shape (2, n)
        Slope of the approach over the face, and tilt of the shafts in the plane of action, by each coordinate.
    flanks : FaceContact or None
        The contact by its slices; None where nothing is known of its face.
    compliance : ndarray, shape (3, 3)
        Compliance of the shafts over the face that their modes lack, over mean approach, slope and tilt.
    """

    contact: ToothContact
    geometry: GearPairGeometry
    line: LineOfAction
    approach: FloatArray
    tilting: FloatArray
    flanks: FaceContact | None
    compliance: FloatArray

    @property
    def yields(self) -> bool:
        """Whether the face has slices, and any coordinate tilts it."""
        return self.flanks is not None and bool(np.any(self.tilting))

    @property
    def rows(self) -> FloatArray:
        """Mean approach over the face, its slope and the tilt by each coordinate, shape (3, n)."""
        return np.vstack([self.approach, self.tilting])

    def law(self, force: float, stiffness: float, points: int | None = None) -> FloatArray:
        """Linear law of the mesh over `rows` about a mean force [N], (3, 3); its damping is in proportion.

        Parameters
        ----------
        force : float
        stiffness : float
            Mean mesh stiffness [N/m].
        points : int, optional
            Number of phases of the mean over a mesh period.
        """
        tangent = self.tangent(force, points=points)
        arms = np.append(1.0, tangent.centre)
        law = stiffness * np.outer(arms, arms)
        law[1:, 1:] += tangent.stiffness
        return law

    def tangent(self, force: float, phase: float | None = None, points: int | None = None) -> FaceTangent:
        """Mean tangent under a mean mesh force [N]; of all slices on the path of contact without one.

        The moments are those at a phase [mesh periods] where one is given. The mean is over a number of phases. A mesh
        without slices resists in the middle of its face alone.
        """
        if self.flanks is None:
            return FaceTangent(self.contact.unloaded_mean_mesh_stiffness, np.zeros(2), np.zeros((2, 2)), np.zeros(2))
        if force <= 0.0:
            return self.flanks.unloaded_tangent.in_series(self.compliance)
        still = np.zeros(self.flanks.size)
        try:
            over = None if points is None else (np.arange(points) + 0.5) / points
            tangent = self.flanks.tangent(self.flanks.under_force(force, still, over)).in_series(self.compliance)
            if phase is None:
                return tangent
            at_phase = self.flanks.tangent(self.flanks.under_force(force, still, np.array([phase])))
            return replace(tangent, moments=at_phase.moments)
        except GearError:
            return self.flanks.unloaded_tangent.in_series(self.compliance)

    def centred(self, contact: ContactConnector, tangent: FaceTangent, slope: float) -> ContactConnector:
        """Return a contact in the middle of the face as one at the stiffness centre, at a mean slope."""
        return replace(
            contact,
            direction=self.approach + tangent.centre @ self.tilting,
            # Of the compression at the centre this part is no approach of the flanks as a whole.
            clearance=contact.clearance + float(tangent.centre[0]) * slope,
        )

    def connector(
        self,
        number: int,
        contact: ContactConnector,
        tangent: FaceTangent,
        force: float,
        stiffness: float,
        slope: float | None,
    ) -> LinearConnector:
        """Connector of the flanks' resistance to tilting.

        Parameters
        ----------
        number : int
            Number of the contact.
        contact : ContactConnector
        tangent : FaceTangent
        force : float
            Mean mesh force [N].
        stiffness : float
            Mean mesh stiffness [N/m].
        slope : float or None
            Mean slope of the approach over the face, where the moments are those of the tangent [rad]; None for flanks
            that have these moments at any slope, by which the mean one is found.
        """
        resisting = tangent.stiffness.copy()
        offset = tangent.moments - tangent.centre * force
        if slope is None:
            resisting[:, 0] = 0.0
        else:
            offset = offset - resisting[:, 0] * slope
        damping = contact.contact.damping / stiffness * resisting
        return LinearConnector(
            f"{contact.name}, tilt", self.tilting.T, resisting, damping, offset=offset, of_contact=number
        )

    def shuttling(self, force: float, phase: float, mesh_frequency: float) -> tuple[FloatArray, list[HarmonicLoad]]:
        """Moments of load shuttling, see `gearwhine.coupling.machine.load_shuttling.shuttling_loads`."""
        return shuttling_loads(self.contact, self.geometry, force, self.line.axial, self.tilting, phase, mesh_frequency)

    def with_contact(self, contact: ToothContact) -> "MeshFace":
        """Return the face of the same flanks with another tooth contact, whose slices lie where this one's do."""
        if self.flanks is None:
            return replace(self, contact=contact)
        sound = contact.teeth_alike
        if contact.faces is None:
            sound = replace(sound, faces=self.flanks.tooth_contact.faces)
        flanks = FaceContact(sound, self.geometry, self.flanks.stations, self.line.axial)
        return replace(self, contact=contact, flanks=flanks)


def mesh_face(
    coordinates: MachineCoordinates, mesh: GearMesh, sense: int, contact: ToothContact, middle: FloatArray
) -> MeshFace:
    """Face of the flanks that a driver closes by a rotation of a sense, with the contact law ``contact``.

    ``middle`` is the approach in the middle of the face by each coordinate, shape (n,). The stations of the face move
    with the sections of the shafts that carry them, as in the static model
    (:mod:`gearwhine.coupling.statics.static_model`).
    """
    line = mesh.line_of_action(sense)
    stations = face_stations(mesh.geometry.face_width)
    over = np.zeros((stations.size, coordinates.size))
    tilt = np.zeros(coordinates.size)
    for mounted, at, flank in zip((mesh.driver, mesh.driven), mesh.stations, (line.driver, line.driven), strict=True):
        rotor = coordinates.rotor(mounted.rotor)
        here, turned = rotor.motions(at), rotor.rotation(at)
        body = rotor.plate_rows(mounted.name, flank.arm)
        over_face, against_axis = flank.across(body[1:3]), flank.across(body[3:])
        rows = []
        for station in (at + stations).tolist():
            carrier = min(max(station, mounted.carried[0]), mounted.carried[1]) if mounted.carried else at
            section = rotor.motions(carrier)
            moved = flank.across(section) - flank.across(here) + (station - carrier) * flank.tilting(section)
            moved = moved + (station - at) * over_face
            rows.append(moved + flank.turning(rotor.rotation(carrier) - turned))
        over += coordinates.rows(mounted.rotor, np.array(rows))
        tilt += coordinates.rows(mounted.rotor, flank.tilting(here) + against_axis)
    slices = contact.faces or mesh.faces
    flanks = None
    z = stations
    if slices is not None:
        sound = replace(contact.teeth_alike, faces=slices)
        flanks, z = FaceContact(sound, mesh.geometry, stations, line.axial), slices.z
    mean, slope = mean_and_slope(stations, z)
    compliance = mesh.driver.compliance(mesh.geometry.driver) + mesh.driven.compliance(mesh.geometry.driven)
    tilting = np.array([slope @ over, tilt])
    return MeshFace(contact, mesh.geometry, line, middle + mean @ over, tilting, flanks, compliance)
