"""Solids of a CAD file in gmsh's OpenCASCADE kernel: read, sewn from surfaces where needed, made conforming.

The unit of length is stated by the file or given by the user, and checked against the part's size.
"""

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.lengths import LARGEST, SMALLEST, UNITS, length_text, plausible

_PREFIXES = {"$": 1.0, "MILLI": 1e-3, "CENTI": 1e-2, "DECI": 0.1, "MICRO": 1e-6, "KILO": 1e3, "NANO": 1e-9}
_CONVERTED = {"INCH": 0.0254, "INCHES": 0.0254, "IN": 0.0254, "FOOT": 0.3048, "FEET": 0.3048, "FT": 0.3048}
_CONVERTED |= {"MILLIMETRE": 1e-3, "MILLIMETER": 1e-3, "MM": 1e-3, "METRE": 1.0, "METER": 1.0, "M": 1.0}
# The unit flags of IGES 5.3, section 2.2.4.3.14; flag 3 gives a name instead.
_IGES_FLAGS = {1: 0.0254, 2: 1e-3, 4: 0.3048, 5: 1609.344, 6: 1.0, 7: 1e3, 8: 2.54e-5, 9: 1e-6, 10: 1e-2, 11: 2.54e-8}


@dataclass(frozen=True)
class ChosenUnit:
    """The unit in which a file's numbers are read [m], and a remark on the choice for the user."""

    length: float
    remarks: tuple[str, ...] = ()


def stated_unit(path: Path, kind: str) -> float | None:
    """Read the unit of length that a STEP or IGES file states [m]; None where it states none, or several."""
    if kind == "brep":
        return None
    text = path.read_text(encoding="latin-1")
    return _step_unit(text) if kind == "step" else _iges_unit(text)


def _step_unit(text: str) -> float | None:
    """Read the unit of length of a STEP file's geometry [m]; None unless there is exactly one.

    An inch is defined by way of a millimetre, so that converted units, where there are any, decide.
    """
    plain: set[float] = set()
    converted: set[float] = set()
    for match in re.finditer(r"LENGTH_UNIT\s*\(\s*\)", text):
        entity = text[text.rfind(";", 0, match.start()) + 1 : text.find(";", match.end())]
        by_name = re.search(r"CONVERSION_BASED_UNIT\s*\(\s*'([^']*)'", entity)
        by_prefix = re.search(r"SI_UNIT\s*\(\s*(\$|\.\w+\.)\s*,\s*\.METRE\.", entity)
        if by_name is not None:
            converted.add(_CONVERTED.get(by_name[1].strip().upper(), 0.0))
        elif by_prefix is not None:
            plain.add(_PREFIXES.get(by_prefix[1].strip("."), 0.0))
    units = converted or plain
    (unit,) = units if len(units) == 1 else (0.0,)
    return unit or None


def _iges_unit(text: str) -> float | None:
    """Read the unit of an IGES file: parameter 14 of its global section, a flag."""
    section = "".join(line[:72] for line in text.splitlines() if line[72:73] == "G")
    fields: list[str] = []
    place, delimiter = 0, ","
    while place < len(section) and len(fields) < 14:
        string = re.match(r"\s*(\d+)H", section[place:])
        if string is not None:  # a string is preceded by its length
            begin = place + string.end()
            end = begin + int(string[1])
            fields.append(section[begin:end])
            place = section.find(delimiter, end) + 1 or len(section)
            if len(fields) == 1 and fields[0]:
                delimiter = fields[0]
                place = end + 1
        else:
            end = section.find(delimiter, place)
            end = len(section) if end < 0 else end
            fields.append(section[place:end].strip())
            place = end + 1
    flag = fields[13] if len(fields) == 14 else ""
    return _IGES_FLAGS.get(int(flag)) if flag.isdecimal() else None


def choose_unit(extent: float, stated: float | None, given: float | None) -> ChosenUnit:
    """Decide in which unit a file's numbers are read.

    Parameters
    ----------
    extent : float
        The longest side of the part in the file's own numbers.
    stated : float or None
        The unit that the file states [m].
    given : float or None
        The unit that the user names [m].

    Raises
    ------
    GeometryError
        Where neither unit gives a plausible size of a housing; the message asks for the unit that would.

    Notes
    -----
    The file's own unit takes precedence over the user's, unless it makes the part too small or too large and the
    user's unit makes its size plausible: a kernel that works in metres writes files that state millimetres.
    """
    unit = stated if stated is not None else (given if given is not None else UNITS["mm"])
    differs = stated is not None and given is not None and abs(given / stated - 1.0) > 1e-9
    if plausible(extent * unit):
        if differs:
            assert given is not None
            remark = f"the file states {_named(unit)} and is read so, against the unit given, {_named(given)}"
            return ChosenUnit(unit, (remark,))
        return ChosenUnit(unit)
    if differs and given is not None and plausible(extent * given):
        remark = (
            f"the file states {_named(unit)}, in which the part would be {length_text(extent * unit)} long; "
            f"it is read in {_named(given)}, the unit given"
        )
        return ChosenUnit(given, (remark,))
    fitting = [name for name, length in UNITS.items() if plausible(extent * length)]
    whose = "" if stated is None else f", in the {_named(stated)} that the file states"
    question = f"; is the unit {_named(UNITS[fitting[0]])}? (unit = {fitting[0]!r})" if fitting else ""
    raise GeometryError(
        f"the part is {length_text(extent * unit)} long{whose}{question}; "
        f"housings from {length_text(SMALLEST)} to {length_text(LARGEST)} are meshed"
    )


def _named(unit: float) -> str:
    names = {1.0: "metres", 1e-3: "millimetres", 1e-2: "centimetres", 0.0254: "inches", 0.3048: "feet"}
    return names.get(unit, f"units of {unit:g} m")


_SEWING = 1e-5  # gaps between surfaces up to this part of the part's diagonal are closed
_LARGEST_SHARED_VOLUME = 1e-6  # solids may share this part of the smaller one's volume, by rounding
_UNNAMED = re.compile(r"Open CASCADE .* translator.*|SOLID|COMPOUND|=>.*|\s*")


@dataclass(frozen=True)
class Shape:
    """Solids of a gmsh model.

    Attributes
    ----------
    solids : dict of str to list of int
        The model's solids that make up each part, under the part's own name.
    faces : dict of str to list of int
        Faces that carry a name in the file.
    """

    solids: dict[str, list[int]]
    faces: dict[str, list[int]]


def read_solids(gmsh: Any, path: str, kind: str) -> list[int]:
    """Read a file into the current model and return its solids, sewn from surfaces where there are none.

    Raises
    ------
    GeometryError
        Where the file holds nothing, or surfaces that do not close.
    """
    try:
        entities = gmsh.model.occ.importShapes(path, highestDimOnly=True, format=kind)
    except Exception as error:  # gmsh raises bare Exception for every failure of its kernel
        if type(error) is not Exception:
            raise
        raise GeometryError(f"it is empty or broken, or no {kind.upper()} file; export it anew") from error
    gmsh.model.occ.synchronize()
    if not entities:
        raise GeometryError("it holds no shape, or is broken")
    solids = [tag for dimension, tag in entities if dimension == 3]
    if solids:
        _drop_all_but(gmsh, solids)
        return solids
    n_faces = sum(dimension == 2 for dimension, _ in entities)
    if n_faces == 0:
        raise GeometryError("it holds curves or points only, and no solid")
    return _sewn(gmsh, path, kind, n_faces)


def extent(gmsh: Any) -> float:
    """Return the longest side of the model, in its own unit."""
    bounds = np.array(gmsh.model.getBoundingBox(-1, -1)).reshape(2, 3)
    return float(np.ptp(bounds, axis=0).max())


def _drop_all_but(gmsh: Any, solids: list[int]) -> None:
    """Remove loose faces and wires that a file carries beside its solids."""
    needed = {(3, tag) for tag in solids}
    for dimension in (2, 1, 0):
        below = gmsh.model.getBoundary(sorted(needed), combined=False, oriented=False) if needed else []
        needed = set(below)
        loose = [entity for entity in gmsh.model.getEntities(dimension) if entity not in needed]
        if loose:
            gmsh.model.occ.remove(loose)
    gmsh.model.occ.synchronize()


def _sewn(gmsh: Any, path: str, kind: str, n_faces: int) -> list[int]:
    """Solids from surfaces, as IGES has them: sewn together, each closed set of faces a shell, shells inside as voids.

    The surfaces are read again, because the kernel sews while it reads.
    """
    tolerance = _SEWING * extent(gmsh)
    gmsh.model.occ.remove(gmsh.model.occ.getEntities(2), recursive=True)
    gmsh.model.occ.synchronize()
    default_tolerance = gmsh.option.getNumber("Geometry.Tolerance")
    gmsh.option.setNumber("Geometry.OCCSewFaces", 1)
    gmsh.option.setNumber("Geometry.Tolerance", tolerance)
    try:
        gmsh.model.occ.importShapes(path, highestDimOnly=False, format=kind)
    finally:
        gmsh.option.setNumber("Geometry.OCCSewFaces", 0)
        gmsh.option.setNumber("Geometry.Tolerance", default_tolerance)
    gmsh.model.occ.synchronize()
    shells = _shells(gmsh, n_faces)
    outer = sorted(shells, key=lambda shell: -_diagonal(gmsh, shell))
    voids: dict[int, list[list[int]]] = {}
    for place, around in enumerate(_shells_around(gmsh, outer)):
        # A void is in the material of one shell more than of voids; a shell within a void is a solid of its own.
        if len(around) % 2:
            voids[around[-1]].append(outer[place])
        else:
            voids[place] = []
    solids = []
    for place, inside in voids.items():
        loops = [gmsh.model.occ.addSurfaceLoop(shell, sewing=False) for shell in (outer[place], *inside)]
        solids.append(gmsh.model.occ.addVolume(loops))
    gmsh.model.occ.synchronize()
    return solids


def _shells(gmsh: Any, n_faces: int) -> list[list[int]]:
    """Group the faces of the model in shells, connected by their edges."""
    edges = {
        face: [edge for _, edge in gmsh.model.getBoundary([(2, face)], oriented=False)]
        for _, face in gmsh.model.getEntities(2)
    }
    uses = Counter(edge for around in edges.values() for edge in around)
    open_edges = sorted(edge for edge, count in uses.items() if count == 1)
    if open_edges:
        x, y, z = np.array(gmsh.model.getBoundingBox(1, open_edges[0])).reshape(2, 3).mean(axis=0)
        raise GeometryError(
            f"it holds {n_faces} surfaces and no solid, and they do not close: {len(open_edges)} edges are open, "
            f"the first near ({x:.5g}, {y:.5g}, {z:.5g}); export a closed solid (in STEP rather than IGES)"
        )
    by_edge: dict[int, list[int]] = {}
    for face, around in edges.items():
        for edge in around:
            by_edge.setdefault(edge, []).append(face)
    shells, left = [], set(edges)
    while left:
        shell, waiting = [], [min(left)]
        left.discard(waiting[0])
        while waiting:
            face = waiting.pop()
            shell.append(face)
            for neighbor in {other for edge in edges[face] for other in by_edge[edge]} & left:
                left.discard(neighbor)
                waiting.append(neighbor)
        shells.append(sorted(shell))
    return shells


def _bounds(gmsh: Any, faces: list[int]) -> tuple[Any, Any]:
    boxes = np.array([gmsh.model.getBoundingBox(2, face) for face in faces])
    return boxes[:, :3].min(axis=0), boxes[:, 3:].max(axis=0)


def _diagonal(gmsh: Any, faces: list[int]) -> float:
    low, high = _bounds(gmsh, faces)
    return float(np.linalg.norm(high - low))


def _shells_around(gmsh: Any, shells: list[list[int]]) -> list[list[int]]:
    """Return the places of the shells around each, in the order of the list, which goes from the largest down.

    A shell in a recess of another one is in the box around it and not within it, which its corners say.
    """
    if len(shells) == 1:
        return [[]]
    filled = [gmsh.model.occ.addVolume([gmsh.model.occ.addSurfaceLoop(shell, sewing=False)]) for shell in shells]
    gmsh.model.occ.synchronize()
    around = []
    for place, shell in enumerate(shells):
        below = gmsh.model.getBoundary([(2, face) for face in shell], combined=False, oriented=False, recursive=True)
        corners = np.array([gmsh.model.getValue(0, point, []) for dimension, point in below if dimension == 0])
        around.append(
            [
                other
                for other in range(place)
                if len(corners) and gmsh.model.isInside(3, filled[other], corners.ravel()) == len(corners)
            ]
        )
    gmsh.model.occ.remove([(3, solid) for solid in filled])
    gmsh.model.occ.synchronize()
    return around


def conforming(gmsh: Any, solids: list[int], *, glue: bool = True) -> Shape:
    """Name the parts, and make touching solids share their faces where they are to be one piece.

    Raises
    ------
    GeometryError
        Where two of them overlap.
    """
    names = _unique([_label(gmsh, 3, tag) or f"solid-{i}" for i, tag in enumerate(solids, start=1)])
    labels = {(2, tag): _label(gmsh, 2, tag) for _, tag in gmsh.model.getEntities(2)}
    named = [entity for entity, label in labels.items() if label]
    if len(solids) == 1 or not glue:
        _check_apart(gmsh, dict(zip(names, solids, strict=True)))
        faces = {labels[entity]: [entity[1]] for entity in named}
        return Shape({name: [tag] for name, tag in zip(names, solids, strict=True)}, faces)
    volumes = [gmsh.model.occ.getMass(3, tag) for tag in solids]
    _, pieces = gmsh.model.occ.fragment([(3, tag) for tag in solids], named)
    gmsh.model.occ.synchronize()
    parts = {name: [tag for d, tag in piece if d == 3] for name, piece in zip(names, pieces[: len(names)], strict=True)}
    for i, first in enumerate(names):
        for j, second in enumerate(names[:i]):
            shared = sorted(set(parts[first]) & set(parts[second]))
            if _volume(gmsh, shared) > _LARGEST_SHARED_VOLUME * min(abs(volumes[i]), abs(volumes[j])):
                raise _overlapping(gmsh, second, first, shared)
    faces = {}
    for entity, piece in zip(named, pieces[len(names) :], strict=True):
        faces[labels[entity]] = [tag for d, tag in piece if d == 2]
    return Shape(parts, faces)


def _check_apart(gmsh: Any, solids: dict[str, int]) -> None:
    """Refuse solids that overlap, without changing them."""
    parts = list(solids.items())
    for i, (first, solid) in enumerate(parts):
        for second, other in parts[:i]:
            shared, _ = gmsh.model.occ.intersect([(3, solid)], [(3, other)], removeObject=False, removeTool=False)
            common = [tag for dimension, tag in shared if dimension == 3]
            if _volume(gmsh, common) > _LARGEST_SHARED_VOLUME * min(
                gmsh.model.occ.getMass(3, solid), gmsh.model.occ.getMass(3, other)
            ):
                raise _overlapping(gmsh, second, first, common)
            if shared:
                gmsh.model.occ.remove(shared, recursive=True)
    gmsh.model.occ.synchronize()


def _volume(gmsh: Any, solids: Sequence[int]) -> float:
    return float(sum(gmsh.model.occ.getMass(3, tag) for tag in solids))


def _overlapping(gmsh: Any, first: str, second: str, shared: Sequence[int]) -> GeometryError:
    """Return the refusal of two solids by the ones that they share, with the corners of the box around these."""
    boxes = np.array([gmsh.model.occ.getBoundingBox(3, tag) for tag in shared])
    low, high = (
        ", ".join(f"{round(float(value), 6) + 0.0:.6g}" for value in corner)
        for corner in (boxes[:, :3].min(axis=0), boxes[:, 3:].max(axis=0))
    )
    return GeometryError(
        f"its solids {first!r} and {second!r} overlap in a volume of {_volume(gmsh, shared):.4g}, between ({low}) and "
        f"({high}), in its own unit; cut one from the other in the CAD program, or take a solid out that is left over"
    )


def _label(gmsh: Any, dimension: int, tag: int) -> str:
    """Return an entity's own name in the file, the last part of gmsh's path of labels; empty for a placeholder."""
    label = str(gmsh.model.getEntityName(dimension, tag)).rpartition("/")[2].strip()
    return "" if _UNNAMED.fullmatch(label) else label


def _unique(names: list[str]) -> list[str]:
    """Append numbers to the names that stand for several solids."""
    counts, seen = Counter(names), Counter[str]()
    result = []
    for name in names:
        seen[name] += 1
        result.append(f"{name}-{seen[name]}" if counts[name] > 1 else name)
    return result
