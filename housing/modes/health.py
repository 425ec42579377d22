"""Health report: checks of a solved housing, like those delivered with a Craig-Bampton model.

Each line holds a figure, its bound, and its source. A line is essential where a figure beyond its bound makes results
wrong: :meth:`HealthReport.require` raises for it. The others are for the engineer to judge, such as a housing whose
supports leave it free to move.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwhine.housing.errors import HealthError
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.model.bushings import Mount
from gearwhine.housing.model.patches import RigidBody, rigid_body, rigid_motions
from gearwhine.housing.model.supports import Grounding, Support, grounding
from gearwhine.housing.modes.certificate import OVERLAP_BOUND, RESIDUAL_BOUND
from gearwhine.housing.modes.natural_modes import ModeSet
from gearwhine.housing.modes.residual_modes import STATIC_BOUND
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray

MASS_BOUND = 1e-6  # error of mass, and of the centre over the diagonal: curved elements are not integrated exactly
REGULAR_BOUND = 1e-9
STRAIN_BOUND = 1e-10  # rounding of K R is about 1e-14
SYMMETRY_BOUND = 1e-12
DISCRETISATION_BOUND = 0.03
"""Estimated relative error of a frequency above which the mesh is too coarse for it."""


@dataclass(frozen=True)
class HealthLine:
    """One check.

    Attributes
    ----------
    name : str
    value : float
    bound : float or None
        Largest permitted value; None where the value is for information only.
    why : str
        Comparison made, or meaning of the value.
    essential : bool
        Whether a value beyond its bound makes the results wrong.
    """

    name: str
    value: float
    bound: float | None
    why: str
    essential: bool = True

    @property
    def ok(self) -> bool:
        """Whether the value keeps its bound; a value that is not a number does not."""
        return self.bound is None or bool(self.value <= self.bound)


@dataclass(frozen=True)
class HealthReport:
    """All checks of a housing.

    Attributes
    ----------
    lines : tuple of HealthLine
    body : RigidBody
        Mass, centre of gravity and inertia from the mass matrix.
    grounding : Grounding
        Rigid motions left free by the supports.
    """

    lines: tuple[HealthLine, ...]
    body: RigidBody
    grounding: Grounding

    @property
    def ok(self) -> bool:
        """Whether every line keeps its bound."""
        return all(line.ok for line in self.lines)

    def with_discretisation(self, modes: ModeSet) -> "HealthReport":
        """Add the check of the modes' errors by the mesh, where these are estimated."""
        errors = modes.discretisation_errors
        if errors is None:
            return self
        worst = int(np.argmax(errors))
        why = f"estimate of a frequency's relative error by the mesh, the largest: mode {worst + 1}"
        line = HealthLine("discretisation", float(errors[worst]), DISCRETISATION_BOUND, why, essential=False)
        return replace(self, lines=(*self.lines, line))

    def require(self) -> None:
        """Raise where a check fails that makes results wrong.

        Raises
        ------
        HealthError
            Where an essential line breaks its bound; all of them are named.
        """
        wrong = [line for line in self.lines if line.essential and not line.ok]
        if wrong:
            said = "; ".join(f"{line.name} {line.value:.2g}, bound {line.bound:.2g} ({line.why})" for line in wrong)
            raise HealthError(f"the housing's model fails its own checks: {said}")


def health_report(
    mesh: Mesh,
    unsupported: Matrices,
    supported: Matrices,
    supports: Sequence[Support | Mount],
    modes: ModeSet,
    *,
    mass: float,
    center: FloatArray | None = None,
) -> HealthReport:
    """Check a solved housing from its geometry to its modes.

    Parameters
    ----------
    mesh : Mesh
    unsupported, supported : Matrices
        The bare solid, and the same with all that is fastened to it.
    supports : sequence of Support or Mount
        The fixtures that connect to the ground.
    modes : ModeSet
        Modes of ``supported``, with or without residual modes.
    mass : float
        Mass by geometry: Σ density x volume, with lumped masses [kg].
    center : ndarray, shape (3,), optional
        Centre of gravity by geometry, where it is known [m].
    """
    body = rigid_body(mesh.points, supported)
    ground = grounding(mesh, supports, body.center)
    lines = [
        *_mass_lines(mesh, body, mass, center, supported),
        *_matrix_lines(mesh, unsupported, supported, body),
        *_grounding_lines(ground, modes),
        *_mode_lines(supported, modes),
        *_port_lines(modes),
    ]
    return HealthReport(tuple(lines), body, ground).with_discretisation(modes)


def _mass_lines(
    mesh: Mesh, body: RigidBody, mass: float, center: FloatArray | None, matrices: Matrices
) -> list[HealthLine]:
    # A rigid body's M₆ has three equal masses and nothing between translations and rotations about its centre; what
    # is there beside is measured by the mass, with rotations at the radius of gyration.
    gyration = float(np.sqrt(np.trace(body.inertia) / body.mass))
    fields = rigid_motions(mesh.points, body.center).reshape(-1, 6) / np.array([1.0] * 3 + [gyration] * 3)
    foreign = fields.T @ (matrices.mass_operator @ fields) / body.mass
    foreign[:3, :3] -= np.eye(3)
    foreign[3:, 3:] = 0.0
    lines = [
        HealthLine(
            "mass",
            abs(body.mass - mass) / mass,
            MASS_BOUND,
            f"{body.mass:.6g} kg from the matrices, {mass:.6g} kg from the geometry",
        ),
        HealthLine(
            "rigid-body mass",
            float(np.abs(foreign).max()),
            REGULAR_BOUND,
            "entries of the mass matrix, moved rigidly, that no rigid body has",
        ),
    ]
    if center is not None:
        size = float(np.linalg.norm(mesh.bounds[1] - mesh.bounds[0]))
        x, y, z = 1e3 * body.center
        lines.append(
            HealthLine(
                "centre of gravity",
                float(np.linalg.norm(body.center - center)) / size,
                MASS_BOUND,
                f"({x:z.3f}, {y:z.3f}, {z:z.3f}) mm from the matrices, against the geometry's",
            )
        )
    return lines


def _matrix_lines(mesh: Mesh, unsupported: Matrices, supported: Matrices, body: RigidBody) -> list[HealthLine]:
    fields = rigid_motions(mesh.points, body.center).reshape(-1, 6)
    # Each entry of K R is a sum that cancels; its scale is the sum of the terms' absolute values.
    terms = unsupported.absolute_stiffness_operator @ np.abs(fields)
    strained = np.linalg.norm(unsupported.stiffness_operator @ fields, axis=0) / np.linalg.norm(terms, axis=0)
    asymmetry = _asymmetry(supported)
    return [
        HealthLine(
            "rigid-body strain", float(strained.max()), STRAIN_BOUND, "elastic forces when the unsupported body moves"
        ),
        HealthLine(
            "symmetry", asymmetry, SYMMETRY_BOUND, "|A x - Aᵀ x| of stiffness and mass, relative, for a random x"
        ),
    ]


def _grounding_lines(ground: Grounding, modes: ModeSet) -> list[HealthLine]:
    expected, zeros = ground.free_motions, int(np.count_nonzero(modes.frequencies == 0.0))
    # Rigid modes are all below any limit, but a search by number may have asked for fewer.
    expected_found = min(expected, len(modes.frequencies))
    excess = zeros - expected_found
    loose = ": are its parts joined?" if excess > 0 else ""
    lines = [
        HealthLine(
            "rigid modes",
            float(abs(excess)),
            0.0,
            f"{zeros} found, {expected_found} expected of these supports{loose}",
            essential=excess < 0,
        )
    ]
    if ground.supports:
        names = ", ".join(ground.free_directions)
        why = "all six motions of the body are held" if not expected else f"the housing can still move: {names}"
        lines.append(HealthLine("grounding", float(expected), 0.0, why, essential=False))
    return lines


def _mode_lines(supported: Matrices, modes: ModeSet) -> list[HealthLine]:
    certificate = modes.certificate
    attached = modes.residual_modes
    shapes = modes.shapes.reshape(len(modes.shapes), -1)
    omega = modes.frequencies
    if attached is not None:
        shapes = np.vstack([shapes, attached.shapes.reshape(len(attached.shapes), shapes.shape[1])])
        omega = np.concatenate([omega, attached.frequencies])
    overlap = np.abs(shapes @ (supported.mass_operator @ shapes.T) - np.eye(len(omega)))
    scale = np.sqrt(omega**2 + certificate.limit**2)
    energy = np.abs(shapes @ (supported.stiffness_operator @ shapes.T) - np.diag(omega**2)) / np.outer(scale, scale)
    return [
        HealthLine(
            "certificate",
            float(abs(certificate.expected - certificate.found)),
            0.0,
            f"{certificate.found} modes found, the inertia demands {certificate.expected}",
        ),
        HealthLine("residual of the modes", certificate.max_residual, RESIDUAL_BOUND, "|K φ - λ M φ|, relative"),
        HealthLine("orthogonality in mass", float(overlap.max()), OVERLAP_BOUND, "|φᵀ M φ - I|, attachments included"),
        HealthLine(
            "orthogonality in stiffness",
            float(energy.max()),
            OVERLAP_BOUND,
            "|φᵀ K φ - diag ω²| over ω² + limit², attachments included",
        ),
    ]


def _port_lines(modes: ModeSet) -> list[HealthLine]:
    if modes.residual_modes is None:
        return []
    proof = modes.residual_modes.proof
    without = float(proof.missing_parts.max(initial=0.0))
    return [
        HealthLine("static error, modes alone", without, None, "compliance at the ports that the modes lack"),
        HealthLine(
            "static error, with attachments", proof.error, STATIC_BOUND, "bound from what the loads leave unbalanced"
        ),
    ]


def _asymmetry(matrices: Matrices) -> float:
    """Return the larger |A x - Aᵀ x| / |A x| of stiffness and mass for a random x.

    Only blocks on the diagonal have a part in the difference: each of the others stands for both triangles.
    """
    probe = np.random.default_rng(0).standard_normal(3 * matrices.n_nodes)
    blocks = matrices.blocks[matrices.pointer[:-1]]
    twisted = np.einsum("nij,nj->ni", blocks - blocks.transpose(0, 2, 1), probe.reshape(-1, 3))
    attached = matrices.attached_mass.matrix(matrices.n_nodes)
    pairs = (
        (twisted.ravel(), matrices.stiffness_operator),
        (attached @ probe - attached.T @ probe, matrices.mass_operator),
    )
    return max(float(np.linalg.norm(apart) / np.linalg.norm(matrix @ probe)) for apart, matrix in pairs)
