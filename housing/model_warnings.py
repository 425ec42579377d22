"""Warnings of a housing's model: defects of its mesh, errors by the mesh, missed checks, parts off the surface."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from gearwhine.housing.material import Material
from gearwhine.housing.model.fixtures import Fixture, LumpedMass
from gearwhine.housing.model.seats import Sensor, sensor_port
from gearwhine.housing.modes.health import DISCRETISATION_BOUND, HealthReport
from gearwhine.housing.modes.natural_modes import ModeSet
from gearwhine.meshes import Mesh, MeshDefect, resolution_defects
from gearwhine.meshes.lengths import length_text
from gearwhine.meshes.quality import WaveCarrier, resolving_size, wall_thickness
from gearwhine.numerics.result_warnings import ResultWarning, warning

_TWO_PI = 2.0 * np.pi
_ORDER_AT_INNER_EDGES = 2.0 * 0.545
_BEYOND_ESTIMATE = 0.3  # estimated error from which it is a lower bound: the mode's shape itself is another one
_BESIDE = 0.01  # distance of a point from the surface above which a warning is given, over the housing's diagonal
_ANY_WAVE_HZ = 1e-6  # so low a frequency that no element is too large for its waves


def defect_warnings(defects: Iterable[MeshDefect]) -> list[ResultWarning]:
    """Warn of defects of a mesh."""
    return [
        warning(defect.name, defect.message, count=defect.count, place_m=defect.place.tolist()) for defect in defects
    ]


def wave_carrier(material: Material, limit_hz: float) -> WaveCarrier:
    """Return what carries the bending waves of walls of a material up to a frequency [Hz]."""
    return WaveCarrier(material.youngs_modulus, material.poisson_ratio, material.density, _TWO_PI * limit_hz)


def resolution_warnings(mesh: Mesh, material: Material, limit_hz: float | None) -> list[ResultWarning]:
    """Warn of element sizes for modes up to a frequency; without one, of the kind of element alone."""
    return defect_warnings(resolution_defects(mesh, wave_carrier(material, limit_hz or _ANY_WAVE_HZ)))


def discretisation_warnings(
    mesh: Mesh, material: Material, modes: ModeSet, *, mesh_size: float | None, below_limit: bool
) -> list[ResultWarning]:
    """Warn of modes whose estimated error by the mesh is too large, with the size of elements that suffices.

    The size of elements is judged by the modes themselves here; what their kind does to them is told besides.

    Parameters
    ----------
    mesh : Mesh
    material : Material
    modes : ModeSet
    mesh_size : float or None
        Edge length of the elements, where the housing is meshed by one [m].
    below_limit : bool
        Whether the modes are those below a frequency limit.
    """
    errors = modes.discretisation_errors
    warnings = [entry for entry in resolution_warnings(mesh, material, None) if entry["name"] != "size"]
    if errors is None or not (coarse := errors > DISCRETISATION_BOUND).any():
        return warnings
    worst, count = int(np.argmax(errors)), int(coarse.sum())
    # So coarse a mesh that the mode is another one: how much too high it is no stress field of its own can tell.
    least = "at least " if errors[worst] > _BEYOND_ESTIMATE else ""
    finer = size_for(errors[worst], DISCRETISATION_BOUND)
    advice, figures = f"use elements of at most {finer:.2g} of their size", dict[str, Any]()
    if mesh_size is not None:
        # Elements that are larger than the walls' waves say little of smaller ones.
        wave = wave_carrier(material, float(modes.frequencies_hz[worst])).shortest_wave(wall_thickness(mesh))
        size = min(mesh_size * finer, resolving_size(wave, mesh.order))
        advice, figures = f"use a mesh_size of about {length_text(size)}", {"mesh_size_m": size}
    missing = ", and higher ones that belong below the limit may be missing" if below_limit else ""
    message = (
        f"this mesh makes {count} of {len(errors)} modes more than {100 * DISCRETISATION_BOUND:g} % too high by an "
        f"estimate from their own stresses, mode {worst + 1} at {modes.frequencies_hz[worst]:.4g} Hz by {least}"
        f"{100 * errors[worst]:.2g} %{missing}; {advice}"
    )
    found = warning("discretisation", message, count=count, largest_error=float(errors[worst]), **figures)
    return [found, *warnings]


def size_for(error: float, wanted: float) -> float:
    """Return the size of elements that brings an error down to what is wanted, as a part of their size.

    The error of a smooth mode's frequency falls with h² or h⁴, by elements of order 1 or 2. At a right-angled inner
    edge, as walls have where they meet, stresses grow with r^(0.545 - 1) (Williams 1952), and it falls with h^1.09 in
    the end, whatever the order (Strang and Fix 1973, chapter 8); that is taken.
    """
    return float((wanted / error) ** (1.0 / _ORDER_AT_INNER_EDGES))


def health_warnings(report: HealthReport) -> list[ResultWarning]:
    """Warn of every check of the housing's model that misses its bound, but the one that has a warning of its own."""
    return [
        warning(
            "health",
            f"{line.name} is {line.value:.3g}, beyond its bound of {line.bound:.3g}: {line.why}",
            check=line.name,
            value=line.value,
            bound=line.bound,
        )
        for line in report.lines
        # Of the error by the mesh ``discretisation_warnings`` tells more, unless an accuracy is asked for.
        if not line.ok and line.bound is not None and line.name != "discretisation"
    ]


def surface_point_warnings(
    mesh: Mesh, sensors: Sequence[Sensor], fixtures: Sequence[Fixture]
) -> Iterator[ResultWarning]:
    """Warn of sensors and lumped masses that are given beside the housing's surface, with the point where they sit."""
    far = _BESIDE * float(np.linalg.norm(mesh.bounds[1] - mesh.bounds[0]))
    placed = [
        *(("sensor", one.name, one.position, sensor_port(mesh, one).position) for one in sensors),
        *(
            ("mass", one.name, one.position, one.place(mesh).position)
            for one in fixtures
            if isinstance(one, LumpedMass) and one.position is not None
        ),
    ]
    for kind, name, position, place in placed:
        off = float(np.linalg.norm(place - np.array(position)))
        if off > far:
            at = ", ".join(f"{round(1e3 * float(value), 3) + 0.0:.6g}" for value in place)
            yield warning(
                f"{kind} place",
                f'{kind} "{name}": its position is {1e3 * off:.3g} mm from the surface; it sits at ({at}) mm',
                **{kind: name, "beside_m": off},
            )
