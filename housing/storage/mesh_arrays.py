"""Mesh in a file: conversion of a mesh to labelled arrays and back."""

from collections.abc import Mapping, Sequence

import numpy as np

from gearwhine.housing.storage.netcdf import LabelledArray, digest
from gearwhine.meshes import ElementBlock, Mesh
from gearwhine.meshes.elements import Facets
from gearwhine.numerics.arrays import IntArray


def mesh_arrays(mesh: Mesh) -> dict[str, LabelledArray]:
    """Convert a mesh to labelled arrays: nodes, elements by kind, named surfaces and volumes.

    Elements stand in ``elements_1``, ``elements_2``, ... with their kind as an attribute. The facets of all named
    surfaces stand one after another in ``facets_KIND``, and ``facet_block_surface``, ``facet_block_kind`` and
    ``facet_block_size`` give the surface, kind and number of each block; the elements of named volumes likewise. Empty
    arrays are left out, because a dimension of length 0 has another meaning in NetCDF.
    """
    arrays = {"point": LabelledArray(("node", "component"), mesh.points, "m", "node coordinates")}
    for number, (kind, nodes) in enumerate(((block.kind, block.nodes) for block in mesh.blocks), start=1):
        arrays[f"elements_{number}"] = LabelledArray(
            (f"element_{number}", f"node_of_{kind}"), nodes, "1", f"nodes of each {kind}", {"kind": kind}
        )
    return arrays | _surface_arrays(mesh) | _volume_arrays(mesh)


def mesh_from_arrays(arrays: Mapping[str, LabelledArray]) -> Mesh:
    """Convert the arrays of :func:`mesh_arrays` back to the mesh, equal bit for bit.

    Raises
    ------
    KeyError, ValueError
        Where an array is missing or the arrays do not fit each other (:class:`gearwhine.meshes.GeometryError` among
        them).
    """
    blocks: list[ElementBlock] = []
    while (name := f"elements_{len(blocks) + 1}") in arrays:
        blocks.append(ElementBlock(arrays[name].attributes["kind"], arrays[name].values))
    return Mesh(
        points=arrays["point"].values,
        blocks=tuple(blocks),
        surfaces=_surfaces(arrays),
        volumes=_volumes(arrays),
    )


def mesh_digest(mesh: Mesh) -> str:
    """SHA-256 of a mesh's whole content: two meshes share it only where they are the same, bit for bit."""
    return digest(mesh_arrays(mesh))


def _surface_arrays(mesh: Mesh) -> dict[str, LabelledArray]:
    if not mesh.surfaces:
        return {}
    blocks = [
        (surface, block.kind, block.nodes) for surface, facets in enumerate(mesh.surfaces.values()) for block in facets
    ]
    arrays = {"surface_name": _names("surface", list(mesh.surfaces), "named parts of the surface")}
    if blocks:
        place = ("facet_block",)
        surfaces, kinds, sizes = zip(*((surface, kind, len(facets)) for surface, kind, facets in blocks), strict=True)
        arrays |= {
            "facet_block_surface": _integers(place, surfaces, "surface that a block of facets is part of, from 0"),
            "facet_block_kind": LabelledArray(place, np.array(kinds), "1", "kind of the facets"),
            "facet_block_size": _integers(place, sizes, "number of facets; blocks of a kind follow each other"),
        }
    for kind in dict.fromkeys(kind for _, kind, _ in blocks):
        nodes = np.concatenate([facets for _, other, facets in blocks if other == kind])
        dimensions = (f"facet_of_{kind}", f"node_of_{kind}")
        arrays[f"facets_{kind}"] = LabelledArray(dimensions, nodes, "1", f"nodes of each {kind}, outward", {})
    return arrays


def _surfaces(arrays: Mapping[str, LabelledArray]) -> dict[str, Facets]:
    if "surface_name" not in arrays:
        return {}
    names = [str(name) for name in arrays["surface_name"].values]
    surfaces: dict[str, Facets] = dict.fromkeys(names, ())
    if "facet_block_surface" not in arrays:
        return surfaces
    used: dict[str, int] = {}
    columns = [arrays[f"facet_block_{name}"].values.tolist() for name in ("surface", "kind", "size")]
    for surface, kind, size in zip(*columns, strict=True):
        start = used.get(kind, 0)
        nodes = arrays[f"facets_{kind}"].values[start : start + size]
        surfaces[names[surface]] += (ElementBlock(kind, nodes),)
        used[kind] = start + size
    return surfaces


def _volume_arrays(mesh: Mesh) -> dict[str, LabelledArray]:
    if not mesh.volumes:
        return {}
    sizes = [len(members) for members in mesh.volumes.values()]
    arrays = {
        "volume_name": _names("volume", list(mesh.volumes), "named groups of elements"),
        "volume_size": _integers(("volume",), sizes, "number of elements in each volume"),
    }
    if sum(sizes):
        members = np.concatenate(list(mesh.volumes.values()))
        long_name = "elements of all volumes, one volume after another, numbered from 0 over all kinds"
        arrays["volume_element"] = LabelledArray(("volume_member",), members, "1", long_name)
    return arrays


def _volumes(arrays: Mapping[str, LabelledArray]) -> dict[str, IntArray]:
    if "volume_name" not in arrays:
        return {}
    nothing = np.empty(0, dtype=np.int64)
    members = arrays["volume_element"].values if "volume_element" in arrays else nothing
    ends = np.cumsum(arrays["volume_size"].values)
    parts = np.split(members, ends[:-1])
    return {str(name): part for name, part in zip(arrays["volume_name"].values, parts, strict=True)}


def _names(dimension: str, names: list[str], long_name: str) -> LabelledArray:
    return LabelledArray((dimension,), np.array(names), "1", long_name)


def _integers(dimensions: tuple[str, ...], numbers: Sequence[int], long_name: str) -> LabelledArray:
    return LabelledArray(dimensions, np.array(numbers, dtype=np.int64), "1", long_name)
