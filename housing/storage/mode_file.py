"""Mode file: a solved housing as labelled NetCDF4, written whole and read back with its proof.

The file opens in xarray, ncdump and every other reader of NetCDF4 or HDF5. It holds one :class:`ModeRecord`: the mesh,
the modes with their certificate, the residual modes, the motions of bearing seats and sensors, the inputs of the
solution, and a digest. Each part is converted to labelled arrays and back.

The certificate was made with the stiffness and mass matrices at hand. The digest (SHA-256 over every array, label and
attribute) proves on reading that the content is, bit for bit, that of the certified set. It detects damage; it is no
signature against forgery.
"""

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from gearwhine.housing.errors import HousingError, ModeFileError
from gearwhine.housing.model.seats import Seat, Sensor, SensorPort
from gearwhine.housing.modes.certificate import Certificate
from gearwhine.housing.modes.natural_modes import ModeSet
from gearwhine.housing.modes.residual_modes import ResidualModes, StaticProof
from gearwhine.housing.storage.atomic_file import atomic_file, checksum_holds, write_checksum
from gearwhine.housing.storage.mesh_arrays import mesh_arrays, mesh_from_arrays
from gearwhine.housing.storage.netcdf import (
    LabelledArray,
    canonical_json,
    content_key,
    digest,
    read_netcdf,
    write_netcdf,
)
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray

_ONE = ("attachment",)
_PORTS = ("loaded_motion", "moved_motion")


def residual_mode_arrays(residual_modes: ResidualModes | None) -> dict[str, LabelledArray]:
    """Convert residual modes and their proof to labelled arrays; empty where there are none.

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
    """Convert the arrays of :func:`residual_mode_arrays` back to residual modes, equal bit for bit.

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


_MODE = ("mode",)
_EXTRA = "extra_"
_CERTIFIED = {
    "limit": ("rad s-1", "circular frequency up to which the set is complete"),
    "expected": ("1", "modes below the limit by the inertia of the shifted stiffness"),
    "found": ("1", "modes in the set"),
    "max_residual": ("1", "largest relative residual of a mode"),
    "max_overlap": ("1", "largest mass-weighted overlap of two modes"),
}


@dataclass(frozen=True)
class ModeRecord:
    """A solved housing, as a mode-set file holds it.

    Attributes
    ----------
    mesh : Mesh
    modes : ModeSet
    mass : float
        Mass of the housing [kg].
    seats : tuple of Seat
    seat_motions : ndarray, shape (n_modes, n_seats, 6)
        Modes' translations [1/√kg] and rotations [1/(m √kg)] at the seats.
    sensors : tuple of Sensor
        Position on the surface [m] and unit direction.
    sensor_motions : ndarray, shape (n_modes, n_sensors)
        Modes' motions along the sensors [1/√kg].
    inputs : mapping
        Inputs of the solution as JSON values: shape, material, supports, versions.
    notes : mapping
        Further findings as JSON values, such as the time of each step.
    extras : mapping of str to LabelledArray
        Further arrays that need the matrices to be made.

    Raises
    ------
    HousingError
        Where an array does not fit the others, or a sensor has no direction.
    """

    mesh: Mesh
    modes: ModeSet
    mass: float
    seats: tuple[Seat, ...] = ()
    seat_motions: FloatArray = field(default_factory=lambda: np.empty((0, 0, 6)))
    sensors: tuple[Sensor, ...] = ()
    sensor_motions: FloatArray = field(default_factory=lambda: np.empty((0, 0)))
    inputs: Mapping[str, Any] = field(default_factory=dict)
    notes: Mapping[str, Any] = field(default_factory=dict)
    extras: Mapping[str, LabelledArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check the shapes of the arrays, and that every sensor has a direction."""
        count = len(self.modes.frequencies)
        wanted = {
            "modes.shapes": (self.modes.shapes, (count, len(self.mesh.points), 3)),
            "seat_motions": (self.seat_motions, (count, len(self.seats), 6)),
            "sensor_motions": (self.sensor_motions, (count, len(self.sensors))),
        }
        for name, (values, shape) in wanted.items():
            if values.shape != shape and not (values.size == 0 and 0 in shape):
                raise HousingError(f"{name} have shape {values.shape}; expected {shape}")
        aimless = [sensor.name for sensor in self.sensors if sensor.direction is None]
        if aimless:
            raise HousingError(f"sensors {', '.join(aimless)} have no direction; give the one found on the surface")

    @property
    def key(self) -> str:
        """SHA-256 of the inputs: records of the same key hold the same modes."""
        return content_key(self.inputs)


def with_sensors(record: ModeRecord, ports: Iterable[SensorPort]) -> ModeRecord:
    """Return the record with other sensors, and the modes' motions along them."""
    placed = list(ports)
    motions = [record.modes.project(port.matrix)[:, 0] for port in placed]
    sensors = []
    for port in placed:
        (x, y, z), (a, b, c) = port.position.tolist(), port.direction.tolist()
        sensors.append(Sensor(port.name, (x, y, z), (a, b, c)))
    nothing = np.empty((len(record.modes.frequencies), 0))
    return replace(record, sensors=tuple(sensors), sensor_motions=np.stack(motions, axis=1) if motions else nothing)


def record_arrays(record: ModeRecord) -> dict[str, LabelledArray]:
    """Every array of a record; the rest of it is :func:`record_attributes`."""
    arrays = mesh_arrays(record.mesh) | _mode_arrays(record.modes) | _port_arrays(record)
    arrays["mass"] = LabelledArray((), np.array(record.mass), "kg", "mass of the housing")
    return arrays | {f"{_EXTRA}{name}": array for name, array in record.extras.items()}


def record_attributes(record: ModeRecord) -> dict[str, str]:
    """Content of a record beside its arrays, as text."""
    return {
        "inputs": canonical_json(record.inputs),
        "key": record.key,
        "notes": canonical_json(record.notes),
        "solver_backend": record.modes.backend,
        "normalisation": "each shape has unit modal mass",
        "complete": "yes" if record.modes.certificate.complete else "no",
    }


def record_of(arrays: Mapping[str, LabelledArray], attributes: Mapping[str, str]) -> ModeRecord:
    """Convert arrays and attributes back to the mode record, equal bit for bit.

    Raises
    ------
    KeyError, ValueError, TypeError, IndexError
        Where a part is missing or does not fit the others.
    """
    seats, seat_motions = _seats(arrays)
    sensors, sensor_motions = _sensors(arrays)
    return ModeRecord(
        mesh=mesh_from_arrays(arrays),
        modes=_modes(arrays, attributes),
        mass=float(arrays["mass"].values),
        seats=seats,
        seat_motions=seat_motions,
        sensors=sensors,
        sensor_motions=sensor_motions,
        inputs=json.loads(attributes["inputs"]),
        notes=json.loads(attributes["notes"]),
        extras={name.removeprefix(_EXTRA): array for name, array in arrays.items() if name.startswith(_EXTRA)},
    )


def _mode_arrays(modes: ModeSet) -> dict[str, LabelledArray]:
    """Every field of a mode set but ``backend``, which is an attribute of the file; frequencies in hertz beside."""
    numbers = np.arange(1, len(modes.frequencies) + 1)
    shape = ("mode", "node", "component")
    arrays = {
        "mode": LabelledArray(_MODE, numbers, "1", "number of the mode"),
        "component": LabelledArray(("component",), np.array(["x", "y", "z"]), "1", "axis of the housing's frame"),
        "frequency": LabelledArray(_MODE, modes.frequencies_hz, "Hz", "natural frequency"),
        "circular_frequency": LabelledArray(_MODE, modes.frequencies, "rad s-1", "natural circular frequency"),
        "shape": LabelledArray(shape, modes.shapes, "kg-0.5", "displacement at the nodes, of unit modal mass"),
        "solver_shift": LabelledArray((), np.array(modes.shift), "rad2 s-2", "shift of the search for modes"),
        "solver_threads": LabelledArray((), np.array(modes.threads), "1", "workers of the factorisation"),
        "solver_step": LabelledArray(("solver_step",), np.array(list(modes.seconds)), "1", "step of the solution"),
        "solver_time": LabelledArray(
            ("solver_step",), np.array(list(modes.seconds.values())), "s", "time that each step took"
        ),
    }
    if modes.discretisation_errors is not None:
        arrays["discretisation_error"] = LabelledArray(
            _MODE, modes.discretisation_errors, "1", "estimate of the frequency's relative error by the mesh"
        )
    for name, value in asdict(modes.certificate).items():
        units, long_name = _CERTIFIED[name]
        arrays[f"certificate_{name}"] = LabelledArray((), np.array(value), units, long_name)
    return arrays | residual_mode_arrays(modes.residual_modes)


def _modes(arrays: Mapping[str, LabelledArray], attributes: Mapping[str, str]) -> ModeSet:
    steps, times = (arrays[name].values.tolist() for name in ("solver_step", "solver_time"))
    proved = {field.name: arrays[f"certificate_{field.name}"].values.item() for field in fields(Certificate)}
    return ModeSet(
        frequencies=arrays["circular_frequency"].values,
        shapes=arrays["shape"].values,
        certificate=Certificate(**proved),
        seconds=dict(zip(steps, times, strict=True)),
        backend=attributes["solver_backend"],
        shift=arrays["solver_shift"].values.item(),
        threads=arrays["solver_threads"].values.item(),
        residual_modes=residual_modes_of(arrays, arrays["shape"].values.shape[1]),
        discretisation_errors=arrays["discretisation_error"].values if "discretisation_error" in arrays else None,
    )


def _port_arrays(record: ModeRecord) -> dict[str, LabelledArray]:
    arrays: dict[str, LabelledArray] = {}
    if record.seats:
        names, centers = [seat.name for seat in record.seats], [seat.center for seat in record.seats]
        directions = np.array(["x", "y", "z", "about x", "about y", "about z"])
        arrays |= {
            "seat": LabelledArray(("seat",), np.array(names), "1", "bearing seat"),
            "seat_center": LabelledArray(("seat", "component"), np.array(centers), "m", "centre of the seat"),
            "motion": LabelledArray(("motion",), directions, "1", "rigid motion of a seat"),
            "seat_motion": LabelledArray(
                ("mode", "seat", "motion"),
                record.seat_motions,
                "kg-0.5",
                "motions of the modes at the seats; rotations per metre",
            ),
        }
    if record.sensors:
        places = np.array([sensor.position for sensor in record.sensors])
        directions = np.array([sensor.direction for sensor in record.sensors])
        names = [sensor.name for sensor in record.sensors]
        arrays |= {
            "sensor": LabelledArray(("sensor",), np.array(names), "1", "accelerometer"),
            "sensor_position": LabelledArray(("sensor", "component"), places, "m", "place on the surface"),
            "sensor_direction": LabelledArray(("sensor", "component"), directions, "1", "unit vector of the sensor"),
            "sensor_motion": LabelledArray(
                ("mode", "sensor"), record.sensor_motions, "kg-0.5", "motion of the modes along the sensors"
            ),
        }
    return arrays


def _seats(arrays: Mapping[str, LabelledArray]) -> tuple[tuple[Seat, ...], FloatArray]:
    if "seat" not in arrays:
        return (), np.empty((len(arrays["mode"].values), 0, 6))
    names, centers = arrays["seat"].values.tolist(), arrays["seat_center"].values.tolist()
    seats = tuple(Seat(name, (x, y, z)) for name, (x, y, z) in zip(names, centers, strict=True))
    return seats, arrays["seat_motion"].values


def _sensors(arrays: Mapping[str, LabelledArray]) -> tuple[tuple[Sensor, ...], FloatArray]:
    if "sensor" not in arrays:
        return (), np.empty((len(arrays["mode"].values), 0))
    names, places, directions = (arrays[f"sensor{part}"].values.tolist() for part in ("", "_position", "_direction"))
    sensors = tuple(
        Sensor(name, (x, y, z), (a, b, c)) for name, (x, y, z), (a, b, c) in zip(names, places, directions, strict=True)
    )
    return sensors, arrays["sensor_motion"].values


FORMAT = "gearwhine mode set"
SCHEMA = "1"


def write_modes(path: str | Path, record: ModeRecord) -> None:
    """Write a mode set; the file appears whole or not at all.

    Raises
    ------
    HousingError
        Where an array of the record does not fit its labels.
    OSError
        Where the file cannot be written.
    """
    path = Path(path)
    arrays = record_arrays(record)
    attributes = {
        "title": "Natural modes of a gearbox housing",
        "format": FORMAT,
        "schema": SCHEMA,
        **record_attributes(record),
    }
    attributes["digest"] = digest(arrays, attributes)
    variables = {
        name: (array.dimensions, array.values, {"units": array.units, "long_name": array.long_name, **array.attributes})
        for name, array in arrays.items()
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_file(path) as staged:
        try:
            # Without a fill value no number is taken for a missing one.
            write_netcdf(staged, variables, attributes, fill=False)
            write_checksum(staged)
        except ValueError as error:
            raise HousingError(f"the arrays of a mode set do not fit each other: {error}") from error


def read_modes(path: str | Path) -> ModeRecord:
    """Read a mode set, and check it against its digest.

    Raises
    ------
    ModeFileError
        Where the file is missing, damaged, of another kind or schema, or its certificate is not complete.
    """
    path = Path(path)
    arrays, attributes = _open(path)
    try:
        record = record_of(arrays, attributes)
    except (KeyError, ValueError, TypeError, IndexError) as error:
        raise ModeFileError(f"mode file {path} lacks a part or holds a wrong one: {error}") from error
    if not record.modes.certificate.complete:
        raise ModeFileError(f"mode file {path} holds modes whose certificate is not complete; solve them again")
    return record


def _open(path: Path) -> tuple[dict[str, LabelledArray], dict[str, Any]]:
    """Return the arrays and attributes of a file after a check of its kind, schema and digest."""
    import h5py

    if not path.is_file():
        raise ModeFileError(f"mode file {path}: no such file")
    try:
        # Copies by other programs have no seal; the digest is theirs too.
        if checksum_holds(path) is False:
            raise ModeFileError(f"mode file {path} is damaged: its bytes do not have the digest at its end")
        # Opened by HDF5 alone first: on a truncated file it fails silently, and the layers above it print errors.
        with h5py.File(path, "r") as file:
            kind, schema = file.attrs.get("format"), file.attrs.get("schema")
        if kind != FORMAT:
            raise ModeFileError(f"{path} holds something else than a mode set of gearwhine")
        if schema != SCHEMA:
            raise ModeFileError(f"mode file {path} has schema {schema}; this version reads schema {SCHEMA}")
        # Undecoded: bytes as they stand, no unit of time turned into dates.
        arrays, attributes = read_netcdf(path)
        claimed = attributes.pop("digest", None)
        whole = digest(arrays, attributes) == claimed
    except ModeFileError:
        raise
    except Exception as error:  # readers raise exceptions of many kinds on a damaged file
        raise ModeFileError(f"mode file {path} is no NetCDF4 file, or a damaged one: {error}") from error
    if not whole:
        raise ModeFileError(f"mode file {path} is damaged or was changed: its content does not have its digest")
    return arrays, attributes
