"""Housing: mesh, materials, supports and other fixtures, bearing seats and sensors in one description; and its modes.

The description is complete: natural modes are those of the mesh with every fixture on it, so that no support can be
left out on the way to the eigensolver. :class:`HousingModes` has of the solved housing what a machine takes (motions of
seats and sensors, damping), what a measurement is compared with, and what sound and pictures need.
"""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import linalg, sparse

from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.assembly import assemble
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.fem.slepc import SlepcUnavailableError
from gearwhine.housing.material import (
    MassProperties,
    Material,
    element_constants,
    enclosed_volume,
    mass_properties,
)
from gearwhine.housing.measured.survey_planning import Survey, survey_grid
from gearwhine.housing.model.bushings import Joint, Mount
from gearwhine.housing.model.cover_bolts import cover_joints
from gearwhine.housing.model.fixtures import Fixture, LumpedMass, attach_fixtures, fixture_kind
from gearwhine.housing.model.patches import Patch, rigid_motions
from gearwhine.housing.model.seats import (
    Seat,
    Sensor,
    SensorPort,
    bearing_port,
    ring_port,
    seat_matrix,
    sensor_findings,
    sensor_port,
)
from gearwhine.housing.model.supports import Support
from gearwhine.housing.model_warnings import (
    defect_warnings,
    discretisation_warnings,
    health_warnings,
    surface_point_warnings,
)
from gearwhine.housing.modes.discretisation_error import discretisation_errors, fixture_nodes
from gearwhine.housing.modes.dominance import Dominance, dominance
from gearwhine.housing.modes.effective_mass import EffectiveMass, damping_ratios, effective_mass, modal_damping
from gearwhine.housing.modes.eigensolver import DEFAULT_SOLVER, Solver
from gearwhine.housing.modes.health import HealthReport, health_report
from gearwhine.housing.modes.housing_field import HousingField
from gearwhine.housing.modes.natural_modes import ModeSet, solve_modes
from gearwhine.housing.modes.receptance import Selection, select_modes
from gearwhine.housing.modes.residual_modes import leading_residual_modes
from gearwhine.housing.storage.check_documents import check_document, effective_mass_of, health_of
from gearwhine.housing.storage.mode_file import ModeRecord, with_sensors
from gearwhine.housing.storage.netcdf import LabelledArray
from gearwhine.meshes import (
    BoxGeometry,
    GeometryError,
    Mesh,
    MeshDefect,
    diagnose,
    mesh_box,
    mesh_cad,
    read_mesh,
    with_bore,
)
from gearwhine.meshes.box.surface_points import point_off_box
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import (
    Finding,
    Instance,
    Number,
    Numbers,
    Part,
    Rule,
    argument_findings,
    attribute_findings,
    kind_findings,
    refuse,
)
from gearwhine.numerics.own_copies import keep_tuples
from gearwhine.numerics.result_warnings import ResultWarning, warning

DAMPING_RATIO = 0.01
"""Modal damping ratio of a housing without one of its own: between that of welded or bolted steel (EN 1991-1-4,
table F.2) and of metal structures as cast (Adams and Askenazi 1998)."""

RESPONSE_ORDERS = 3
"""Responses of the discarded modes at each motion of a bearing: at rest, at the limit, and its derivative there."""

DampingRatio = float | Sequence[float] | Mapping[float, float]
"""One modal damping ratio of all modes, one of each mode from the lowest on, or ratios by frequency [Hz], linear
between."""

_TWO_PI = 2.0 * np.pi
_PART: Part = ("housing", "")
_HIGHEST, _COUNT = Number(above=0.0, optional=True, unit="Hz"), Number(at_least=1, optional=True, whole=True)
_UPWARDS = (0.0, 1.0, 0.0)
_DAMPING = "modal_damping"  # name of the damping matrix in a mode-set file
_RESPONSES = "responses_"  # begin of the names of further responses in that file
_COORDINATES = ("coordinate", "other_coordinate")
_SELECTION_TOLERANCE = 0.05  # of the largest receptance between bearings and sensors, for the selection of modes


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
    damping_ratio : float, sequence of float, or mapping of float to float
        Fraction of critical damping in addition to the dashpots of the fixtures: of every mode, of each mode from the
        lowest on (rigid motions included), or by frequency [Hz], linear between; 0.01 by default.
    mesh_size : float, optional
        Edge length of the elements, where the solid is meshed by one [m]; warnings of a coarse mesh give a better one.
    outer_faces : pair of points, optional
        Low and high corners of the box of its walls [m], without feet and bosses, over whose faces the points of a
        survey are spread; by default those of the mesh.
    up : tuple of float
        Unit vector that points upwards in pictures.
    box : gearwhine.meshes.BoxGeometry, optional
        Dimensions of the box that is meshed, whose walls are parameters then.

    Raises
    ------
    HousingError
        Where a part is of another kind, a name is given twice, the mesh lacks a volume or a seat's surface, a sensor is
        far from the surface, or a damping ratio is not from 0 to 1.
    """

    mesh: Mesh
    material: Material
    materials: Mapping[str, Material] = field(default_factory=dict)
    fixtures: Sequence[Fixture] = ()
    seats: Sequence[Seat] = ()
    sensors: Sequence[Sensor] = ()
    damping_ratio: DampingRatio = DAMPING_RATIO
    mesh_size: float | None = None
    outer_faces: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None
    up: tuple[float, float, float] = _UPWARDS
    box: BoxGeometry | None = None

    def __repr__(self) -> str:
        """Return the mesh and what is on it in a line."""
        parts = ("seats", self.seats), ("sensors", self.sensors), ("fixtures", self.fixtures)
        listed = "; ".join(f"{kind} {', '.join(one.name for one in entries)}" for kind, entries in parts if entries)
        return f"<Housing: {len(self.mesh.points)} nodes; {listed or 'nothing on it'}>"

    def __post_init__(self) -> None:
        """Keep own copies; check unique names, volumes of the materials, and the damping ratios."""
        keep_tuples(self, "fixtures", "seats", "sensors", "damping_ratio", "outer_faces", "up")
        object.__setattr__(self, "materials", dict(self.materials))
        if isinstance(self.damping_ratio, Mapping):
            object.__setattr__(self, "damping_ratio", dict(self.damping_ratio))
        refuse(self._kind_findings(), HousingError)
        refuse(self._fit_findings(), HousingError)

    def _kind_findings(self) -> Iterator[Finding]:
        """Yield parts of another kind, and damping ratios that none has."""
        ratio = Number(at_least=0.0, below=1.0)
        rules: dict[str, Rule] = {
            "mesh": Instance(Mesh, "a mesh"),
            "material": Instance(Material, "a material"),
            "mesh_size": Number(above=0.0, optional=True, unit="m"),
            "up": Numbers(3),
            "box": Instance(BoxGeometry, "the dimensions of a box, or None", optional=True),
        }
        if isinstance(self.damping_ratio, Mapping):
            for frequency, value in self.damping_ratio.items():
                if not (Number(at_least=0.0).accepts(frequency) and ratio.accepts(value)):
                    expected = f"frequencies of at least 0 Hz, and for each {ratio.expected}"
                    yield Finding(_PART, "damping_ratio", {frequency: value}, expected)
            if not self.damping_ratio:
                yield Finding(_PART, "damping_ratio", {}, "a ratio at one frequency at least")
        else:
            rules["damping_ratio"] = Numbers(None, ratio) if isinstance(self.damping_ratio, tuple) else ratio
        yield from attribute_findings(_PART, self, **rules)
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
        surfaces = ", ".join(map(repr, sorted(self.mesh.surfaces))) or "none"
        for seat in self.seats:
            if seat.name not in self.mesh.surfaces:
                expected = f"the name of a surface of the mesh, one of {surfaces}"
                yield Finding(("seat", seat.name), "name", seat.name, expected)
        for fixture in self.fixtures:
            places: tuple[Patch | Support | None, ...] = ()
            if isinstance(fixture, Joint):
                places = (fixture.first, fixture.second)
            elif isinstance(fixture, Mount | LumpedMass):
                places = (fixture.patch,)
            elif isinstance(fixture, Support):
                places = (fixture,)
            for surface in (place.surface for place in places if place is not None):
                if surface is not None and surface not in self.mesh.surfaces:
                    expected = f"the name of a surface of the mesh, one of {surfaces}"
                    yield Finding((fixture_kind(fixture), fixture.name), "surface", surface, expected)
        for sensor in self.sensors:
            yield from sensor_findings(self.mesh, sensor)

    @property
    def findings(self) -> Iterator[Finding]:
        """Unlikely numbers of its materials."""
        yield from self.material.findings
        for name, material in self.materials.items():
            yield from (replace(finding, part=("material", name)) for finding in material.findings)

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
        damping_ratio: DampingRatio = DAMPING_RATIO,
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
        return cls(mesh, material, {}, fixtures, seats, sensors, damping_ratio, mesh_size)

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
        damping_ratio: DampingRatio = DAMPING_RATIO,
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
        damping_ratio: DampingRatio = DAMPING_RATIO,
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
        x, y, z = box.size
        faces = ((-0.5 * x, 0.0, -0.5 * z), (0.5 * x, y, 0.5 * z))
        return cls(mesh, material, {}, fixtures, seats, sensors, damping_ratio, mesh_size, faces, box=box)

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
        HousingError
            Where fixtures find no place on the mesh, with all of them.
        """
        return attach_fixtures(self.free_matrices() if free is None else free, self.mesh, self.fixtures)

    def seat_ports(self) -> dict[str, sparse.csr_array]:
        """Rigid motion of each seat at its centre from the nodes' displacements, shape (6, 3 n_nodes)."""
        return {seat.name: seat_matrix(self.mesh, seat) for seat in self.seats}

    def ring_ports(self) -> dict[str, sparse.csr_array]:
        """Deformation of the bore of each seat with a ring gear, shape (2 + 4 orders, 3 n_nodes)."""
        return {seat.name: ring_port(self.mesh, seat) for seat in self.seats if seat.ring_orders}

    def sensor_ports(self) -> dict[str, SensorPort]:
        """Each sensor on its mesh."""
        return {sensor.name: sensor_port(self.mesh, sensor) for sensor in self.sensors}

    @property
    def attached_mass(self) -> float:
        """Sum of the lumped masses [kg]."""
        return sum(fixture.mass for fixture in self.fixtures if isinstance(fixture, LumpedMass))

    @property
    def widest_bore(self) -> float | None:
        """Diameter of its widest seat [m]; None where none is known."""
        return max((seat.diameter for seat in self.seats if seat.diameter is not None), default=None)

    def solid(self) -> MassProperties:
        """Mass and centre of gravity of the solid alone, by its elements."""
        return mass_properties(self.mesh, self.material, self.materials)

    def modal_damping_ratios(self, frequencies_hz: FloatArray) -> FloatArray:
        """Fraction of critical damping of modes at natural frequencies [Hz], without the dashpots of the fixtures.

        Raises
        ------
        HousingError
            Where there are more modes than the damping ratio lists.
        """
        given = self.damping_ratio
        if isinstance(given, Mapping):
            places, ratios = np.array(sorted(given.items())).T
            return np.asarray(np.interp(frequencies_hz, places, ratios))
        if isinstance(given, Sequence):
            count = len(frequencies_hz)
            if len(given) < count:
                expected = f"a ratio for each of the {count} modes found"
                refuse([Finding(_PART, "damping_ratio", given, expected)], HousingError)
            return np.array(given[:count])
        return np.full(len(frequencies_hz), float(given))

    def modes(
        self,
        *,
        below_hz: float | None = None,
        count: int | None = None,
        bearings: Mapping[str, tuple[str, float]] | None = None,
        solver: Solver = DEFAULT_SOLVER,
        defects: Sequence[MeshDefect] | None = None,
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
        solver : {"lanczos", "eigsh", "slepc"}
            Eigensolver, see :func:`gearwhine.housing.solve_modes`.
        defects : sequence of MeshDefect, optional
            Defects of the mesh where they are known and allowed; found here by default, and refused where the mesh
            cannot be computed with or falls into bodies that no joint connects.
        progress : callable
            Called with a line of text before each step.

        Raises
        ------
        HousingError
            Where the mesh is not sound, a bearing's seat does not exist, fixtures find no place, or the model does not
            have the modes that are asked for.
        IncompleteModesError, ReductionError, HealthError
            Where the modes fail their certificate, their static compliance its proof, or the model its checks.
        """
        given = {"below_hz": (below_hz, _HIGHEST), "count": (count, _COUNT)}
        refuse(argument_findings(_PART, given), HousingError)
        defects = self._sound_mesh_defects() if defects is None else defects
        seat_ports = self.seat_ports()
        places = {name: (name, 0.0) for name in seat_ports} if bearings is None else dict(bearings)
        for name, (seat, _) in places.items():
            if seat not in seat_ports:
                names = ", ".join(map(repr, seat_ports)) or "none"
                raise HousingError(f"bearing {name!r}: no seat {seat!r} in the housing; expected one of {names}")
        loaded = [bearing_port(seat_ports[seat], arm) for seat, arm in places.values()]
        loaded += self.ring_ports().values()
        progress(f"assembling {3 * len(self.mesh.points)} degrees of freedom")
        begin = time.perf_counter()
        free = self.free_matrices()
        whole = self.matrices(free)
        assembled = time.perf_counter() - begin
        estimates: list[Future[FloatArray]] = []
        # The estimate needs no residual modes, which leave a thread idle for a good part of their time.
        with ThreadPoolExecutor(1) as beside:
            try:
                modes = solve_modes(
                    whole,
                    frequency_limit=None if below_hz is None else _TWO_PI * below_hz,
                    count=count,
                    ports=sparse.vstack(loaded, format="csr") if loaded else None,
                    port_orders=RESPONSE_ORDERS,
                    solver=solver,
                    progress=progress,
                    found=lambda *modes: estimates.append(
                        beside.submit(self.discretisation_errors, free, whole, *modes)
                    ),
                )
            except SlepcUnavailableError as error:
                refuse([Finding(_PART, "solver", solver, f"one that can be started; {error}")], SlepcUnavailableError)
                raise
            except HousingError as error:
                attribute = "count" if below_hz is None else "below_hz"
                finding = Finding(_PART, attribute, None, f"what this model has; {error}")
                refuse([finding], HousingError)
                raise
            damping = modal_damping(modes, whole) if whole.damping.nnz else None
            progress("checking the housing against its geometry, and estimating the error by the mesh")
            begin = time.perf_counter()
            health, masses = self.health(free, whole, modes), effective_mass(whole, self.mesh.points, modes)
            modes = replace(modes, discretisation_errors=estimates[0].result())
        health = health.with_discretisation(modes)
        health.require()
        checked = time.perf_counter() - begin
        warnings = defect_warnings(defects) + discretisation_warnings(
            self.mesh, self.material, modes, mesh_size=self.mesh_size, below_limit=below_hz is not None
        )
        seconds = {"assembly": assembled, **modes.seconds, "checks": checked}
        record = ModeRecord(
            self.mesh,
            modes,
            whole.total_mass,
            seats=tuple(self.seats),
            seat_motions=np.stack([modes.project(port) for port in seat_ports.values()], axis=1)
            if seat_ports
            else np.empty((0, 0, 6)),
            notes={
                "seconds": seconds,
                "checks": {"health": check_document(health), "effective_mass": check_document(masses)},
                "warnings": warnings,
            },
            extras={} if damping is None else {_DAMPING: _damping_array(damping)},
        )
        return HousingModes(self, with_sensors(record, self.sensor_ports().values()), places, seconds)

    def _sound_mesh_defects(self) -> tuple[MeshDefect, ...]:
        """Return the defects of a mesh that can be computed with, and is one body or joined; refuse any other."""
        defects = diagnose(self.mesh, joined=[*joined_nodes(self.fixtures, self.mesh)])
        wrong = [defect for defect in defects if defect.name == "disconnected" or defect.severity == "error"]
        if wrong:
            raise HousingError(
                "expected a sound mesh; " + "; ".join(f"{defect.name}: {defect.message}" for defect in wrong)
            )
        return defects

    def participation(self, whole: Matrices, modes: ModeSet) -> FloatArray:
        """Participation φᵀ M R of modes and residual modes in the motions of the ground, shape (n, 6) [√kg, √kg m].

        R are the rigid motions along and about x, y, z through the origin. The sum is over every degree of freedom:
        what is fixed moves with the ground, and pulls by the consistent mass.
        """
        moved = whole.mass @ rigid_motions(self.mesh.points, np.zeros(3)).reshape(-1, 6)
        return modes.project_all(sparse.csr_array(moved.T))

    def discretisation_errors(
        self, free: Matrices, whole: Matrices, frequencies: FloatArray, shapes: FloatArray
    ) -> FloatArray:
        """Estimate each natural frequency's relative error by the mesh, shape (n_modes,).

        Parameters
        ----------
        free, whole : Matrices
            Results of :meth:`free_matrices` and :meth:`matrices`.
        frequencies, shapes : ndarray, shapes (n_modes,) and (n_modes, n_nodes, 3)
            Modes of ``whole`` [rad/s, 1/√kg].
        """
        return discretisation_errors(
            self.mesh,
            element_constants(self.mesh, self.material, self.materials),
            frequencies,
            shapes,
            loaded=fixture_nodes(free, whole),
        )

    def health(self, free: Matrices, whole: Matrices, modes: ModeSet) -> HealthReport:
        """Check a solved housing from its geometry to its modes.

        Parameters
        ----------
        free, whole : Matrices
            Results of :meth:`free_matrices` and :meth:`matrices`.
        modes : ModeSet
            Modes of ``whole``.
        """
        solid = self.solid()
        mass, center = solid.mass, solid.center
        if not self.materials:
            # With one material the boundary's volume gives the mass, independent of the elements inside.
            volume, center = enclosed_volume(self.mesh)
            mass = self.material.density * volume
        fastened = self.attached_mass
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


@dataclass(frozen=True, eq=False)
class HousingModes:
    """Natural modes of a housing with their proof, and what machine, measurement, sound and pictures take of them.

    Attributes
    ----------
    housing : Housing
    record : ModeRecord
        Modes, mass, damping of the fixtures and checks of the model, as :func:`gearwhine.housing.write_modes` writes
        them.
    bearings : mapping of str to (str, float)
        Places where the machine bears on the housing: for each bearing its seat, and its distance along z from the
        centre of the seat [m]. The residual modes are for these.
    seconds : mapping of str to float
        Time of each step of the solution, or of reading [s].
    source : Path or None
        File that the modes were read from; None where they were solved.
    source_holds : bool
        Whether that file holds these sensors, too.
    file_warnings : sequence of dict
        Warnings about files of modes.

    Raises
    ------
    HousingError
        Where there are more modes than the housing lists damping ratios.
    """

    housing: Housing
    record: ModeRecord
    bearings: Mapping[str, tuple[str, float]]
    seconds: Mapping[str, float] = field(default_factory=dict)
    source: Path | None = None
    source_holds: bool = False
    file_warnings: Sequence[ResultWarning] = ()

    def __repr__(self) -> str:
        """Return the number of modes, their range, and whether they are complete, in a line."""
        hertz = self.frequencies_hz
        span = f", {hertz[0]:.4g} to {hertz[-1]:.4g} Hz" if len(hertz) else ""
        complete = "complete" if self.modes.certificate.complete else "not complete"
        return f"<HousingModes: {len(hertz)} modes{span}, {complete} below {self.trusted_limit_hz:.4g} Hz>"

    def __post_init__(self) -> None:
        """Check the number of damping ratios."""
        _ = self.damping_ratios

    @property
    def mesh(self) -> Mesh:
        """Mesh of the housing."""
        return self.housing.mesh

    @property
    def modes(self) -> ModeSet:
        """Frequencies, shapes, certificate and residual modes."""
        return self.record.modes

    @property
    def frequencies_hz(self) -> FloatArray:
        """Natural frequencies [Hz], shape (n_modes,)."""
        return self.modes.frequencies_hz

    @property
    def trusted_limit_hz(self) -> float:
        """Frequency below which the modes are complete [Hz]."""
        return self.modes.certificate.limit / _TWO_PI

    @property
    def mass(self) -> float:
        """Mass with the attached masses [kg]."""
        return self.record.mass

    @cached_property
    def health(self) -> HealthReport:
        """Checks of the model, from its geometry to its modes."""
        return health_of(self.record.notes["checks"]["health"])

    @cached_property
    def effective_mass(self) -> EffectiveMass:
        """Effective masses of the modes."""
        return effective_mass_of(self.record.notes["checks"]["effective_mass"])

    @cached_property
    def damping_ratios(self) -> FloatArray:
        """Damping ratios that the housing gives its modes, shape (n_modes,); see :attr:`total_damping_ratios`."""
        return self.housing.modal_damping_ratios(self.frequencies_hz)

    @property
    def damping_matrix(self) -> FloatArray | None:
        """Φᵀ C Φ of the fixtures' dashpots by modes and residual modes [1/s], shape (n, n); None without dashpots."""
        return self.record.extras[_DAMPING].values if _DAMPING in self.record.extras else None

    @property
    def total_damping_ratios(self) -> FloatArray:
        """Damping ratio of each mode with the diagonal of the damping matrix; the coupling of modes is left out."""
        return damping_ratios(self.modes.frequencies, self.damping_ratios, self.damping_matrix)

    @cached_property
    def seat_ports(self) -> dict[str, sparse.csr_array]:
        """Motions of the seats from the nodes', shape (6, 3 n_nodes) each."""
        return self.housing.seat_ports()

    @cached_property
    def loaded(self) -> dict[str, sparse.csr_array]:
        """Motions where each bearing is from the nodes', shape (5, 3 n_nodes) each.

        See :func:`gearwhine.housing.model.seats.bearing_port`.
        """
        return {name: bearing_port(self.seat_ports[seat], arm) for name, (seat, arm) in self.bearings.items()}

    @cached_property
    def sensors(self) -> dict[str, SensorPort]:
        """Sensors on the mesh."""
        return self.housing.sensor_ports()

    @cached_property
    def seat_motions(self) -> dict[str, FloatArray]:
        """Motions of modes and residual modes at each seat, shape (n, 6)."""
        return {name: self.modes.project_all(port) for name, port in self.seat_ports.items()}

    @cached_property
    def ring_motions(self) -> dict[str, FloatArray]:
        """Deformation of the bore of each seat with a ring gear by modes and residual modes, (n, 2 + 4 orders)."""
        return {name: self.modes.project_all(port) for name, port in self.housing.ring_ports().items()}

    @cached_property
    def sensor_motions(self) -> dict[str, FloatArray]:
        """Motions of modes and residual modes along each sensor, shape (n,)."""
        return {name: self.modes.project_all(port.matrix)[:, 0] for name, port in self.sensors.items()}

    @cached_property
    def participation(self) -> FloatArray:
        """Participation in the motions of the ground, see :meth:`Housing.participation`; assembles the mass matrix."""
        return self.housing.participation(self.housing.matrices(), self.modes)

    @property
    def up(self) -> tuple[float, float, float]:
        """Unit vector that points upwards in pictures."""
        return self.housing.up

    @property
    def widest_bore(self) -> float | None:
        """Diameter of the housing's widest seat [m]; None where none is known."""
        return self.housing.widest_bore

    @property
    def displacement_field(self) -> HousingField:
        """Its mesh, and the shapes of modes and residual modes on that."""
        return HousingField(self.mesh, self.modes, self.widest_bore)

    @cached_property
    def survey(self) -> Survey:
        """Points of a survey over its outer faces."""
        faces = self.housing.outer_faces
        return survey_grid(self.mesh, None if faces is None else np.array(faces))

    @property
    def survey_shapes(self) -> FloatArray:
        """Mode shapes at the survey points, mass-normalised, shape (n_modes, n_points, 3) [1/√kg]."""
        count = len(self.modes.frequencies)
        return (self.survey.matrix @ self.modes.shapes.reshape(count, -1).T).T.reshape(count, -1, 3)

    @cached_property
    def strengths(self) -> Dominance | None:
        """Dominance of the modes between seats and skin; None without seats."""
        if not self.seat_ports:
            return None
        count = len(self.modes.frequencies)
        radial = np.stack([motion[:count, :2] for motion in self.seat_motions.values()], axis=1)
        return dominance(self.modes.frequencies, radial, self.survey.normal_motion(self.modes.shapes))

    @property
    def missing_compliance(self) -> FloatArray:
        """Part of the static compliance that the modes lack without residual modes, shape (n_loaded, 5).

        Raises
        ------
        ValueError
            Where there are no residual modes.
        """
        if self.modes.residual_modes is None:
            raise ValueError("static compliance of a housing without residual modes")
        missing = self.modes.residual_modes.proof.missing_parts
        return missing[: 5 * len(self.bearings)].reshape(len(self.bearings), -1)

    @cached_property
    def selection(self) -> Selection | None:
        """Modes that carry forces across the shafts from the bearings to the sensors; None where there are not both."""
        ratios = self.total_damping_ratios
        if not self.loaded or not self.sensors or not (ratios > 0.0).all():
            return None
        # Forces across the shafts alone: receptances by moments have another unit, and no common scale with these.
        forces = sparse.csr_array(sparse.vstack([motions[:2] for motions in self.loaded.values()], format="csr"))
        motions = sparse.csr_array(sparse.vstack([sensor.matrix for sensor in self.sensors.values()], format="csr"))
        # From just above rest, where a free housing has no receptance.
        limit = self.modes.certificate.limit
        return select_modes(self.modes, ratios, forces, motions, (0.01 * limit, limit), _SELECTION_TOLERANCE)

    @property
    def refinement(self) -> list[dict[str, Any]]:
        """Meshes that were solved until the modes had the accuracy asked for, the last one this; else empty."""
        return list(self.record.notes.get("refinement", ()))

    @property
    def warnings(self) -> list[str]:
        """Sentences of :attr:`result_warnings`."""
        return [str(entry["message"]) for entry in self.result_warnings]

    @cached_property
    def result_warnings(self) -> list[ResultWarning]:
        """Warnings of its mesh, of errors by the mesh, of missed checks, parts off the surface and unused ratios."""
        return [
            *self.record.notes["warnings"],
            *health_warnings(self.health),
            *surface_point_warnings(self.mesh, self.housing.sensors, self.housing.fixtures),
            *self.file_warnings,
            *self._surplus_damping(),
        ]

    def _surplus_damping(self) -> Iterator[ResultWarning]:
        """Warn of a list of damping ratios that is longer than the modes."""
        given, count = self.housing.damping_ratio, len(self.frequencies_hz)
        if isinstance(given, Sequence) and len(given) > count:
            message = (
                f"damping_ratio lists {len(given)} ratios for {count} modes: the first {count} are taken in order, "
                "the others are not used; the list needs one for each mode from the lowest on, rigid motions included"
            )
            yield warning("damping", message, count=len(given) - count)

    def with_modes(self, modes: ModeSet, damping_matrix: FloatArray | None) -> "HousingModes":
        """Return the housing with other residual modes, and the damping matrix by these coordinates."""
        extras = {name: array for name, array in self.record.extras.items() if name != _DAMPING}
        if damping_matrix is not None:
            extras[_DAMPING] = _damping_array(damping_matrix)
        return replace(self, record=replace(self.record, modes=modes, extras=extras))

    @property
    def responses(self) -> dict[str, FloatArray]:
        """Responses that an extension of the modes has found before, see :class:`ModeSetExtension`."""
        return {
            name.removeprefix(_RESPONSES): array.values
            for name, array in self.record.extras.items()
            if name.startswith(_RESPONSES)
        }

    def with_responses(self, responses: Mapping[str, FloatArray]) -> "HousingModes":
        """Return the housing that keeps responses in place of earlier ones, in its file of modes too."""
        # An empty dimension has another meaning in NetCDF.
        responses = {key: values for key, values in responses.items() if len(values)}
        if responses.keys() == self.responses.keys():
            return self
        extras = {name: array for name, array in self.record.extras.items() if not name.startswith(_RESPONSES)}
        for key, values in responses.items():
            axes, long_name = (f"response_{key}", "node", "component"), "displacements beside the residual modes"
            extras[f"{_RESPONSES}{key}"] = LabelledArray(axes, values, "m", long_name)
        return replace(self, record=replace(self.record, extras=extras), source_holds=False)

    @cached_property
    def with_a_response_less(self) -> "tuple[HousingModes, FloatArray] | None":
        """The housing with a response less of residual modes at each bearing, and its coordinates' transformation.

        The transformation has shape (n, n_fewer). None where there are no residual modes.
        """
        residual = self.modes.residual_modes
        if residual is None or not self.loaded:
            return None
        loaded = [*self.loaded.values(), *self.housing.ring_ports().values()]
        ports = sparse.csr_array(sparse.vstack(loaded, format="csr"))
        fewer, mixture = leading_residual_modes(residual, ports, self.modes.certificate.limit**2, RESPONSE_ORDERS - 1)
        transformation = np.asarray(linalg.block_diag(np.eye(len(self.frequencies_hz)), mixture))
        damping = self.damping_matrix
        damping = None if damping is None else transformation.T @ damping @ transformation
        return self.with_modes(replace(self.modes, residual_modes=fewer), damping), transformation

    def strongest_modes(self, count: int) -> list[int]:
        """Numbers of the strongest modes, from 1; the lowest ones where there are no seats to be driven at."""
        if self.strengths is None:
            return list(range(1, min(count, len(self.modes.frequencies)) + 1))
        return [int(mode) + 1 for mode in self.strengths.strongest(count, (0.0, np.inf))]


def _damping_array(matrix: FloatArray) -> LabelledArray:
    return LabelledArray(_COORDINATES, matrix, "s-1", "damping of what is fastened, by modes and attachments")


def joined_nodes(fixtures: Sequence[Fixture], mesh: Mesh) -> Iterator[npt.NDArray[np.int64]]:
    """Yield the nodes of each joint among fixtures."""
    for joint in fixtures:
        if isinstance(joint, Joint):
            try:
                yield joint.nodes(mesh)
            except (HousingError, GeometryError):
                # What it was to connect is not known; that it has no place is said where fixtures are placed.
                yield np.arange(len(mesh.points))


def _with_bores(mesh: Mesh, seats: Sequence[Seat]) -> Mesh:
    """Return the mesh with a named surface for each seat that is given by a diameter."""
    for seat in seats:
        if seat.diameter is not None:
            mesh = with_bore(mesh, seat.name, seat.center, seat.diameter)
    return mesh
