"""The housing that the benchmarks solve: a hollow box with two through bores, clamped under its four corners."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.housing import Material, Support
from gearwhine.housing.model.supports import fixed_freedoms
from gearwhine.meshes import Bore, BoxGeometry, Mesh, WallThickness, mesh_box

STEEL = Material(2.07e11, 0.3, 7850.0)
SIZE = (0.330, 0.279, 0.254)
WALL = 0.0127
BORE, BORE_HEIGHT, BORE_PLACES = 0.062, 0.140, (-0.0445, 0.0445)
PAD = 0.050


@dataclass(frozen=True)
class Problem:
    """A mesh in memory and its fixed degrees of freedom."""

    mesh: Mesh
    fixed: npt.NDArray[np.int64]

    @property
    def freedoms(self) -> int:
        """Degrees of freedom, the fixed ones among them."""
        return 3 * len(self.mesh.points)


def benchmark_box(mesh_size: float) -> Problem:
    """The box of P2 tetrahedra of a size [m]."""
    half = SIZE[2] / 2.0
    bores = tuple(
        Bore(f"{wall}-{number}", (x, BORE_HEIGHT, z), BORE)
        for wall, z in (("back", -half), ("front", half))
        for number, x in enumerate(BORE_PLACES, start=1)
    )
    mesh = mesh_box(BoxGeometry(size=SIZE, wall=WallThickness.uniform(WALL), bores=bores), mesh_size)
    low, high = mesh.bounds
    pads: list[Support] = []
    for x in (low[0], high[0] - PAD):
        for z in (low[2], high[2] - PAD):
            box = ((x, -1e-6, z), (x + PAD, 1e-6, z + PAD))
            pads.append(Support(f"pad {len(pads) + 1}", box=box, fixed=(True, True, True)))
    return Problem(mesh, fixed_freedoms(mesh, pads))
