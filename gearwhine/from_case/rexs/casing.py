"""Static stiffness of a case's housing at its bearing seats, as an assembly group of the casing in a REXS model."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gearwhine.case import Case
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.coupling.machine.reduced_component import interface_matrices
from gearwhine.exchange.rexs.model import Attribute
from gearwhine.exchange.rexs.reduced_casing import GROUNDED, MATRIX
from gearwhine.from_case.rexs.shafts import Shafts
from gearwhine.from_case.rexs.sheet import plain, vector
from gearwhine.housing.reduced.certificate import condensed_stiffness

_ALONG_U_V_W = [2, 0, 1, 5, 3, 4]  # motions along and about x, y, z in the order of u, v, w, which are z, x, y
_RESISTED = 1e-9  # least eigenvalue of a stiffness with a diagonal of ones that holds every rigid motion


def add_casing_stiffness(case: Case, shafts: Shafts, bearings: Mapping[str, int], housing: HousingComponent) -> bool:
    """Add the static stiffness at the seats that bearings stand in; return whether there is one.

    The matrix is in N, mm and rad, supports of the housing included: other coordinates follow without a load.
    """
    sheet = shafts.sheet
    at_seat = {bearing.seat: bearings[bearing.name] for bearing in case.bearing if bearing.name in bearings}
    seats = [name for name in housing.seats if name in at_seat]
    try:
        interface = interface_matrices(housing)
    except CouplingError as error:
        sheet.notes.left_out("[housing]", str(error))
        return False
    if not seats:
        return False
    nodes = {seat.name: seat for seat in interface.seats}
    rows = [interface.matrices.rows(nodes[name].node)[axis + 1] for name in seats for axis in _ALONG_U_V_W]
    stiffness = condensed_stiffness(interface.matrices.stiffness, rows)
    size = 1.0 / np.sqrt(np.maximum(np.diag(stiffness), 1e-300))
    is_held = bool(np.linalg.eigvalsh(size[:, None] * stiffness * size)[0] > _RESISTED)
    # N mm = 1e-3 J by motions in mm and rad.
    length = np.tile([1e-3] * 3 + [1.0] * 3, len(seats))
    stiffness = 1e3 * length[:, None] * stiffness * length
    stiffness = 0.5 * (stiffness + stiffness.T)
    matrix = Attribute(tuple(tuple(row) for row in stiffness.tolist()), "none")
    group = sheet.add("assembly_group", "housing", {MATRIX: matrix, GROUNDED: plain(is_held)})
    sheet.relate("reference", origin=shafts.casing, referenced=group)
    for order, name in enumerate(seats, start=1):
        x, y, z = nodes[name].center
        point = sheet.add("reduction_point", name, {"support_vector": vector((z, x, y))})
        sheet.relate_in_order("ordered_assembly", order, assembly=group, part=point)
        sheet.relate("reference", origin=point, referenced=at_seat[name])
    return True
