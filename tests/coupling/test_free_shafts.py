"""A shaft in the machine without its bearings: motions of it as a whole, soft bending, and axial forces."""

import numpy as np
import pytest
from numpy.typing import NDArray

from gearwhine.coupling import Machine, MountedBearing, Shaft
from gearwhine.rotors import Bearing, Coupling, Disc, Rotor, Segment, ShaftMaterial, solve_whirl

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
RIGID = ShaftMaterial(1e16, 4e15, 7810.0)
LENGTH, DIAMETER, RADIAL = 0.6, 0.05, 2e6


def resting(rotor: Rotor, bearings: list[Bearing], speed: float = 300.0, damping_ratio: float = 0.0) -> Machine:
    """One shaft on its bearings, without a housing."""
    mounted = [MountedBearing(bearing, rotor.name, None) for bearing in bearings]
    return Machine([Shaft(rotor, damping_ratio=damping_ratio)], mounted, speed=speed)


def lateral_eigenvalues(machine: Machine, count: int) -> NDArray[np.complex128]:
    """Lowest eigenvalues of bending above the real axis."""
    modes = machine.modes()
    keep = np.array([kind == "rotor" for kind in modes.kinds]) & (modes.eigenvalues.imag > 1.0)
    return np.asarray(modes.eigenvalues[keep][:count])


@pytest.mark.parametrize("force", [-1e5, -3e4, 5e4])
@pytest.mark.parametrize("coupled", [False, True], ids=["one shaft", "with a coupling"])
def test_shaft_under_axial_force_whirls_in_the_machine_as_it_does_alone(force: float, coupled: bool) -> None:
    """Supports within the ends too, where the force enters beyond them."""
    segments: list[Segment | Coupling] = [Segment(LENGTH, 0.03, 0.0, STEEL, axial_force=force)]
    if coupled:
        # As stiff as half the shaft, to whose tilt under the force it adds its length.
        coupling = Coupling(0.3, 1.5e8, 3e4, 3e4, 1e8, axial_force=force)
        segments = [Segment(at, 0.03, 0.0, STEEL, axial_force=force) for at in (0.2, 0.1)]
        segments.insert(1, coupling)
    rotor = Rotor("shaft", segments, [Disc(0.2, 8.0, 0.05, 0.03)])
    for left, right in ((0.0, LENGTH), (0.05, 0.5)):
        bearings = [
            Bearing("left", left, np.diag([1e7, 1e7]), np.diag([50.0, 50.0])),
            Bearing("right", right, np.diag([RADIAL, RADIAL]), np.diag([50.0, 50.0])),
        ]
        exact = solve_whirl(rotor, bearings, 300.0, count=4).eigenvalues
        found = lateral_eigenvalues(resting(rotor, bearings), 4)
        assert np.abs(found - exact).max() < 1e-6 * np.abs(exact).max()


@pytest.mark.parametrize("force", [-4e5, 0.0, 3e5])
def test_rigid_shaft_tilts_against_its_bearings_and_its_axial_force_without_damping_of_its_own(force: float) -> None:
    """By hand: 2 k of the shift over the mass, and k L² / 2 + P L of the tilt over the moment of inertia.

    A third of the shaft, in its middle, is a coupling without mass that is as rigid.
    """
    third = Segment(LENGTH / 3.0, DIAMETER, 0.0, RIGID, axial_force=force)
    link = Coupling(LENGTH / 3.0, 1e13, 1e11, 1e11, 1e13, axial_force=force)
    rotor = Rotor("rod", [third, link, third])
    bearings = [Bearing.isotropic(f"at {at}", at, RADIAL) for at in (0.0, LENGTH)]
    machine = resting(rotor, bearings, speed=0.01, damping_ratio=0.05)
    inertia = rotor.mass * (LENGTH**2 * 13.0 / 108.0 + DIAMETER**2 / 16.0)
    shift, tilt = 2.0 * RADIAL / rotor.mass, (0.5 * RADIAL * LENGTH**2 + force * LENGTH) / inertia
    found = lateral_eigenvalues(machine, 4)
    assert found.imag == pytest.approx(np.sqrt(np.repeat(np.sort([shift, tilt]), 2)), rel=1e-5)
    assert np.abs(found.real).max() < 1e-6 * np.sqrt(shift)
    own = machine.assembled.rotors[0].stiffness
    m = machine.assembled.rotors[0].modal.lateral.count
    assert np.count_nonzero(own[0]) == np.count_nonzero(own[m]) == 0
    assert [own[1, 1], own[m + 1, m + 1]] == pytest.approx([force * LENGTH / inertia] * 2, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize(("tilt", "lateral"), [(50.0, 1e5), (5.0, 1e3)])
def test_soft_coupling_stays_soft_beside_two_ports_at_almost_one_place(tilt: float, lateral: float) -> None:
    """The attachment mode of a port 0.2 mm from a bearing has 1e9 times the stiffness of the coupling's bending."""
    coupling = Coupling(0.05, lateral, tilt, torsional_stiffness=5e4, axial_stiffness=1e6)
    shafts = [Segment(0.5, 0.06, 0.0, STEEL), coupling, Segment(0.3, 0.03, 0.0, STEEL)]
    rotor = Rotor("two shafts", shafts, [Disc(0.25, 40.0, 0.5, 0.4)])
    bearings = [Bearing(f"at {at}", at, np.diag([2e8] * 2), np.diag([100.0] * 2)) for at in (0.05, 0.6, 0.8)]
    exact = solve_whirl(rotor, bearings, 10.0, count=4).eigenvalues
    beside = Bearing("beside", 0.6002, np.zeros((2, 2)), np.diag([1e-3] * 2))
    found = lateral_eigenvalues(resting(rotor, [*bearings, beside], speed=10.0), 4)
    assert np.abs(found) == pytest.approx(np.abs(exact), rel=1e-5)


def test_shaft_damping_acts_on_bending_under_tension_as_without_it() -> None:
    """A free bar's first bending has the damping ratio asked for, under a thousandth of Euler's load in tension too."""
    ratio, euler = 0.03, np.pi**2 * STEEL.youngs_modulus * np.pi * DIAMETER**4 / 64.0 / LENGTH**2
    for force in (0.0, 1e-3 * euler):
        rotor = Rotor("bar", [Segment(LENGTH, DIAMETER, 0.0, STEEL, axial_force=force)])
        bearings = [Bearing.isotropic(f"at {at}", at, 1.0) for at in (0.1, 0.5)]
        found = lateral_eigenvalues(resting(rotor, bearings, speed=0.01, damping_ratio=ratio), 6)
        bending = found[np.abs(found) > 1e3][0]
        assert -bending.real / abs(bending) == pytest.approx(ratio, rel=1e-3)
