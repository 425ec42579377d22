"""Bolts of a box's cover: each a joint between its patches on the rim and on the cover."""

from gearwhine.housing.material import Material
from gearwhine.housing.model.bolted_joints import bolted_joint
from gearwhine.housing.model.bushings import Bushing, Joint
from gearwhine.housing.model.patches import Patch
from gearwhine.meshes import Bolt, BoxGeometry


def cover_joints(
    box: BoxGeometry,
    material: Material,
    bolt_material: Material | None = None,
    cover_material: Material | None = None,
) -> list[Joint]:
    """Preloaded bolts of a box's cover, each a joint between its patches on rim and cover.

    Parameters
    ----------
    box : gearwhine.meshes.BoxGeometry
    material : Material
        Material of the housing.
    bolt_material, cover_material : Material, optional
        Materials of the bolts and of the cover; that of the housing by default.
    """
    return [cover_joint(box, bolt, material, bolt_material, cover_material) for bolt in box.bolts]


def cover_joint(
    box: BoxGeometry,
    bolt: Bolt,
    material: Material,
    bolt_material: Material | None = None,
    cover_material: Material | None = None,
) -> Joint:
    """Preloaded bolt of a box's cover, as :func:`cover_joints` has all of them."""
    outer = max(box.rim_width, bolt.patch_diameter)  # a narrow rim leaves the cone of pressure no more than its width
    cover = None if cover_material is None else (cover_material, bolt.cover_grip)
    springs = bolted_joint(bolt.diameter, bolt.grip, material, bolt_material, cover=cover, outer=outer).stiffness
    first, second = Patch(bolt.body_surface), Patch(bolt.cover_surface)
    return Joint(bolt.name, first, second, Bushing.along(bolt.axis, springs), bolt.position)
