"""Animated 3D models of mode shapes: binary glTF 2.0 (GLB), which any viewer of 3D models opens.

Each file holds one mode: the outer surface at rest, the displacement as a morph target, its amplitude as colours, and
an animation that swings the target's weight as a sine. The layout follows the glTF 2.0 specification (Khronos Group,
2021; ISO/IEC 12113): little-endian, a JSON chunk padded by blanks, a binary chunk padded by zeros.
"""

import json
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from housing.modes.natural_modes import ModeSet
from housing.pictures.drawn_shapes import DRAWN_SCALE, Skin, check_numbers, drawn_name, outer_skin
from housing.storage.atomic_file import atomic_file
from meshes import Mesh

FloatArray = npt.NDArray[np.float64]

_MAGIC, _VERSION, _JSON_CHUNK, _BINARY_CHUNK = 0x46546C67, 2, 0x4E4F534A, 0x004E4942
_FLOAT, _UNSIGNED_INT = 5126, 5125
_VERTICES, _INDICES = 34962, 34963
_TRIANGLES = 4
_PERIOD = 2.0  # of the animation [s], whatever the mode's own
_FRAMES = 48  # linear pieces of a sine, visually smooth


def write_mode_models(mesh: Mesh, modes: ModeSet, numbers: Sequence[int], folder: Path) -> list[Path]:
    """Write one model for each mode: ``mode-03-1007Hz.glb`` and so on; each appears whole or not at all.

    Parameters
    ----------
    mesh, modes
        The housing and its modes.
    numbers : sequence of int
        Which modes, from 1.
    folder : path
        Where the models go; made where it is missing.

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
    skin = outer_skin(mesh)
    files = []
    for number in numbers:
        path = folder / f"{drawn_name(modes, number)}.glb"
        with atomic_file(path) as staged:
            staged.write_bytes(_model(mesh, skin, modes, number))
        files.append(path)
    return files


def _model(mesh: Mesh, skin: Skin, modes: ModeSet, number: int) -> bytes:
    """Return the whole GLB file of one mode."""
    shape = modes.shapes[number - 1][skin.nodes]
    rest = mesh.points[skin.nodes]
    amplitude = np.linalg.norm(shape, axis=1)
    largest = float(amplitude.max())
    diagonal = float(np.linalg.norm(np.ptp(rest, axis=0)))
    displacement = shape * (DRAWN_SCALE * diagonal / largest)
    # A target moves normals in proportion to its weight, which swings both ways: half the difference of the extremes.
    turning = 0.5 * (skin.normals(rest + displacement) - skin.normals(rest - displacement))
    phase = np.linspace(0.0, 1.0, _FRAMES + 1)

    buffer = _Buffer()
    attributes = {
        "POSITION": buffer.add(rest, _VERTICES, bounded=True),
        "NORMAL": buffer.add(skin.normals(rest), _VERTICES),
        "COLOR_0": buffer.add(_colours(amplitude / largest), _VERTICES),
    }
    target = {
        "POSITION": buffer.add(displacement, _VERTICES, bounded=True),
        "NORMAL": buffer.add(turning, _VERTICES),
    }
    indices = buffer.add(skin.triangles.ravel(), _INDICES)
    times = buffer.add(_PERIOD * phase, None, bounded=True)
    weights = buffer.add(np.sin(2.0 * np.pi * phase), None)

    frequency = float(modes.frequencies_hz[number - 1])
    name = f"mode {number}, {frequency:.1f} Hz"
    primitive = {
        "attributes": attributes,
        "targets": [target],
        "indices": indices,
        "material": 0,
        "mode": _TRIANGLES,
    }
    extras = {
        "targetNames": [name],
        "mode": number,
        "frequency_hz": frequency,
        "largest_displacement_drawn_m": DRAWN_SCALE * diagonal,
        "colours": "displacement / largest, viridis",
    }
    document = {
        "asset": {"version": "2.0", "generator": "gearwhine"},
        "scene": 0,
        "scenes": [{"name": name, "nodes": [0]}],
        "nodes": [{"name": "housing", "mesh": 0}],
        "meshes": [{"name": name, "primitives": [primitive], "weights": [1.0], "extras": extras}],
        "materials": [
            {"name": "amplitude", "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.7}},
        ],
        "animations": [
            {
                "name": name,
                "samplers": [{"input": times, "output": weights, "interpolation": "LINEAR"}],
                "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
            }
        ],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.content)}],
    }
    return _container(document, bytes(buffer.content))


class _Buffer:
    """The binary chunk as it grows, with the views and accessors into it."""

    def __init__(self) -> None:
        self.content = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, values: npt.NDArray[Any], target: int | None, *, bounded: bool = False) -> int:
        """Append an array, as 32-bit numbers so that every view stays aligned, and return its accessor's number."""
        whole = values.dtype.kind in "iu"
        packed = np.ascontiguousarray(values, dtype="<u4" if whole else "<f4")
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
