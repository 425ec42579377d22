"""Housing of another program's matrices for an imported gear unit: seats under its bearings, and sensors at these."""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from gearwhine.case import CaseError, Problem, parse_case
from gearwhine.exchange.rexs.importing import ImportedCase
from gearwhine.exchange.rexs.notes import Note
from gearwhine.exchange.rexs.quantities import mm, of
from gearwhine.housing import HousingError
from gearwhine.housing.reduced import LabelledMatrix, read_matrix, read_row_labels, reduced_matrices
from gearwhine.housing.reduced.assignment import Assignment, Point, assign_nodes
from gearwhine.housing.reduced.certificate import rigid_motions
from gearwhine.housing.reduced.row_labels import row_labels_beside

LIMIT_HZ = 3000.0
"""Frequency limit of a reduction that states none [Hz]."""
MOST_SENSORS = 12
"""Nodes beside the seats that get a sensor, at most."""
SUPPORT_HZ = 50.0
"""Frequency at which a housing that nothing holds moves as a whole on the springs that it is given [Hz]."""
REVOLUTIONS, DISCARDED = 40.0, 20.0
"""Revolutions of the input over which the motion is integrated, and those left out as its beginning."""


def with_reduced_housing(
    imported: ImportedCase, stiffness: Path, mass: Path | None, folder: Path, mapping: Path | None = None
) -> ImportedCase:
    """Return an imported gear unit whose bearings on the ground stand in a housing of reduced matrices.

    Each of these bearings gets a seat at a node, and a sensor there along y; so do other nodes of a free housing. The
    nodes and the units of the matrices are those by which the rigid motions of the housing are free; where nothing
    proves them, they are noted as assumed. A free housing is held by soft springs at its seats.

    Parameters
    ----------
    imported : ImportedCase
    stiffness : path
        File of the stiffness, and of the mass where it has both.
    mass : path or None
        File of the mass, where it is another one.
    folder : path
        Folder of the case, from which it names the files.
    mapping : path or None
        File of the nodes and components of the rows; by default one of the name of ``stiffness`` beside it.

    Raises
    ------
    CaseError
        Where a file cannot be read, no bearing stands on the ground, or the matrices have too few nodes for them.
    """
    document: dict[str, Any] = json.loads(json.dumps(imported.document))
    # These matrices take the place of a static stiffness that the file of the unit has.
    of_file = {seat["name"] for seat in document.pop("housing", {}).get("seat", [])}
    for bearing in document.get("bearing", []):
        if bearing["seat"] in of_file:
            bearing["seat"] = "ground"
    kept = tuple(note for note in imported.notes if note.at[:1] != ("housing",))
    case = parse_case(document)
    rotors = {rotor.name: rotor for rotor in case.rotor}
    standing = [place for place, bearing in enumerate(case.bearing) if bearing.seat == "ground"]
    if not standing:
        raise CaseError([Problem("--housing", stiffness.name, "a gear unit with bearings in its casing")])
    places = []
    for place in standing:
        bearing = case.bearing[place]
        rotor = rotors[bearing.rotor]
        places.append((*rotor.axis, rotor.start + bearing.at))
    try:
        read = _read(stiffness, mass)
        if read["stiffness"].coordinates is None:
            mapping = mapping or row_labels_beside(stiffness)
        if mapping is not None:
            labels = read_row_labels(mapping)
            read = {kind: matrix.with_rows(labels, stiffness.name) for kind, matrix in read.items()}
        found = assign_nodes(read, places)
    except HousingError as error:
        raise CaseError([Problem("--housing", stiffness.name, f"matrices of a housing; {error}")]) from error

    def way(path: Path) -> str:
        return Path(os.path.relpath(path, folder)).as_posix()

    reduced: dict[str, Any] = {"stiffness": way(stiffness)}
    if "mass" in read:
        reduced["mass"] = way(mass or stiffness)
    if mapping is not None:
        reduced["mapping"] = way(mapping)
    elif found.by_order:
        reduced["nodes"] = sorted(found.nodes)
    reduced["units"] = found.units
    seats, sensors, shown = [], [], []
    for place, node, center in zip(standing, found.nodes, places, strict=True):
        bearing = document["bearing"][place]
        bearing["seat"] = name = f"{bearing['name']} seat"
        at = [mm(float(value)) for value in center]
        seats.append({"name": name, "node": node, "center": at})
        sensors.append({"name": f"at {bearing['name']}", "node": node, "position": at, "direction": "y"})
        shown.append(f"{node} at {bearing['name']}")
    for node, point in [*found.others.items()][:MOST_SENSORS]:
        position = [mm(round(value, 7)) for value in point]
        sensors.append({"name": f"at node {node}", "node": node, "position": position, "direction": "y"})
    tables = {"frequency_limit": of(LIMIT_HZ, "Hz"), "damping_ratio": 0.01, "reduced": reduced}
    supports = _soft_supports(read, found, places, seats) if found.is_proved else []
    housing = {**tables, "seat": seats, **({"support": supports} if supports else {}), "sensor": sensors}
    proof = "its rigid motions are free by them" if found.is_proved else "in their order, which nothing proves"
    about = f"housing {stiffness.name}"
    rows = "" if mapping is None else f"rows by {mapping.name}; "
    count = len(sensors) - len(seats)
    elsewhere = f", and at {count} other node{'s' * (count > 1)}" if count else ""
    notes = [
        Note("assumed", about, f"{rows}nodes {', '.join(shown)}, in {found.units}: {proof}", ("housing", "reduced")),
        Note("assumed", about, "a band, which the files of a reduction do not state", ("housing", "frequency_limit")),
        Note("assumed", about, "1 % of critical damping", ("housing", "damping_ratio")),
        Note("assumed", about, f"a sensor along y at each seat{elsewhere}", ("housing", "sensor", 0)),
    ]
    if supports:
        text = f"springs at its seats hold it, on which it moves as a whole at about {SUPPORT_HZ:g} Hz"
        notes.append(Note("assumed", about, f"nothing holds it: {text}", ("housing", "support", 0)))
    if "operation" in document and "transient" not in document:
        document["transient"] = {"revolutions": REVOLUTIONS, "discard": DISCARDED}
        text = f"{REVOLUTIONS:g} revolutions of the input, {DISCARDED:g} of them to settle"
        notes.append(Note("assumed", "motion", text, ("transient",)))
    before = ("title", "notes", "unusual", "material")
    first = {key: document[key] for key in before if key in document}
    gone = tuple(note.text for note in imported.notes if note not in kept)
    told = [line for line in first["notes"].splitlines() if not (gone and line.endswith(gone))]
    first["notes"] = "".join(f"{line}\n" for line in (*told, *notes))
    rest = {key: value for key, value in document.items() if key not in first}
    return replace(imported, document={**first, "housing": housing, **rest}, notes=(*kept, *notes))


def _soft_supports(
    read: Mapping[str, LabelledMatrix],
    found: Assignment,
    places: Sequence[Point],
    seats: Sequence[Mapping[str, Any]],
) -> list[dict[str, Any]]:
    """Return springs at each seat that hold a free housing; none of one without a mass.

    Along each axis they have m ω² together, m the mass and ω the frequency of the motion as a whole; about it that at
    the arm of the places' extent, so that they hold a housing whose seats are on one line, too.
    """
    if "mass" not in read:
        return []
    nodes = sorted(found.nodes) if found.by_order else ()
    matrices = reduced_matrices(read, nodes, found.units)
    shift = rigid_motions(matrices, dict(zip(found.nodes, places, strict=True)))[:, :3]
    mass = float(np.diag(shift.T @ matrices.mass @ shift).mean())
    spring = mass * (2.0 * np.pi * SUPPORT_HZ) ** 2 / len(seats)
    arm = float(np.ptp(places, axis=0).max())
    along, about = (float(f"{value:.2g}") for value in (spring, spring * arm**2))
    stiffness = dict.fromkeys("xyz", of(along, "N/m")) | dict.fromkeys(("rx", "ry", "rz"), of(about, "N m/rad"))
    return [
        {"name": f"under {seat['name']}", "node": seat["node"], "position": seat["center"], "stiffness": stiffness}
        for seat in seats
    ]


def _read(stiffness: Path, mass: Path | None) -> Mapping[str, LabelledMatrix]:
    """Read stiffness and mass; a file of one matrix alone has no mass."""
    read = {"stiffness": read_matrix(stiffness, kind="stiffness")}
    of_mass = read_matrix(stiffness if mass is None else mass, kind="mass")
    if mass is not None or not np.array_equal(of_mass.values, read["stiffness"].values):
        read["mass"] = of_mass
    return read
