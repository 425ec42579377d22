"""Damped, gyroscopic whirl of a rotor on any bearings by the finite elements of high degree: both planes, axial motion.

    M ü + (C + Ω G) u̇ + K u = 0,    u = (x and β of one plane, of the other, z, pedestals)

The section's slope in x is its rotation about y, that in y is minus its rotation about x; G couples the slopes so that
a slope rate in y acts on that of x with +2ρI Ω. Forward whirl is counter-clockwise, x leading y by a quarter turn.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from finite_element_rotor import PlaneModel, bending_model, condensed, rod_model
from scipy import linalg

from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.rotors import Bearing, Rotor


@dataclass(frozen=True)
class SpatialMatrices:
    """Matrices of the whole, each (u, u), symmetric but for bearings; ``gyroscopic`` is G per rad/s."""

    mass: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    gyroscopic: FloatArray

    def eigenvalues(self, speed: float) -> ComplexArray:
        """Eigenvalues λ with positive imaginary part at a speed, by ascending |λ|, rad/s.

        The rotor must be held: the symmetric part of K positive definite.
        """
        # Modes of the symmetric part, of unit stiffness, make K about one and M a falling diagonal. Then 1/λ are
        # eigenvalues of a matrix that is largest where λ is least, so that the low ones keep their digits.
        symmetric = 0.5 * (self.stiffness + self.stiffness.T)
        scale = 1.0 / np.sqrt(np.diag(symmetric))
        balance = np.outer(scale, scale)
        squared_periods, shapes = linalg.eigh(balance * self.mass, balance * symmetric)
        shapes = scale[:, None] * shapes
        stiffness = shapes.T @ self.stiffness @ shapes
        damping = shapes.T @ (self.damping + speed * self.gyroscopic) @ shapes
        root = np.diag(np.sqrt(np.maximum(squared_periods, 0.0)))
        system = np.block([[-np.linalg.solve(stiffness, np.hstack([damping, root]))], [root, np.zeros_like(root)]])
        periods = linalg.eigvals(system)
        values = 1.0 / periods[np.abs(periods) > 1e-12 * np.abs(periods).max()]
        values = values[values.imag > 1e-9 * np.abs(values)]
        return np.asarray(values[np.argsort(np.abs(values))])


def spatial_matrices(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    highest: float,
    *,
    axial: bool = False,
    two_node: bool = False,
) -> SpatialMatrices:
    """Matrices of a rotor on bearings of constant coefficients, converged up to ``highest`` rad/s.

    Axial motion is left out where ``axial`` is false, as if held. With ``two_node`` the elements are those of
    `finite_element_rotor.condensed`, which a low ``highest`` leaves one to a span.
    """
    places = [bearing.at for bearing in bearings]
    plane = bending_model(rotor, [], highest, places=places)
    rod = rod_model(rotor, "axial", highest, springs=[(at, 0.0) for at in places])
    if two_node:
        plane, rod = condensed(plane), condensed(rod)
    blocks = [plane, plane, rod] if axial else [plane, plane]
    pedestals = [bearing for bearing in bearings if bearing.pedestal is not None]
    n = plane.held.size
    total = sum(block.held.size for block in blocks) + 2 * len(pedestals)
    mass, stiffness, damping, gyroscopic = (np.zeros((total, total)) for _ in range(4))
    start = 0
    for block in blocks:
        own = slice(start, start + block.held.size)
        mass[own, own], stiffness[own, own] = block.assembled("mass"), block.assembled("stiffness")
        start = own.stop
    gyroscopic[:n, n : 2 * n] = plane.assembled("polar")
    gyroscopic[n : 2 * n, :n] = -gyroscopic[:n, n : 2 * n]
    for bearing in bearings:
        motion = _motion(plane, rod if axial else None, bearing.at, total)
        if bearing.pedestal is not None:
            foot = np.zeros((2, total))
            foot[[0, 1], [start, start + 1]] = 1.0
            motion[:2] -= foot
            mass += bearing.pedestal.mass * foot.T @ foot
            stiffness += foot.T @ bearing.pedestal.stiffness @ foot
            damping += foot.T @ bearing.pedestal.damping @ foot
            start += 2
        stiffness += motion.T @ bearing.spatial_stiffness @ motion
        damping += motion.T @ bearing.spatial_damping @ motion
    return SpatialMatrices(mass, stiffness, damping, gyroscopic)


def _motion(plane: PlaneModel, rod: PlaneModel | None, at: float, total: int) -> FloatArray:
    """x, y, z, rotation about x and about y at a place, of the unknowns, (5, total)."""
    motion, n, node = np.zeros((5, total)), plane.held.size, plane.elements.node(at)
    motion[0, 2 * node] = motion[4, 2 * node + 1] = 1.0
    motion[1, n + 2 * node] = 1.0
    motion[3, n + 2 * node + 1] = -1.0
    if rod is not None:
        motion[2, 2 * n + rod.elements.node(at)] = 1.0
    return motion
