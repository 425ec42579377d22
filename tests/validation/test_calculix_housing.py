"""A small housing whose stiffness and mass CalculiX assembles, in the machine in place of our own finite elements.

CalculiX 2.20 stores the matrices of the same mesh of quadratic tetrahedra, feet held (``SOLVER=MATRIXSTORAGE``). They
are reduced here to the seats' motions and a sensor's, with the fixed-interface modes (Craig and Bampton 1968,
Eq. 15), written as terms of Abaqus and taken as ``[housing.reduced]``. Where CalculiX (``ccx``) is not installed, the
frequencies that it gave are compared alone.
"""

import shutil
import subprocess
import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse import linalg as sparse_linalg
from solver_text import write_abaqus_terms

import gearwhine as gw
from gearwhine.housing.reduced import read_matrix, read_row_labels, reduced_matrices
from gearwhine.housing.reduced.certificate import certify
from gearwhine.meshes import write_mesh

MODES = 60
"""Fixed-interface modes that the reduction keeps, up to four times the frequency limit."""

RECORDED_HZ = (
    *(1238.7984659, 1329.9064268, 1401.9229064, 1418.4849405, 1738.9342783, 1963.1454931, 2139.1558899),
    *(2652.9051475, 2801.8421726, 2831.9305982, 2939.1614055),
)
"""Natural frequencies of the machine up to 3 kHz with the matrices of CalculiX 2.20 [Hz]."""


def document() -> dict[str, Any]:
    """The small gearbox on held feet, its walls of a coarse mesh."""
    case = tomllib.loads((files("gearwhine.cases") / "small-gearbox.toml").read_text("utf-8"))
    for table in ("provenance", "acoustics", "measured"):
        case.pop(table, None)
    housing = case["housing"]
    housing["box"]["mesh_size"] = "40 mm"
    housing["frequency_limit"] = "3 kHz"
    housing["support"] = [
        {"name": f"foot {number}", "surface": f"foot-{number}", "fixed": ["x", "y", "z"]} for number in range(1, 5)
    ]
    housing["sensor"] = [{"name": "top", "position": ["20 mm", "160 mm", "30 mm"], "direction": "y"}]
    return case


def stored_by_calculix(folder: Path, housing: Any) -> dict[str, Any]:
    """Stiffness and mass of the motions that are not held, and these motions as rows of three a node."""
    mesh = housing.mesh
    write_mesh(mesh, folder / "mesh.inp")
    held = {
        node + 1
        for number in range(1, 5)
        for block in mesh.surfaces[f"foot-{number}"]
        for node in np.unique(block.nodes)
    }
    material = housing.housing.material
    deck = ["*INCLUDE, INPUT=mesh.inp", "*NSET, NSET=HELD", *(f"{node}," for node in sorted(held))]
    deck += ["*ELSET, ELSET=ALL, GENERATE", f"1, {mesh.n_elements}", "*MATERIAL, NAME=M", "*ELASTIC"]
    deck += [f"{material.youngs_modulus!r}, {material.poisson_ratio!r}", "*DENSITY", repr(material.density)]
    deck += ["*SOLID SECTION, ELSET=ALL, MATERIAL=M", "*BOUNDARY", "HELD, 1, 3"]
    deck += ["*STEP", "*FREQUENCY, SOLVER=MATRIXSTORAGE", "10", "*END STEP", ""]
    (folder / "box.inp").write_text("\n".join(deck))
    subprocess.run(["ccx", "box"], cwd=folder, check=True, capture_output=True, timeout=300)
    rows = [line.split(".") for line in (folder / "box.dof").read_text().split()]
    found: dict[str, Any] = {"rows": np.array([3 * (int(node) - 1) + int(axis) - 1 for node, axis in rows])}
    for kind, ending in (("stiffness", "sti"), ("mass", "mas")):
        i, j, values = np.loadtxt(folder / f"box.{ending}").T
        upper = sparse.coo_array((values, (i.astype(int) - 1, j.astype(int) - 1)), shape=(len(rows),) * 2).tocsc()
        found[kind] = upper + sparse.triu(upper, 1).T
    return found


def reduced(stored: dict[str, Any], ports: sparse.csr_array) -> tuple[np.ndarray, np.ndarray]:
    """Mass and stiffness by the motions P u of the ports and the modes with these held.

    Static modes: K T + Pᵀ Λ = 0 with P T = 1. Modes with P φ = 0: by Lanczos steps from a motion that has it.
    """
    k, m, p = stored["stiffness"], stored["mass"], ports[:, stored["rows"]].tocsc()
    n, b = k.shape[0], p.shape[0]
    saddle = sparse_linalg.splu(sparse.block_array([[k, p.T], [p, None]], format="csc"))
    static = saddle.solve(np.vstack([np.zeros((n, b)), np.eye(b)]))[:n]
    inverse = sparse_linalg.LinearOperator((n, n), lambda x: saddle.solve(np.concatenate([x, np.zeros(b)]))[:n])
    start = inverse.matvec(np.random.default_rng(1).normal(size=n))
    _, modes = sparse_linalg.eigsh(k, MODES, m, sigma=0.0, OPinv=inverse, v0=start)
    basis = np.hstack([static, modes])
    return basis.T @ (m @ basis), basis.T @ (k @ basis)


def frequencies(study: Any) -> np.ndarray:
    found = study.system().dataset["system_frequency"].values
    return found[(found > 1.0) & (found < 3000.0)]


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
def test_the_machine_on_matrices_of_calculix(tmp_path: Path) -> None:
    case = document()
    ours = gw.build(**case)
    housing = ours.housing
    ports, rows = [], []
    for number, (_, port) in enumerate(housing.seat_ports.items(), start=1):
        ports.append(port)
        rows += [(number, axis) for axis in range(1, 7)]
    ports.append(housing.sensors["top"].matrix)
    rows += [(9, 2), *((100 + number, 0) for number in range(MODES))]
    mass, stiffness = reduced(stored_by_calculix(tmp_path, housing), sparse.vstack(ports, format="csr"))
    write_abaqus_terms(tmp_path / "mass.mtx", 0.5 * (mass + mass.T), rows)
    write_abaqus_terms(tmp_path / "stiffness.mtx", 0.5 * (stiffness + stiffness.T), rows)
    seats, sensors = case["housing"]["seat"], case["housing"]["sensor"]
    case["housing"] = {
        "frequency_limit": "3 kHz",
        "damping_ratio": case["housing"]["damping_ratio"],
        "reduced": {kind: str(tmp_path / f"{kind}.mtx") for kind in ("mass", "stiffness")},
        "seat": [
            {"name": seat["name"], "node": number, "center": seat["center"]}
            for number, seat in enumerate(seats, start=1)
        ],
        "sensor": [sensors[0] | {"node": 9}],
    }
    np.testing.assert_allclose(frequencies(gw.build(**case)), RECORDED_HZ, rtol=1e-6)


@pytest.mark.slow
def test_our_elements_give_the_frequencies_of_calculix() -> None:
    """Both integrate the same elements, by other rules: a fifth of the one percent that is asked for."""
    np.testing.assert_allclose(frequencies(gw.build(**document())), RECORDED_HZ, rtol=2e-3)


BRICK = """\
*NODE
1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n101,0.5,0.5,1\n102,0.5,0.5,1
*ELEMENT,TYPE=C3D8,ELSET=ALL
1,1,2,3,4,5,6,7,8
*NSET,NSET=TOP
5,6,7,8
*RIGID BODY,NSET=TOP,REF NODE=101,ROT NODE=102
*MATERIAL,NAME=M
*ELASTIC
2.1e5,0.3
*DENSITY
7.85e-9
*SOLID SECTION,ELSET=ALL,MATERIAL=M
*STEP
*FREQUENCY,SOLVER=MATRIXSTORAGE
5
*END STEP
"""


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
def test_a_rigid_body_of_calculix_is_a_node_with_six_motions(tmp_path: Path) -> None:
    """A brick of 1 mm of steel whose upper face is a rigid body, nothing held: six free motions, and ρ V of mass."""
    (tmp_path / "brick.inp").write_text(BRICK)
    subprocess.run(["ccx", "brick"], cwd=tmp_path, check=True, capture_output=True, timeout=60)
    rows = (tmp_path / "brick.dof").read_text().split()
    turned = [f"101.{int(row[-1]) + 3}" if row.startswith("102.") else row for row in rows]
    (tmp_path / "rows.dof").write_text("\n".join(turned))
    labels = read_row_labels(tmp_path / "rows.dof")
    read = {
        kind: read_matrix(tmp_path / f"brick.{ending}").with_rows(labels, ending)
        for kind, ending in (("stiffness", "sti"), ("mass", "mas"))
    }
    certificate = certify(reduced_matrices(read, units="mm-t-s"), {101: (0.5e-3, 0.5e-3, 1e-3)})
    assert certificate.free_motions == 6
    assert certificate.mass == pytest.approx(7.85e-6, rel=1e-9)
