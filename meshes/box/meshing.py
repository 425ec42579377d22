"""Meshing of a box housing with tetrahedra by gmsh."""

from meshes.box.faces import named_faces
from meshes.box.geometry import BoxGeometry
from meshes.box.solid import build_solid
from meshes.gmsh_session import gmsh_session
from meshes.mesh import Mesh
from meshes.tetrahedra import check_mesh_request, check_mesh_size, collect, mesh_solids


def mesh_box(geometry: BoxGeometry, mesh_size: float, *, order: int = 2) -> Mesh:
    """Mesh a box housing with tetrahedra.

    Parameters
    ----------
    geometry : BoxGeometry
    mesh_size : float
        Edge length aimed at [m].
    order : {1, 2}
        Polynomial order of the elements; with 2, middle nodes lie on the bores' cylinders.

    Returns
    -------
    Mesh
        With the surfaces left, right, bottom, top, back, front (plane outer faces), the undersides of the feet and
        their bolts' circles, the two circles of each bolt of a cover, and one surface for each bore under its own
        name. The volume housing is all of it; with a cover, body and cover stand in its place, which share nodes
        only where the cover is bonded.

    Raises
    ------
    MeshSizeError
        See :func:`meshes.check_mesh_size`.
    GeometryError
        Where gmsh cannot build or mesh the shape.
    """
    check_mesh_request(mesh_size, order)
    with gmsh_session("housing box") as gmsh:
        solid = build_solid(gmsh, geometry)
        surfaces = named_faces(gmsh, geometry, solid)
        # Parts and no whole beside them: some formats know one volume for each element.
        volumes = {"body": [*solid.body], "cover": [*solid.cover]} if solid.cover else {"housing": [*solid.body]}
        filled = sum(gmsh.model.occ.getMass(3, tag) for tag in (*solid.body, *solid.cover))
        check_mesh_size(filled, max(geometry.size), mesh_size)
        mesh_solids(gmsh, mesh_size, order)
        return collect(gmsh, order, surfaces, volumes).mesh()
