"""Animated 3D models of mode shapes: binary glTF 2.0 (GLB), which any viewer of 3D models opens.

Each file holds one motion: the outer surface at rest, the displacement as a morph target, its amplitude as colours, and
an animation that swings the target's weight as a sine; a motion that is not in one phase has two targets. The layout
follows the glTF 2.0 specification (Khronos Group, 2021; ISO/IEC 12113): little-endian, a JSON chunk padded by blanks, a
binary chunk padded by zeros.
"""

import json
import struct
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.housing.modes.natural_modes import ModeSet
from gearwhine.housing.pictures.drawn_shapes import (
    DRAWN_SCALE,
    DrawnHousing,
    DrawnShape,
    Skin,
    check_numbers,
    drawn_housing,
    drawn_modes,
)
from gearwhine.housing.storage.atomic_file import atomic_file
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray

_MAGIC, _VERSION, _JSON_CHUNK, _BINARY_CHUNK = 0x46546C67, 2, 0x4E4F534A, 0x004E4942
_FLOAT, _UNSIGNED_INT = 5126, 5125
_VERTICES, _INDICES = 34962, 34963
_TRIANGLES = 4
_PERIOD = 2.0  # period of the animation [s], whatever that of the mode
_FRAMES = 48  # linear pieces of a sine, visually smooth


def write_mode_models(
    mesh: Mesh, modes: ModeSet, numbers: Sequence[int], folder: Path, up: Sequence[float] = (0.0, 1.0, 0.0)
) -> list[Path]:
    """Write one model for each mode: ``mode-03-1007Hz.glb`` and so on; each appears whole or not at all.

    Parameters
    ----------
    mesh : Mesh
    modes : ModeSet
    numbers : sequence of int
        Numbers of the modes, from 1.
    folder : path
        Folder of the models; made where it is missing.

    Returns
    -------
    list of path
        The files, in the order of ``numbers``.

    Raises
    ------
    HousingError
        Where there is no mode of that number.
    """
    check_numbers(modes, numbers)
    folder.mkdir(parents=True, exist_ok=True)
    surface = drawn_housing(mesh, up)
    files = []
    for number, shape in zip(numbers, drawn_modes(surface, modes, numbers), strict=True):
        frequency = float(modes.frequencies_hz[number - 1])
        extras = {
            "mode": number,
            "frequency_hz": frequency,
            "largest_displacement_drawn_m": DRAWN_SCALE * surface.diagonal,
            "colours": "displacement / largest, viridis",
        }
        named = replace(shape, title=f"mode {number}, {frequency:.1f} Hz")
        path = folder / f"{shape.name}.glb"
        with atomic_file(path) as staged:
            staged.write_bytes(_model(surface, named, extras, light=False))
        files.append(path)
    return files


def light_model(surface: DrawnHousing, shape: DrawnShape, most_triangles: int) -> bytes:
    """Return a motion as a small GLB file: fewer triangles, faces without normals of their own.

    Parameters
    ----------
    surface : DrawnHousing
    shape : DrawnShape
        Motion of the surface; a complex one runs around.
    most_triangles : int
        Triangles are taken away where the deformed surface is flattest, down to this number.
    """
    return _model(*_decimated(surface, shape, most_triangles), extras={}, light=True)


def _decimated(surface: DrawnHousing, shape: DrawnShape, most: int) -> tuple[DrawnHousing, DrawnShape]:
    """Return surface and motion with at most `most` triangles; its points are some of those before."""
    count = len(surface.triangles)
    if count <= most:
        return surface, shape
    import pyvista as pv

    deformed = surface.rest + DRAWN_SCALE * surface.diagonal * shape.at(0.0)
    faces = np.column_stack([np.full(count, 3), surface.triangles]).ravel()
    skin = pv.PolyData(deformed, faces)
    skin.point_data["place"] = np.arange(len(deformed))
    thinned = skin.decimate_pro(1.0 - most / count, preserve_topology=True)
    places = np.asarray(thinned.point_data["place"], dtype=np.int64)
    triangles = np.asarray(thinned.faces, dtype=np.int64).reshape(-1, 4)[:, 1:]
    values = None if shape.values is None else shape.values[places]
    return (
        DrawnHousing(surface.rest[places], triangles, surface.nodes[places], surface.up),
        replace(shape, motion=shape.motion[places], values=values),
    )


def _model(surface: DrawnHousing, shape: DrawnShape, extras: Mapping[str, Any], *, light: bool) -> bytes:
    """Return the whole GLB file of one motion.

    A real motion has one target, Re U, that swings as a sine. A complex one has two, Re U and -Im U, from its widest
    phase: u = Re U cos - Im U sin.
    """
    rest, skin = surface.rest, Skin(surface.nodes, surface.triangles)
    scale = DRAWN_SCALE * surface.diagonal
    runs = np.iscomplexobj(shape.motion)
    parts = [scale * shape.at(0.0)] + ([scale * shape.at(0.5 * np.pi)] if runs else [])
    phase = np.linspace(0.0, 1.0, _FRAMES + 1)
    swing = np.column_stack([np.cos(2.0 * np.pi * phase)] * runs + [np.sin(2.0 * np.pi * phase)])

    buffer = _Buffer(light=light)
    attributes = {
        "POSITION": buffer.add(rest, _VERTICES, bounded=True),
        "COLOR_0": buffer.add(_colours(shape.amplitude), _VERTICES),
    }
    targets: list[dict[str, int]] = [{"POSITION": buffer.add(part, _VERTICES, bounded=True)} for part in parts]
    if not light:
        attributes["NORMAL"] = buffer.add(skin.normals(rest), _VERTICES)
        for target, part in zip(targets, parts, strict=True):
            # A target moves normals in proportion to its weight, which swings both ways: half the difference of the
            # extremes.
            turning = 0.5 * (skin.normals(rest + part) - skin.normals(rest - part))
            target["NORMAL"] = buffer.add(turning, _VERTICES)
    indices = buffer.add(skin.triangles.ravel(), _INDICES)
    times = buffer.add(_PERIOD * phase, None, bounded=True)
    weights = buffer.add(swing.ravel(), None)

    primitive = {"attributes": attributes, "targets": targets, "indices": indices, "material": 0, "mode": _TRIANGLES}
    start = [1.0, 0.0] if runs else [1.0]
    named = {"targetNames": [shape.title] if not runs else [shape.title, f"{shape.title}, a quarter later"]}
    document = {
        "asset": {"version": "2.0", "generator": "gearwhine"},
        "scene": 0,
        "scenes": [{"name": shape.title, "nodes": [0]}],
        "nodes": [{"name": "housing", "mesh": 0, "rotation": _upright(surface.up)}],
        "meshes": [{"name": shape.title, "primitives": [primitive], "weights": start, "extras": {**named, **extras}}],
        "materials": [
            {"name": "amplitude", "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.7}},
        ],
        "animations": [
            {
                "name": shape.title,
                "samplers": [{"input": times, "output": weights, "interpolation": "LINEAR"}],
                "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
            }
        ],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.content)}],
    }
    return _container(document, bytes(buffer.content))


def _upright(up: FloatArray) -> list[float]:
    """Return the quaternion (x, y, z, w) of the least rotation that takes a unit vector to y, which is up in glTF."""
    x, y, z = (float(part) for part in up)
    if y < -1.0 + 1e-9:
        return [0.0, 0.0, 1.0, 0.0]
    # The half angle's axis is u × y, its cosine is in 1 + u·y.
    quaternion = np.array([-z, 0.0, x, 1.0 + y])
    return [float(part) for part in quaternion / np.linalg.norm(quaternion)]


class _Buffer:
    """The binary chunk as it grows, with the views and accessors into it; a light one compresses better."""

    def __init__(self, *, light: bool) -> None:
        self._light = light
        self.content = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, values: npt.NDArray[Any], target: int | None, *, bounded: bool = False) -> int:
        """Append an array, as 32-bit numbers so that every view stays aligned, and return its accessor's number."""
        whole = values.dtype.kind in "iu"
        packed = np.ascontiguousarray(values, dtype="<u4" if whole else "<f4")
        if self._light and not whole and target is not None:
            # Eleven binary digits of each number are enough to look at.
            packed = (packed.view("<u4") & np.uint32(0xFFFFF000)).view("<f4")
        view = {"buffer": 0, "byteOffset": len(self.content), "byteLength": packed.nbytes}
        self.views.append(view if target is None else view | {"target": target})
        accessor: dict[str, Any] = {
            "bufferView": len(self.views) - 1,
            "componentType": _UNSIGNED_INT if whole else _FLOAT,
            "count": len(packed),
            "type": "SCALAR" if packed.ndim == 1 else f"VEC{packed.shape[1]}",
        }
        if bounded:
            accessor |= {
                bound: np.atleast_1d(extreme).astype(np.float64).tolist()
                for bound, extreme in (("min", packed.min(axis=0)), ("max", packed.max(axis=0)))
            }
        self.accessors.append(accessor)
        self.content += packed.tobytes()
        return len(self.accessors) - 1


def _container(document: dict[str, Any], binary: bytes) -> bytes:
    """Return the header and the two chunks of a GLB file, each padded to whole words."""
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode("utf-8")
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), _JSON_CHUNK) + text + struct.pack("<II", len(binary), _BINARY_CHUNK) + binary
    return struct.pack("<III", _MAGIC, _VERSION, 12 + len(chunks)) + chunks


def _colours(amplitude: FloatArray) -> FloatArray:
    """Colours of amplitudes from 0 to 1, as the linear light that glTF wants, shape (n, 3)."""
    from matplotlib import colormaps

    encoded = np.asarray(colormaps["viridis"](amplitude))[:, :3]
    # The inverse of sRGB's transfer curve (IEC 61966-2-1).
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
