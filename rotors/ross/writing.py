"""Writing of a rotor as a file that ROSS loads."""

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.errors import require, require_finite
from gearwhine.rotors.model.bearing import Bearing, Pedestal
from gearwhine.rotors.model.material import ElasticMaterial
from gearwhine.rotors.model.profile import STATION_TOLERANCE, merged_positions
from gearwhine.rotors.model.segment import Coupling, Segment
from gearwhine.rotors.model.shaft import Disc, Rotor, station_index
from gearwhine.rotors.ross.reading import PLACES
from gearwhine.rotors.ross.shafts import ross_formula
from gearwhine.rotors.ross.tables import Remarks

Table = dict[str, Any]

ROSS_VERSION = "2.3.0"
"""Release of ROSS whose format the files have."""

DEFAULT_ELEMENTS = 20
"""Least number of elements along the rotor where no element length is given."""


def write_ross(
    path: str | os.PathLike[str],
    rotor: Rotor,
    bearings: Sequence[Bearing] = (),
    *,
    element_length: float | None = None,
) -> tuple[str, ...]:
    """Write a rotor and its bearings as TOML that ``ross.Rotor.load`` reads.

    ROSS solves finite elements, so that its results depend on their length; every segment end, disc and bearing
    is a node whatever the length. A pedestal becomes a point mass at a node of its own (``n_link``), on a bearing to
    the ground. The file appears whole or not at all.

    Parameters
    ----------
    path : str or os.PathLike[str]
        The file; its suffix should be ``.toml``.
    rotor : Rotor
        Rotor of distributed mass.
    bearings : sequence of Bearing
        Bearings of the rotor.
    element_length : float, optional
        Longest element [m]; by default a twentieth of the rotor.

    Returns
    -------
    tuple of str
        Properties that ROSS lacks or computes in another way, a sentence each.

    Raises
    ------
    RotorError
        A lumped rotor, a disc or bearing within a coupling, a pedestal without mass, two elements of one name, or an
        element length that is not positive.
    OSError
        The file cannot be written.
    """
    expected = "'distributed': ROSS's elements carry their own mass"
    require(rotor.mass_model == "distributed", f"rotor {rotor.name!r} mass_model", rotor.mass_model, expected)
    longest = rotor.length / DEFAULT_ELEMENTS if element_length is None else element_length
    require_finite("element_length", longest, positive=True)
    for bearing in bearings:
        rotor.require_on_shaft(f"bearing {bearing.name!r}", bearing.at)
    remarks = Remarks()
    if rotor.stiffness_diameters:
        text = (
            f"{len(rotor.stiffness_diameters)} stiffness diameters, of gears for example, are left out: in ROSS one "
            "diameter has mass and stiffness, so that its shaft is softer there"
        )
        remarks.add(f"rotor {rotor.name!r}", text)
    nodes, owners = _nodes(rotor, bearings, longest)
    document: Table = {"ross_version": ROSS_VERSION, "parameters": {}}
    tables = _shaft(rotor, nodes, owners, remarks)
    tables += [_disc(number, station_index(nodes, disc.at), disc) for number, disc in enumerate(rotor.discs)]
    link = nodes.size
    for bearing in bearings:
        node = station_index(nodes, bearing.at)
        if bearing.pedestal is None:
            tables.append(_bearing(bearing, node, remarks))
        else:
            tables.append(_bearing(bearing, node, remarks) | {"n_link": link})
            tables += _pedestal(bearing.name, bearing.pedestal, link)
            link += 1
    for table in tables:
        kind = table.pop("class")
        document[f"{kind}_{table['tag']}"] = table
    names = [table["tag"] for table in tables]
    for name in names:
        require(names.count(name) == 1, "name of an element", name, "a name of its own, as ROSS demands")
    _write_whole(Path(path), tomli_w.dumps(document))
    return remarks.sentences()


def _nodes(rotor: Rotor, bearings: Sequence[Bearing], longest: float) -> tuple[FloatArray, list[int]]:
    """Positions of the nodes (n,) [m], and the segment of each element between them, (n − 1,)."""
    places = [disc.at for disc in rotor.discs] + [bearing.at for bearing in bearings]
    stations = merged_positions(rotor.joints, places)
    nodes, owners = [0.0], []
    for left, right in zip(stations[:-1].tolist(), stations[1:].tolist(), strict=True):
        owner = int(np.searchsorted(rotor.joints, 0.5 * (left + right))) - 1
        segment = rotor.segments[owner]
        whole = right - left > segment.length * (1.0 - STATION_TOLERANCE)
        if isinstance(segment, Coupling):
            where = f"rotor {rotor.name!r} disc or bearing position"
            require(whole, where, right if right < rotor.joints[owner + 1] else left, "a place outside the coupling")
            count = 1
        else:
            count = math.ceil((right - left) / longest * (1.0 - STATION_TOLERANCE))
        nodes += np.linspace(left, right, count + 1)[1:].tolist()
        owners += [owner] * count
    return np.array(nodes), owners


def _shaft(rotor: Rotor, nodes: FloatArray, owners: Sequence[int], remarks: Remarks) -> list[Table]:
    materials: dict[ElasticMaterial, Table] = {}
    tables = []
    for owner, segment in enumerate(rotor.segments):
        if isinstance(segment, Coupling):
            text = "the spring of a coupling has no length in ROSS, and resists a tilt of the whole shaft"
            remarks.add(f"rotor {rotor.name!r} segment {owner}", text)
            if segment.axial_force:
                text = f"the axial force of {segment.axial_force:g} N is left out: couplings of ROSS carry none"
                remarks.add(f"rotor {rotor.name!r} segment {owner}", text)
        else:
            _remark_on_shear(rotor, owner, segment, remarks)
            name = f"Material{len(materials)}"
            materials.setdefault(segment.material, _material(name, segment.material))
    for n, owner in enumerate(owners):
        segment = rotor.segments[owner]
        if isinstance(segment, Coupling):
            tables.append(_coupling(n, segment))
            continue
        start = float(rotor.joints[owner])
        ends = [segment.section((float(place) - start) / segment.length) for place in nodes[n : n + 2]]
        formula, shear, _ = ross_formula(segment)
        tables.append(
            {
                "class": "ShaftElement",
                "L": float(nodes[n + 1] - nodes[n]),
                "idl": ends[0].inner_diameter,
                "odl": ends[0].outer_diameter,
                "idr": ends[1].inner_diameter,
                "odr": ends[1].outer_diameter,
                "material": materials[segment.material],
                "n": n,
                "axial_force": segment.axial_force,
                "torque": 0.0,
                "shear_effects": shear,
                "rotary_inertia": True,
                "gyroscopic": True,
                "shear_method_calc": formula,
                "tag": f"Shaft Element {n}",
                "alpha": 0.0,
                "beta": 0.0,
            }
        )
    return tables


def _remark_on_shear(rotor: Rotor, number: int, segment: Segment, remarks: Remarks) -> None:
    formula, _, difference = ross_formula(segment)
    if difference:
        remarks.add(
            f"rotor {rotor.name!r} segment {number}",
            f"shear coefficient {segment.section(0.5).shear_factor:.6g} is none of ROSS's; its {formula!r} there is "
            f"{100.0 * difference:+.2g} % off",
        )


def _material(name: str, material: ElasticMaterial) -> Table:
    moduli = {"E": material.youngs_modulus, "G_s": material.shear_modulus}
    return {"name": name, "rho": material.density, **moduli, "color": "#525252"}


def _coupling(n: int, coupling: Coupling) -> Table:
    mass, polar = 0.5 * coupling.mass, 0.5 * coupling.polar_inertia
    # A diametral inertia of zero would be half the polar one to ROSS.
    diametral = max(0.5 * coupling.diametral_inertia, 1e-12 * polar)
    return {
        "class": "CouplingElement",
        **{f"m_{side}": mass for side in "lr"},
        **{f"Ip_{side}": polar for side in "lr"},
        **{f"Id_{side}": diametral for side in "lr"},
        "kt_x": coupling.lateral_stiffness,
        "kt_y": coupling.lateral_stiffness,
        "kt_z": coupling.axial_stiffness,
        "kr_x": coupling.tilt_stiffness,
        "kr_y": coupling.tilt_stiffness,
        "kr_z": coupling.torsional_stiffness,
        "ct_x": coupling.lateral_damping,
        "ct_y": coupling.lateral_damping,
        "ct_z": coupling.axial_damping,
        "cr_x": coupling.tilt_damping,
        "cr_y": coupling.tilt_damping,
        "cr_z": coupling.torsional_damping,
        "L": coupling.length,
        "n": n,
        "tag": f"Coupling {n}",
    }


def _disc(number: int, node: int, disc: Disc) -> Table:
    inertias = {"m": disc.mass, "Id": disc.diametral_inertia, "Ip": disc.polar_inertia}
    return {"class": "DiskElement", "n": node, **inertias, "tag": f"Disk {number}"}


def _bearing(bearing: Bearing, node: int, remarks: Remarks) -> Table:
    table: Table = {"class": "BearingElement", "n": node, "tag": bearing.name}
    speeds = 1 if bearing.speeds is None else bearing.speeds.size
    if bearing.speeds is not None:
        table["frequency"] = bearing.speeds.tolist()
    for letter, label, matrix in (("k", "stiffness", bearing.stiffness), ("c", "damping", bearing.damping)):
        rest = matrix.copy()
        for place, (row, column) in PLACES.items():
            if row < matrix.shape[-1]:
                table[letter + place] = np.broadcast_to(matrix[..., row, column], speeds).tolist()
                rest[..., row, column] = 0.0
            else:
                table[letter + place] = [0.0] * speeds
        if rest.any():
            remarks.add(f"bearing {bearing.name!r}", f"ROSS has no tilting {label}, nor any that couples it; left out")
    return table


def _pedestal(name: str, pedestal: Pedestal, node: int) -> list[Table]:
    label = f"mass of the pedestal of bearing {name!r}"
    require(pedestal.mass > 0.0, label, pedestal.mass, "a positive mass: ROSS inverts the mass matrix")
    support: Table = {"class": "BearingElement", "n": node, "tag": f"{name} support"}
    for letter, matrix in (("k", pedestal.stiffness), ("c", pedestal.damping)):
        for place, (row, column) in PLACES.items():
            support[letter + place] = [float(matrix[row, column])] if row < 2 else [0.0]
    mass = {"class": "PointMass", "n": node, "tag": f"{name} support mass"}
    return [support, mass | dict.fromkeys(("m", "mx", "my", "mz"), pedestal.mass)]


def _write_whole(path: Path, text: str) -> None:
    """Write a temporary file and rename it, so that no partial file remains."""
    staged = path.with_name(f".{path.name}.partial")
    try:
        staged.write_text(text, encoding="utf-8")
        os.replace(staged, path)
    finally:
        staged.unlink(missing_ok=True)
