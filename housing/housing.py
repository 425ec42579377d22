"""Housing: mesh, materials, supports and other fixtures, bearing seats and sensors in one description; and its modes.

The description is complete: natural modes are those of the mesh with every fixture on it, so that no support can be
left out on the way to the eigensolver.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy import sparse

from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.assembly import assemble
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.material import Material, element_constants, enclosed_volume, mass_properties
from gearwhine.housing.model.bolted_joints import bolted_joint
from gearwhine.housing.model.bushings import Bushing, Joint, Mount
from gearwhine.housing.model.fixtures import Fixture, LumpedMass, attach_fixtures
from gearwhine.housing.model.patches import Patch, rigid_motions
from gearwhine.housing.model.seats import Seat, Sensor, SensorPort, seat_matrix, sensor_findings, sensor_port
from gearwhine.housing.model.supports import Support
from gearwhine.housing.modes.discretisation_error import discretisation_errors, fixture_nodes
from gearwhine.housing.modes.effective_mass import damping_ratios, modal_damping
from gearwhine.housing.modes.eigensolver import DEFAULT_SOLVER, Solver
from gearwhine.housing.modes.health import HealthReport, health_report
from gearwhine.housing.modes.housing_field import HousingField
from gearwhine.housing.modes.natural_modes import ModeSet, solve_modes
from gearwhine.meshes import Bolt, BoxGeometry, Mesh, diagnose, mesh_box, mesh_cad, read_mesh, with_bore
from gearwhine.meshes.box.surface_points import point_off_box
from gearwhine.numerics.findings import Finding, Instance, Number, Part, attribute_findings, kind_findings, refuse
from gearwhine.numerics.own_copies import keep_tuples

FloatArray = npt.NDArray[np.float64]

DAMPING_RATIO = 0.01
"""Modal damping ratio of a housing without one of its own: between that of welded or bolted steel (EN 1991-1-4,
table F.2) and of metal structures as cast (Adams and Askenazi 1998)."""

RESPONSE_ORDERS = 3
"""Responses of the discarded modes at each motion of a bearing: at rest, at the limit, and its derivative there."""

_TWO_PI = 2.0 * np.pi
_PART: Part = ("housing", "")


@dataclass(frozen=True)
class Housing:
    """A gearbox housing as it is built and held.

    Attributes
    ----------
    mesh : gearwhine.meshes.Mesh
        Mesh of the solid, with a surface for each seat.
    material : Material
        Material of all elements that are in no volume of ``materials``.
    materials : mapping of str to Material
        Material of each named volume of the mesh.
    fixtures : sequence of Support, Mount, Joint or LumpedMass
        Supports, mounts, joints between parts, and masses.
    seats : sequence of Seat
    sensors : sequence of Sensor
    damping_ratio : float
        Fraction of critical damping of every mode, in addition to the dashpots of the fixtures; 0.01 by default.

    Raises
    ------
    HousingError
        Where a part is of another kind, a name is given twice, the mesh lacks a volume or a seat's surface, a sensor is
        far from the surface, or the damping ratio is not from 0 to 1.
    """

    mesh: Mesh
    material: Material
    materials: Mapping[str, Material] = field(default_factory=dict)
    fixtures: Sequence[Fixture] = ()
    seats: Sequence[Seat] = ()
    sensors: Sequence[Sensor] = ()
    damping_ratio: float = DAMPING_RATIO

    def __post_init__(self) -> None:
        """Keep own copies; check unique names, volumes of the materials, and the damping ratio."""
        keep_tuples(self, "fixtures", "seats", "sensors")
        object.__setattr__(self, "materials", dict(self.materials))
        refuse(self._kind_findings(), HousingError)
        refuse(self._fit_findings(), HousingError)

    def _kind_findings(self) -> Iterator[Finding]:
        """Yield parts of another kind, and a damping ratio that none has."""
        material = Instance(Material, "a material")
        ratio = Number(at_least=0.0, below=1.0)
        yield from attribute_findings(
            _PART, self, mesh=Instance(Mesh, "a mesh"), material=material, damping_ratio=ratio
        )
        fixtures = (Support, Mount, Joint, LumpedMass)
        yield from kind_findings(_PART, self, fixtures=fixtures, seats=Seat, sensors=Sensor)

    def _fit_findings(self) -> Iterator[Finding]:
        """Yield names that are given twice or lead nowhere, and sensors far from the surface."""
        parts: dict[str, Sequence[Fixture | Seat | Sensor]] = {
            "seat": self.seats,
            "sensor": self.sensors,
            "fixture": self.fixtures,
        }
        for kind, entries in parts.items():
            names = [entry.name for entry in entries]
            for name in sorted({name for name in names if names.count(name) > 1}):
                yield Finding((kind, name), "name", name, f"each name once; it is given {names.count(name)} times")
        for name in self.materials:
            if name not in self.mesh.volumes:
                volumes = ", ".join(map(repr, sorted(self.mesh.volumes))) or "none"
                yield Finding(_PART, "materials", name, f"a volume of the mesh, one of {volumes}")
        for seat in self.seats:
            if seat.name not in self.mesh.surfaces:
                surfaces = ", ".join(map(repr, sorted(self.mesh.surfaces))) or "none"
                expected = f"the name of a surface of the mesh, one of {surfaces}"
                yield Finding(("seat", seat.name), "name", seat.name, expected)
        for sensor in self.sensors:
            yield from sensor_findings(self.mesh, sensor)

    @classmethod
    def from_step(
        cls,
        path: str | Path,
        mesh_size: float,
        material: Material,
        *,
        unit: float | None = None,
        seats: Sequence[Seat] = (),
        fixtures: Sequence[Fixture] = (),
        sensors: Sequence[Sensor] = (),
        damping_ratio: float = DAMPING_RATIO,
        order: int = 2,
    ) -> "Housing":
        """Mesh a solid from a STEP, IGES or BREP file.

        Parameters
        ----------
        path : path
        mesh_size : float
            Edge length of the tetrahedra [m].
        material : Material
        unit : float, optional
            Unit of the lengths in the file [m], where the file does not say.
        seats, fixtures, sensors, damping_ratio
            As :class:`Housing`. A seat with a diameter is found as a bore of the solid.
        order : {1, 2}
            Order of the elements.

        Raises
        ------
        gearwhine.meshes.GeometryError
            Where the file cannot be read or meshed, or has no bore where a seat is said to be.
        HousingError
            As :class:`Housing`.
        """
        refine = [(seat.center, seat.diameter) for seat in seats if seat.diameter is not None]
        meshed = mesh_cad(Path(path), mesh_size, unit=unit, order=order, refine=refine)
        mesh = _with_bores(meshed.mesh, seats)
        return cls(mesh, material, {}, fixtures, seats, sensors, damping_ratio)

    @classmethod
    def from_mesh_file(
        cls,
        path: str | Path,
        material: Material,
        *,
        unit: float = 1.0,
        seats: Sequence[Seat] = (),
        fixtures: Sequence[Fixture] = (),
        sensors: Sequence[Sensor] = (),
        damping_ratio: float = DAMPING_RATIO,
    ) -> "Housing":
        """Read a mesh of solid elements in any format that meshio, Abaqus, Nastran or gmsh writes.

        Parameters
        ----------
        path : path
        material : Material
        unit : float
            Unit of the lengths in the file [m].
        seats, fixtures, sensors, damping_ratio
            As :class:`Housing`. A seat with a diameter is found as a bore, unless a surface has its name.

        Raises
        ------
        gearwhine.meshes.GeometryError
            Where the file cannot be read, or has no bore where a seat is said to be.
        HousingError
            As :class:`Housing`.
        """
        mesh = _with_bores(read_mesh(path, unit=unit), seats)
        return cls(mesh, material, {}, fixtures, seats, sensors, damping_ratio)

    @classmethod
    def from_box(
        cls,
        box: BoxGeometry,
        mesh_size: float,
        material: Material,
        *,
        fixtures: Sequence[Fixture] = (),
        sensors: Sequence[Sensor] = (),
        damping_ratio: float = DAMPING_RATIO,
        order: int = 2,
    ) -> "Housing":
        """Mesh a box-shaped housing, with a seat in each of its bores and a joint at each bolt of its cover.

        Raises
        ------
        gearwhine.meshes.GeometryError
            Where the box cannot be meshed.
        HousingError
            As :class:`Housing`.
        """
        placed: Sequence[object] = sensors  # of any kind until the housing is made
        refuse(
            (
                Finding(("sensor", sensor.name), "position", sensor.position, expected)
                for sensor in placed
                if isinstance(sensor, Sensor)
                if (expected := point_off_box(sensor.position, box))
            ),
            HousingError,
        )
        mesh = mesh_box(box, mesh_size, order=order)
        seats = [Seat(bore.name, bore.center, bore.diameter, box.bore_depth(bore)) for bore in box.bores]
        fixtures = [*fixtures, *cover_joints(box, material)]
        return cls(mesh, material, {}, fixtures, seats, sensors, damping_ratio)

    def free_matrices(self) -> Matrices:
        """Stiffness and mass of the solid alone, without its fixtures."""
        return assemble(self.mesh, self.material, self.materials)

    def matrices(self, free: Matrices | None = None) -> Matrices:
        """Stiffness, mass and damping with every fixture on the solid.

        Parameters
        ----------
        free : Matrices, optional
            Result of :meth:`free_matrices`, where it is at hand.

        Raises
        ------
        HousingError, gearwhine.meshes.GeometryError
            Where a fixture finds no place on the mesh.
        """
        return attach_fixtures(self.free_matrices() if free is None else free, self.mesh, self.fixtures)

    def seat_ports(self) -> dict[str, sparse.csr_array]:
        """Rigid motion of each seat at its centre from the nodes' displacements, shape (6, 3 n_nodes)."""
        return {seat.name: seat_matrix(self.mesh, seat) for seat in self.seats}

    def sensor_ports(self) -> dict[str, SensorPort]:
        """Each sensor on its mesh."""
        return {sensor.name: sensor_port(self.mesh, sensor) for sensor in self.sensors}

    def modes(
        self,
        *,
        below_hz: float | None = None,
        count: int | None = None,
        bearings: Mapping[str, tuple[str, float]] | None = None,
        solver: Solver = DEFAULT_SOLVER,
        progress: Callable[[str], None] = lambda message: None,
    ) -> "HousingModes":
        """Natural modes, certified complete, with residual modes for the bearings.

        Parameters
        ----------
        below_hz : float
            Every mode below it is found [Hz]. Either this or ``count``.
        count : int
            Number of the lowest modes.
        bearings : mapping of str to (str, float), optional
            Places where the machine bears on the housing: for each bearing, its seat and its distance along z from the
            centre of the seat [m]. By default each seat stands for one bearing at its centre.
        solver : {"lanczos", "eigsh"}
            Eigensolver, see :func:`gearwhine.housing.solve_modes`.
        progress : callable
            Called with a line of text before each step.

        Raises
        ------
        HousingError
            Where the mesh is not sound, a bearing's seat does not exist, or a fixture finds no place.
        IncompleteModesError, ReductionError, HealthError
            Where the modes fail their certificate, their static compliance its proof, or the model its checks.
        """
        self.require_sound_mesh()
        seat_ports = self.seat_ports()
        places = {name: (name, 0.0) for name in seat_ports} if bearings is None else bearings
        for name, (seat, _) in places.items():
            if seat not in seat_ports:
                names = ", ".join(map(repr, seat_ports)) or "none"
                raise HousingError(f"bearing {name!r}: no seat {seat!r} in the housing; expected one of {names}")
        loaded = {name: bearing_port(seat_ports[seat], arm) for name, (seat, arm) in places.items()}
        progress(f"assembling {3 * len(self.mesh.points)} degrees of freedom")
        free = self.free_matrices()
        whole = self.matrices(free)
        modes = certified_modes(whole, loaded, below_hz=below_hz, count=count, solver=solver, progress=progress)
        modes = self.with_discretisation_errors(free, whole, modes)
        health = self.health(free, whole, modes)
        health.require()
        sensor_ports = self.sensor_ports()
        return HousingModes(
            housing=self,
            mode_set=modes,
            health=health,
            seats={name: modes.project_all(port) for name, port in seat_ports.items()},
            sensors={name: modes.project_all(port.matrix)[:, 0] for name, port in sensor_ports.items()},
            sensor_ports=sensor_ports,
            damping_matrix=modal_damping(modes, whole) if whole.damping.nnz else None,
            participation=self.participation(whole, modes),
        )

    def require_sound_mesh(self) -> None:
        """Refuse a mesh that cannot be computed with, or that falls into bodies which no joint connects.

        Raises
        ------
        HousingError
            With everything that is wrong.
        """
        joined = [fixture.nodes(self.mesh) for fixture in self.fixtures if isinstance(fixture, Joint)]
        wrong = [
            defect
            for defect in diagnose(self.mesh, joined=joined)
            if defect.name == "disconnected" or defect.severity == "error"
        ]
        if wrong:
            raise HousingError(
                "expected a sound mesh; " + "; ".join(f"{defect.name}: {defect.message}" for defect in wrong)
            )

    def participation(self, whole: Matrices, modes: ModeSet) -> FloatArray:
        """Participation φᵀ M R of modes and residual modes in the motions of the ground, shape (n, 6) [√kg, √kg m].

        R are the rigid motions along and about x, y, z through the origin. The sum is over every degree of freedom:
        what is fixed moves with the ground, and pulls by the consistent mass.
        """
        moved = whole.mass @ rigid_motions(self.mesh.points, np.zeros(3)).reshape(-1, 6)
        return modes.project_all(sparse.csr_array(moved.T))

    def with_discretisation_errors(self, free: Matrices, whole: Matrices, modes: ModeSet) -> ModeSet:
        """Return the modes with an estimate of each frequency's error by the mesh.

        Parameters
        ----------
        free, whole : Matrices
            Results of :meth:`free_matrices` and :meth:`matrices`.
        modes : ModeSet
            Modes of ``whole``.
        """
        errors = discretisation_errors(
            self.mesh,
            element_constants(self.mesh, self.material, self.materials),
            modes.frequencies,
            modes.shapes,
            loaded=fixture_nodes(free, whole),
        )
        return replace(modes, discretisation_errors=errors)

    def health(self, free: Matrices, whole: Matrices, modes: ModeSet) -> HealthReport:
        """Check a solved housing from its geometry to its modes.

        Parameters
        ----------
        free, whole : Matrices
            Results of :meth:`free_matrices` and :meth:`matrices`.
        modes : ModeSet
            Modes of ``whole``.
        """
        solid = mass_properties(self.mesh, self.material, self.materials)
        mass, center = solid.mass, solid.center
        if not self.materials:
            # With one material the boundary's volume gives the mass, independent of the elements inside.
            volume, center = enclosed_volume(self.mesh)
            mass = self.material.density * volume
        fastened = sum(fixture.mass for fixture in self.fixtures if isinstance(fixture, LumpedMass))
        return health_report(
            self.mesh,
            free,
            whole,
            [fixture for fixture in self.fixtures if isinstance(fixture, Support | Mount)],
            modes,
            mass=mass + fastened,
            # The geometry does not know the centres of lumped masses.
            center=None if fastened else center,
        )


@dataclass(frozen=True)
class HousingModes:
    """Natural modes of a housing, with their motions at seats and sensors, damping and participation.

    Attributes
    ----------
    housing : Housing
    mode_set : ModeSet
        Frequencies, shapes, certificate and residual modes.
    health : HealthReport
    seats : mapping of str to ndarray, shape (n, 6)
        Motions of modes and residual modes at each seat.
    sensors : mapping of str to ndarray, shape (n,)
        Motions of modes and residual modes along each sensor.
    sensor_ports : mapping of str to SensorPort
        Sensors on the mesh.
    damping_matrix : ndarray, shape (n, n), or None
        Φᵀ C Φ of the fixtures' dashpots [1/s].
    participation : ndarray, shape (n, 6)
        φᵀ M R of the rigid motions along and about x, y, z through the origin [√kg, √kg m].
    """

    housing: Housing
    mode_set: ModeSet
    health: HealthReport
    seats: Mapping[str, FloatArray]
    sensors: Mapping[str, FloatArray]
    sensor_ports: Mapping[str, SensorPort]
    damping_matrix: FloatArray | None
    participation: FloatArray

    @property
    def frequencies_hz(self) -> FloatArray:
        """Natural frequencies [Hz], shape (n_modes,)."""
        return self.mode_set.frequencies_hz

    @property
    def displacement_field(self) -> HousingField:
        """Its mesh, and the shapes of modes and residual modes on that."""
        bores = [seat.diameter for seat in self.housing.seats if seat.diameter is not None]
        return HousingField(self.housing.mesh, self.mode_set, max(bores, default=None))

    @property
    def damping_ratios(self) -> FloatArray:
        """Fraction of critical damping of each mode with its own share of the dashpots, shape (n_modes,)."""
        ratios = np.full(len(self.mode_set.frequencies), self.housing.damping_ratio)
        return damping_ratios(self.mode_set.frequencies, ratios, self.damping_matrix)


def certified_modes(
    whole: Matrices,
    loaded: Mapping[str, sparse.csr_array],
    *,
    below_hz: float | None,
    count: int | None,
    solver: Solver,
    progress: Callable[[str], None],
) -> ModeSet:
    """Certified modes of a housing with residual modes for the bearings' ports, see :meth:`Housing.modes`."""
    return solve_modes(
        whole,
        frequency_limit=None if below_hz is None else _TWO_PI * below_hz,
        count=count,
        ports=sparse.vstack(list(loaded.values()), format="csr") if loaded else None,
        port_orders=RESPONSE_ORDERS,
        solver=solver,
        progress=progress,
    )


def bearing_port(seat: sparse.csr_array, arm: float) -> sparse.csr_array:
    """Return the port of a bearing: motions x, y, z and rotations about x, y from the nodes', shape (5, 3 n_nodes).

    They are those of its seat at a distance from its centre [m]. The transpose spreads a bearing force over the nodes.

    Any bearing can load these; none loads the rotation about z, in which the shaft turns.
    """
    # A rotation about y moves a point above the centre towards +x, one about x towards -y.
    turned = sparse.diags_array([arm, -arm], dtype=np.float64) @ seat[[4, 3]]
    return sparse.csr_array(sparse.vstack([seat[[0, 1]] + turned, seat[[2, 3, 4]]]))


def cover_joints(
    box: BoxGeometry,
    material: Material,
    bolt_material: Material | None = None,
    cover_material: Material | None = None,
) -> list[Joint]:
    """Preloaded bolts of a box's cover, each a joint between its patches on rim and cover.

    Parameters
    ----------
    box : gearwhine.meshes.BoxGeometry
    material : Material
        Material of the housing.
    bolt_material, cover_material : Material, optional
        Materials of the bolts and of the cover; that of the housing by default.
    """
    return [cover_joint(box, bolt, material, bolt_material, cover_material) for bolt in box.bolts]


def cover_joint(
    box: BoxGeometry,
    bolt: Bolt,
    material: Material,
    bolt_material: Material | None = None,
    cover_material: Material | None = None,
) -> Joint:
    """Preloaded bolt of a box's cover, as :func:`cover_joints` has all of them."""
    outer = max(box.rim_width, bolt.patch_diameter)  # a narrow rim leaves the cone of pressure no more than its width
    cover = None if cover_material is None else (cover_material, bolt.cover_grip)
    springs = bolted_joint(bolt.diameter, bolt.grip, material, bolt_material, cover=cover, outer=outer).stiffness
    first, second = Patch(bolt.body_surface), Patch(bolt.cover_surface)
    return Joint(bolt.name, first, second, Bushing.along(bolt.axis, springs), bolt.position)


def _with_bores(mesh: Mesh, seats: Sequence[Seat]) -> Mesh:
    """Return the mesh with a named surface for each seat that is given by a diameter."""
    for seat in seats:
        if seat.diameter is not None:
            mesh = with_bore(mesh, seat.name, seat.center, seat.diameter)
    return mesh
