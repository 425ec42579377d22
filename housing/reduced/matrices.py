"""Reduced mass, stiffness and damping matrices: their coordinates, their units, and what they must be.

A coordinate is a motion of an interface node, by the node's number and a component (1 to 3: along x, y, z; 4 to 6:
about x, y, z), or an internal one of the component 0, such as the amplitude of a fixed-interface mode (Craig and
Bampton 1968, AIAA Journal 6(7), Eq. 15).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy import sparse

from gearwhine.housing.errors import HousingError
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, Part, refuse

Coordinate = tuple[int, int]
"""Number of a node and a component from 1 to 6; component 0 of an internal coordinate."""

MOST_COORDINATES = 3000
"""Order of a matrix beyond which it is refused: three dense ones of this order take 216 MB."""

ASYMMETRY = 1e-6
"""Largest |A - Aᵀ| over |A| of a matrix that is printed with seven digits, as of small fields."""

INDEFINITENESS = 1e-8
"""Largest negative eigenvalue of a semidefinite matrix that is printed, over its largest one."""

MASSLESS = INDEFINITENESS
"""Eigenvalue of the mass matrix with a diagonal of ones, below which a combination of coordinates has no mass."""

LARGEST_TERM = 1e100
"""Size beyond which a term of a matrix is no quantity: products of two stay finite."""

HELD = 1e30
"""Stiffness at and beyond which a motion counts as held: Abaqus puts 1e36 on the diagonal of one."""

USUAL_NAMES = {
    "mass": ("MASS", "M", "MAAX", "MAA", "MGG", "MXX"),
    "stiffness": ("STIFFNESS", "K", "KAAX", "KAA", "KGG", "KXX"),
    "damping": ("DAMPING", "C", "B", "BAAX", "BAA", "BGG", "BXX"),
}
"""Names by which a matrix is known in a file of several, in capitals."""

UNITS = {"SI": (1.0, 1.0), "mm-t-s": (1e-3, 1e-3)}
"""Length [m] and energy [J] of each system of units: t mm²/s² is 1e-3 J."""


_PAIRS = "pairs (node, component): 1 to 3 along x, y, z, 4 to 6 about them, 0 for an internal coordinate"


@dataclass(frozen=True)
class LabelledMatrix:
    """A square matrix as a file holds it, or one of your own with its coordinates.

    Attributes
    ----------
    values : ndarray, shape (n, n)
        In the units of the file.
    coordinates : tuple of (int, int), or None
        Node and component of each row and column, where the file names them: components 1 to 3 are motions of the node
        along x, y, z, and 4 to 6 about them; ``(number, 0)`` is an internal coordinate, such as a modal amplitude.
    """

    values: FloatArray
    coordinates: tuple[Coordinate, ...] | None = None

    def with_rows(self, rows: "RowLabels", file: str) -> "LabelledMatrix":
        """Return the matrix with coordinates of its rows from another file than its own, called ``file``.

        Nodes that move along axes A of their own, the rows of A, have the motions A u of those along the axes of all:
        with T of these blocks the matrix becomes Tᵀ K T.

        Raises
        ------
        HousingError
            Where the file names them itself, there are more or fewer of them, or a node with axes of its own has one or
            two of three motions.
        """
        if self.coordinates is not None:
            raise HousingError(f"{file} names its nodes itself; expected no mapping of rows beside it")
        coordinates = tuple(rows.coordinates)
        if len(coordinates) != len(self.values):
            order = len(self.values)
            raise HousingError(f"{file} is of order {order}; expected {len(coordinates)}, the rows of the mapping")
        turned = in_basic_axes(self.values, rows, file)
        values = in_basic_axes(turned.T, rows, file).T
        return LabelledMatrix(values, coordinates)


@dataclass(frozen=True)
class RowLabels:
    """Coordinates of the rows of a matrix, as another file than its own names them.

    Attributes
    ----------
    coordinates : tuple of Coordinate
    axes : mapping of int to ndarray, shape (3, 3)
        Axes of the motions of a node, as rows, where they are others than those of all nodes.
    """

    coordinates: tuple[Coordinate, ...]
    axes: Mapping[int, FloatArray] = field(default_factory=dict)


def in_basic_axes(values: FloatArray, rows: RowLabels, file: str = "the file") -> FloatArray:
    """Return columns by motions along the axes of all in place of those along a node's own, A T; (..., n).

    Raises
    ------
    HousingError
        Where a node with axes of its own has one or two of three motions.
    """
    turned = values.copy()
    place = {coordinate: row for row, coordinate in enumerate(rows.coordinates)}
    for node, axes in rows.axes.items():
        for three in ((1, 2, 3), (4, 5, 6)):
            at = [place[node, axis] for axis in three if (node, axis) in place]
            if len(at) == 3:
                turned[..., at] = turned[..., at] @ axes
            elif at:
                raise HousingError(
                    f"{file}: node {node} has {len(at)} of its motions {three[0]} to {three[2]}, along axes of its "
                    "own; expected all three or none"
                )
    return turned


def chosen_matrix(names: Sequence[str], name: str, kind: str, file: str) -> str:
    """Return the name of the matrix that is meant: the one of this name, the only one, or the one of a usual name.

    Parameters
    ----------
    names : sequence of str
        Names in the file.
    name : str
        Name that is asked for, as the file writes it; empty for none.
    kind : {"", "mass", "stiffness", "damping"}
        Matrix that is meant, see :data:`USUAL_NAMES`.
    file : str
        Name of the file, for messages.

    Raises
    ------
    HousingError
        Where there is no such matrix, or several could be meant.
    """
    listed = ", ".join(map(repr, names[:20])) or "none at all"
    if name:
        if name not in names:
            raise HousingError(f"{file}: expected a matrix {name!r}; it has {listed}")
        if (count := names.count(name)) > 1:
            raise HousingError(f"{file}: expected one matrix {name!r}; it has {count} of this name")
        return name
    if len(names) == 1:
        return names[0]
    usual = [one for one in names if one.upper() in USUAL_NAMES.get(kind, ())]
    if len(usual) != 1:
        raise HousingError(f"{file}: expected the name of one of its matrices; it has {listed}")
    return usual[0]


@dataclass(frozen=True)
class ReducedMatrices:
    """Mass, stiffness and damping of a reduced housing in SI.

    Attributes
    ----------
    mass : ndarray, shape (n, n)
        M: kg of translations, kg m and kg m² with rotations.
    stiffness : ndarray, shape (n, n)
        K: N/m of translations, N and N m with rotations.
    coordinates : tuple of (int, int)
        Node and component of each row, each once, as in :class:`LabelledMatrix`.
    damping : ndarray, shape (n, n), or None
        C of viscous damping: N s/m of translations.
    is_static : bool
        Whether the mass is zero: the housing follows its loads without resonances of its own.

    Raises
    ------
    HousingError
        Where a matrix is not square, finite, symmetric or semidefinite, is of another order, or a coordinate is given
        twice.
    """

    mass: FloatArray
    stiffness: FloatArray
    coordinates: tuple[Coordinate, ...]
    damping: FloatArray | None = None
    is_static: bool = False

    def __post_init__(self) -> None:
        """Keep symmetric copies; check order, symmetry and definiteness."""
        given = {"mass": self.mass, "stiffness": self.stiffness}
        if self.damping is not None:
            given["damping"] = self.damping
        matrices = {name: np.array(matrix, dtype=np.float64) for name, matrix in given.items()}
        try:
            object.__setattr__(self, "coordinates", tuple((int(node), int(axis)) for node, axis in self.coordinates))
        except (TypeError, ValueError):
            refuse([Finding(("reduced housing", ""), "coordinates", self.coordinates, _PAIRS)], HousingError)
        refuse(self._order_findings(matrices), HousingError)
        refuse(_symmetry_findings(matrices), HousingError)
        for name, matrix in matrices.items():
            symmetric = 0.5 * (matrix + matrix.T)
            symmetric.setflags(write=False)
            object.__setattr__(self, name, symmetric)
        checked = [name for name in matrices if not (self.is_static and name == "mass")]
        refuse(_definiteness_findings({name: getattr(self, name) for name in checked}), HousingError)
        if self.is_static and self.mass.any():
            refuse([Finding(_part("mass"), "", None, "a mass of zero of a static housing")], HousingError)

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.coordinates)

    @property
    def nodes(self) -> tuple[int, ...]:
        """Numbers of the interface nodes, in order."""
        return tuple(dict.fromkeys(node for node, axis in self.coordinates if axis))

    def rows(self, node: int) -> dict[int, int]:
        """Row of each component of a node."""
        return {axis: row for row, (number, axis) in enumerate(self.coordinates) if number == node and axis}

    def _order_findings(self, matrices: Mapping[str, FloatArray]) -> Iterator[Finding]:
        """Yield matrices of another order or with numbers that are not finite, and coordinates that there cannot be."""
        n = len(self.coordinates)
        for name, matrix in matrices.items():
            if matrix.shape != (n, n):
                expected = f"a square matrix of order {n}, that of the coordinates; its shape is {matrix.shape}"
                yield Finding(_part(name), "", None, expected)
            elif not (within := np.abs(matrix) <= LARGEST_TERM).all():
                row, column = np.argwhere(~within)[0]
                place = f"row {row + 1}, column {column + 1}"
                yield Finding(_part(name), place, float(matrix[row, column]), "a finite number")
        if not 0 < n <= MOST_COORDINATES:
            yield Finding(("reduced housing", ""), "order", n, f"from 1 to {MOST_COORDINATES} coordinates")
        once = dict.fromkeys(self.coordinates)
        if twice := [one for one in once if self.coordinates.count(one) > 1][:3] if len(once) < n else []:
            yield Finding(("reduced housing", ""), "coordinates", tuple(twice), "each coordinate once")
        if wrong := [one for one in once if not 0 <= one[1] <= 6][:3]:
            yield Finding(("reduced housing", ""), "coordinates", tuple(wrong), _PAIRS)
        components: dict[int, set[int]] = {}
        for node, axis in once:
            components.setdefault(node, set()).add(axis)
        # An internal coordinate may bear the number of a node, but no such node has six motions or three then.
        of_nodes = [axes for axes in components.values() if axes != {0}]
        if of_nodes and all(axes in (set(range(6)), set(range(3))) for axes in of_nodes):
            expected = f"{_PAIRS}; the components of all nodes count from 0"
            yield Finding(("reduced housing", ""), "coordinates", self.coordinates[:3], expected)


def reduced_matrices(
    matrices: Mapping[str, Any], nodes: Sequence[int] | Mapping[int, Sequence[int]] = (), units: str = "SI"
) -> ReducedMatrices:
    """Make reduced matrices in SI from those of files, or from arrays.

    With the length L [m] and the energy E [J] of the units, and S = diag(L for a translation, 1 otherwise), energies
    qᵀ A q are the same in SI where A_SI = E S⁻¹ A S⁻¹.

    Parameters
    ----------
    matrices : mapping of str to LabelledMatrix, or to an array of NumPy or SciPy, shape (n, n)
        ``stiffness``, and ``mass`` and ``damping`` where there are any: without a mass the housing is static. Rows that
        one of labelled matrices lacks are zero; those of a stiffness of :data:`HELD` are left out.
    nodes : sequence of int, or mapping of int to sequence of int
        Nodes of rows that bear no names: numbers of the nodes to which the first rows belong, six each; or the rows of
        each node, counted from 0, of its motions along x, y, z and about them (six), or along x, y, z (three). All
        other rows are internal.
    units : {"SI", "mm-t-s"}
        Units of the matrices.

    Raises
    ------
    HousingError
        Where one file names its coordinates and another does not, there are fewer rows than motions of the nodes, or
        the matrices are not those of a housing.
    """
    if units not in UNITS:
        refuse([Finding(("reduced housing", ""), "units", units, f"one of {', '.join(UNITS)}")], HousingError)
    if "stiffness" not in matrices or not set(matrices) <= set(USUAL_NAMES):
        expected = "'stiffness', with 'mass' and 'damping' where there are any"
        refuse([Finding(("reduced housing", ""), "matrices", tuple(matrices), expected)], HousingError)
    matrices = {name: _as_labelled(name, matrix) for name, matrix in matrices.items()}
    labelled = {name: matrix.coordinates for name, matrix in matrices.items() if matrix.coordinates is not None}
    if labelled and len(labelled) < len(matrices):
        without = next(name for name in matrices if name not in labelled)
        expected = f"node numbers in its file as in that of the {next(iter(labelled))}, in place of rows by order alone"
        refuse([Finding(_part(without), "", None, expected)], HousingError)
    values = {name: matrix.values for name, matrix in matrices.items()}
    if labelled:
        if nodes:
            expected = "none beside files that name their nodes themselves"
            refuse([Finding(("reduced housing", ""), "nodes", tuple(nodes), expected)], HousingError)
        union = sorted(set().union(*labelled.values()), key=lambda one: (one[1] == 0, one))
        if len(union) > MOST_COORDINATES:
            expected = f"from 1 to {MOST_COORDINATES} coordinates"
            refuse([Finding(("reduced housing", ""), "order", len(union), expected)], HousingError)
        place = {coordinate: row for row, coordinate in enumerate(union)}
        for name, coordinates in labelled.items():
            rows = [place[coordinate] for coordinate in coordinates]
            values[name] = np.zeros((len(union), len(union)))
            values[name][np.ix_(rows, rows)] = matrices[name].values
        coordinates = tuple(union)
        held = np.diag(values["stiffness"]) >= HELD
        if held.any():
            coordinates = tuple(one for one, is_held in zip(union, held, strict=True) if not is_held)
            values = {name: matrix[np.ix_(~held, ~held)] for name, matrix in values.items()}
    else:
        coordinates = _coordinates_of_rows(nodes, len(values["stiffness"]))
    for name, matrix in values.items():
        if matrix.shape == (len(coordinates),) * 2:
            values[name] = _in_si(matrix, coordinates, units)
    mass = values.get("mass", np.zeros((len(coordinates),) * 2))
    return ReducedMatrices(mass, values["stiffness"], coordinates, values.get("damping"), "mass" not in values)


def _as_labelled(name: str, matrix: Any) -> LabelledMatrix:
    """Return a matrix with its values dense, and coordinates where it has any."""
    values: Any = matrix.values if isinstance(matrix, LabelledMatrix) else matrix
    coordinates = matrix.coordinates if isinstance(matrix, LabelledMatrix) else None
    is_sparse = bool(sparse.issparse(values))
    try:
        is_small = is_sparse and max(values.shape) <= MOST_COORDINATES
        dense = np.array(values.toarray() if is_small else values, dtype=np.float64)
    except (TypeError, ValueError):
        dense = np.zeros(0)
    if dense.ndim != 2:
        expected = f"a square matrix, as an array of NumPy or SciPy of order {MOST_COORDINATES} at most"
        refuse([Finding(_part(name), "", values, expected)], HousingError)
    return LabelledMatrix(dense, coordinates)


def _coordinates_of_rows(nodes: Sequence[int] | Mapping[int, Sequence[int]], order: int) -> tuple[Coordinate, ...]:
    """Coordinates of rows without names; those of no node are internal, with their places as numbers."""
    if not isinstance(nodes, Mapping):
        if 6 * len(nodes) > order or not nodes:
            expected = f"at least one node, and six rows for each: the order of the stiffness is {order}"
            refuse([Finding(("reduced housing", ""), "nodes", tuple(nodes), expected)], HousingError)
        nodes = {node: range(6 * place, 6 * place + 6) for place, node in enumerate(nodes)}
    coordinates = [(row + 1, 0) for row in range(order)]
    free = set(range(order))
    for node, rows in nodes.items():
        if len(rows) not in (3, 6) or len(set(rows)) < len(rows) or not free.issuperset(rows):
            expected = f"six rows or three for each node, from 0 to {order - 1} and of no other node"
            refuse([Finding(("node", str(node)), "rows", tuple(rows), expected)], HousingError)
        free.difference_update(rows)
        for axis, row in enumerate(rows, start=1):
            coordinates[row] = (int(node), axis)
    return tuple(coordinates)


def _in_si(matrix: FloatArray, coordinates: Sequence[Coordinate], units: str) -> FloatArray:
    """Return E S⁻¹ A S⁻¹ of :func:`reduced_matrices`."""
    length, energy = UNITS[units]
    per_unit = np.array([1.0 / length if 1 <= axis <= 3 else 1.0 for _, axis in coordinates])
    with np.errstate(over="ignore"):  # what is no number of a housing is refused later, by its place
        return np.asarray(energy * per_unit[:, None] * matrix * per_unit)


@dataclass(frozen=True)
class StaticStiffness:
    """Static stiffness of the interface nodes, from another computation than the reduction.

    Attributes
    ----------
    values : ndarray, shape (n, n)
        N/m of translations, N and N m with rotations.
    coordinates : tuple of Coordinate
    """

    values: FloatArray
    coordinates: tuple[Coordinate, ...]


def static_stiffness(matrix: LabelledMatrix, nodes: Sequence[int] = (), units: str = "SI") -> StaticStiffness:
    """Make a static stiffness in SI of that of a file.

    Parameters
    ----------
    matrix : LabelledMatrix
    nodes : sequence of int
        Nodes of the rows, six each, where the file does not name them.
    units : {"SI", "mm-t-s"}

    Raises
    ------
    HousingError
        Where there are more or fewer rows than motions of the nodes, or the matrix is not symmetric.
    """
    coordinates = matrix.coordinates
    if coordinates is None:
        coordinates = tuple((node, axis) for node in nodes for axis in range(1, 7))
    if len(coordinates) != len(matrix.values):
        expected = f"six rows for each of the {len(nodes)} nodes; its order is {len(matrix.values)}"
        refuse([Finding(_part("static"), "", None, expected)], HousingError)
    values = _in_si(matrix.values, coordinates, units)
    if not (np.abs(values) <= LARGEST_TERM).all():
        refuse([Finding(_part("static"), "", None, "finite numbers")], HousingError)
    refuse(_symmetry_findings({"static": values}), HousingError)
    return StaticStiffness(0.5 * (values + values.T), coordinates)


def _part(name: str) -> Part:
    return ("reduced housing", name)


def scaled(matrix: FloatArray) -> FloatArray:
    """Return D A D with D = |diag A|^(-1/2), in which translations and rotations have no units any more; (n, n)."""
    diagonal = np.abs(np.diag(matrix))
    per_row = np.divide(1.0, np.sqrt(diagonal), out=np.zeros(len(matrix)), where=diagonal > 0.0)
    return np.asarray(per_row[:, None] * matrix * per_row)


def _symmetry_findings(matrices: Mapping[str, FloatArray]) -> Iterator[Finding]:
    """Yield matrices that are not symmetric, each with the place of its largest asymmetry."""
    for name, matrix in matrices.items():
        difference = np.abs(matrix - matrix.T)
        # By a translation's and a rotation's own size, whose units differ.
        size = np.sqrt(np.outer(np.abs(np.diag(matrix)), np.abs(np.diag(matrix))))
        size = np.maximum(np.maximum(size, np.abs(matrix)), np.abs(matrix.T))
        relative = np.divide(difference, size, out=np.zeros_like(size), where=size > 0.0)
        if relative.max(initial=0.0) > ASYMMETRY:
            row, column = np.unravel_index(int(relative.argmax()), relative.shape)
            expected = (
                f"a symmetric matrix; row {row + 1}, column {column + 1} is {matrix[row, column]:.6g} and its mirror "
                f"{matrix[column, row]:.6g}"
            )
            yield Finding(_part(name), "", None, expected)


def _definiteness_findings(matrices: Mapping[str, FloatArray]) -> Iterator[Finding]:
    """Yield matrices with negative eigenvalues, which hold negative energy."""
    for name, matrix in matrices.items():
        without_diagonal = (np.diag(matrix) == 0.0) & (np.abs(matrix).max(axis=1, initial=0.0) > 0.0)
        if without_diagonal.any():
            row = int(np.flatnonzero(without_diagonal)[0]) + 1
            expected = f"no negative eigenvalue; row {row} has a diagonal of zero and others beside it"
            yield Finding(_part(name), "", None, expected)
            continue
        eigenvalues = np.linalg.eigvalsh(scaled(matrix))
        if eigenvalues[0] < -INDEFINITENESS * max(float(np.abs(eigenvalues).max(initial=0.0)), 1e-300):
            expected = f"no negative eigenvalue; with a diagonal of ones the least one is {eigenvalues[0]:.4g}"
            yield Finding(_part(name), "", None, expected)
        elif name != "damping" and not np.abs(matrix).max() > 0.0:
            yield Finding(_part(name), "", None, "numbers other than zero")
