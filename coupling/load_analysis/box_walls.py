"""Walls of a box as changes of a housing: derivatives of its model and its ports by the thickness of each wall."""

from dataclasses import replace

from scipy import sparse

from gearwhine.coupling.load_analysis.housing_fields import bearing_ports
from gearwhine.coupling.machine_description import Machine
from gearwhine.housing import Housing
from gearwhine.housing.fem.matrices import Additions
from gearwhine.housing.model.cover_bolts import cover_joints
from gearwhine.housing.updating import ModelSensitivity
from gearwhine.housing.updating.housing_change import HousingChange
from gearwhine.housing.updating.static_sensitivity import PortRates
from gearwhine.meshes import BoxGeometry, BoxMorph, Mesh
from gearwhine.meshes.box.parts import FACES

_STEP = 1e-4  # step over the thickness, in the central differences of quantities that are nearly linear in it


def wall_changes(housing: Housing, box: BoxGeometry, machine: Machine) -> tuple[HousingChange, ...]:
    """Differentiate the model of a box-shaped housing by the thickness of each of its walls.

    The mesh follows the walls; so do the bores in them, and what is fastened to them.

    Parameters
    ----------
    housing : Housing
        Housing of :meth:`gearwhine.housing.Housing.from_box`.
    box : BoxGeometry
        Its dimensions.
    machine : Machine
        Machine in the housing, whose bearings' ports are differentiated.

    Raises
    ------
    meshes.box.morph.MorphError
        Where the mesh cannot follow the walls.
    """
    morph, changes = BoxMorph(housing.mesh, box), []
    for face in FACES:
        thickness = box.wall.of(face)
        step = _STEP * thickness
        boxes = [replace(box, wall=replace(box.wall, **{face: thickness + way * step})) for way in (1.0, -1.0)]
        velocity = (morph.displacement(boxes[0]) - morph.displacement(boxes[1])) / (2.0 * step)
        beside = [
            _moved(housing, other, replace(housing.mesh, points=housing.mesh.points + way * step * velocity))
            for other, way in zip(boxes, (1.0, -1.0), strict=True)
        ]
        attached = [sum((fixture.additions(one.mesh) for fixture in one.fixtures), Additions()) for one in beside]
        n = len(housing.mesh.points)
        stiffness, mass = (
            sparse.csr_array((getattr(attached[0], kind).matrix(n) - getattr(attached[1], kind).matrix(n)) / (2 * step))
            for kind in ("stiffness", "mass")
        )
        bearings = _rates([bearing_ports(one, machine) for one in beside], step)
        sensors = _rates([{name: port.matrix for name, port in one.sensor_ports().items()} for one in beside], step)
        rate = ModelSensitivity(velocity, None, stiffness, mass)
        changes.append(
            HousingChange(f"{face} wall", "housing", rate, bearings, sensors, 1.0, reference=None, thickness=thickness)
        )
    return tuple(changes)


def _moved(housing: Housing, box: BoxGeometry, mesh: Mesh) -> Housing:
    """Return the housing of other walls on the moved mesh, the bolts of its cover made anew."""
    bolts = {bolt.name for bolt in box.bolts}
    kept = [fixture for fixture in housing.fixtures if fixture.name not in bolts]
    return replace(housing, mesh=mesh, box=box, fixtures=[*kept, *cover_joints(box, housing.material)])


def _rates(ports: list[dict[str, sparse.csr_array]], step: float) -> PortRates:
    above, below = ports
    return {name: sparse.csr_array((port - below[name]) / (2.0 * step)) for name, port in above.items()}
