"""Pieces that run together between the unknowns of whirl's equations, and what a solver holds from speed to speed."""

from dataclasses import replace

import numpy as np
import pytest

from gearwhine.rotors import (
    Bearing,
    Disc,
    Rotor,
    RotorError,
    Segment,
    ShaftMaterial,
    WhirlSolver,
    campbell,
    solve_whirl,
)
from gearwhine.rotors.model.shaft import MassModel
from gearwhine.rotors.whirl.circular_coordinates import coupled_motions
from gearwhine.rotors.whirl.eigenvalues import constant_speed, refine_roots
from gearwhine.rotors.whirl.equations import MOST_GROWTH, WhirlEquations, whirl_equations, whirl_reach
from gearwhine.rotors.whirl.motion import ShaftMotion
from gearwhine.rotors.whirl.whirl_modes import MOST_HELD

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
DISC = Disc.from_dimensions(0.5, 0.07, 0.28, 0.05, 7810.0)
SPEED, LIMIT = 400.0, 3000.0
SIDEWAYS = np.diag([2e6, 1e6])
# Along the axis too, and tied to the tilt, so that all three motions go together.
SPATIAL = np.diag([2e6, 1e6, 5e6, 3e3, 3e3])
SPATIAL[2, 4] = SPATIAL[4, 2] = 1e4
KINDS = {
    "one sense alone": (2e6 * np.eye(2), 300.0 * np.eye(2)),
    "both senses": (SIDEWAYS, np.diag([300.0, 200.0])),
    "along the axis too": (SPATIAL, 1e-4 * SPATIAL),
}


def stepped(parts: int, mass_model: MassModel = "distributed") -> Rotor:
    steps = 0.05 * (1.0 + 0.1 * np.sin(1.0 + 3.1 * np.arange(parts)))
    segments = [Segment(1.5 / parts, float(diameter), 0.0, STEEL) for diameter in steps]
    segments[3] = Segment(1.5 / parts, 0.05, 0.0, STEEL, right_outer_diameter=0.06)
    return Rotor("stepped", segments, [DISC], mass_model)


def bearings_of(kind: str, factor: float = 1.0) -> list[Bearing]:
    stiffness, damping = KINDS[kind]
    return [Bearing("left", 0.0, factor * stiffness, damping), Bearing("right", 1.2, factor * stiffness, damping)]


def motion_of(chain: WhirlEquations, starts: np.ndarray) -> ShaftMotion:
    speed = constant_speed(SPEED)
    roots = refine_roots(chain, starts, speed)
    return ShaftMotion.of(chain, roots.eigenvalues, speed(roots.eigenvalues), roots.solutions, roots.scales)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mass_model", ["distributed", "lumped"])
def test_runs_have_the_roots_and_shapes_of_their_pieces(kind: str, mass_model: MassModel) -> None:
    rotor, bearings = stepped(30, mass_model), bearings_of(kind)
    modes = solve_whirl(rotor, bearings, SPEED, frequency_limit=LIMIT)
    assert modes.eigenvalues.size >= 6
    for blocks in coupled_motions(bearings):
        whole = whirl_equations(rotor, bearings, blocks, whirl_reach(LIMIT, SPEED))
        runs = whole.in_runs()
        if mass_model == "distributed":
            # Ends, the disc, the bearing, and a few between them.
            assert 4 <= runs.kept.size <= 8 < whole.kept.size
        own = modes.eigenvalues
        if len(blocks) == 1:
            own = own[modes.direction * blocks[0] > 0.5]
        separate, together = motion_of(whole, own), motion_of(runs, own)
        np.testing.assert_allclose(together.eigenvalues, separate.eigenvalues, rtol=1e-12)
        # At every node and between them, but for a factor.
        places = np.linspace(0.0, rotor.length, 101)
        for mode in range(separate.count):
            shapes = [
                np.concatenate([part[mode] for part in motion.evaluate(places)]) for motion in (separate, together)
            ]
            likeness = np.vdot(shapes[0], shapes[1]) / np.vdot(shapes[0], shapes[0])
            np.testing.assert_allclose(shapes[1], likeness * shapes[0], rtol=0.0, atol=1e-10 * np.abs(shapes[1]).max())


def test_motion_grows_no_more_along_a_run_than_it_may() -> None:
    rotor, bearings = stepped(30), bearings_of("both senses")
    runs = whirl_equations(rotor, bearings, (1, -1), 4e4).in_runs()
    growth = runs.bending.table.growth(4e4)[runs.bending.element]
    along = np.add.reduceat(growth, runs.kept[:-1])
    assert (along <= MOST_GROWTH).all()
    # As few runs as that: no two neighbours would do as one, but where a node needs its unknowns.
    assert runs.kept.size > 8
    # The bound is one: no wave of a uniform piece is shorter than it says.
    table = runs.bending.table
    eigenvalues = np.linalg.eigvals(table.transfer_matrices([4e4**2])[0, :, 0])
    uniform = ~table.coefficients[:, :, 1:].any(axis=(1, 2))
    fastest = np.abs(np.log(eigenvalues.astype(complex))).max(axis=1)
    assert (fastest[uniform] <= table.growth(4e4)[uniform] * (1.0 + 1e-12)).all()


def test_a_solver_that_solved_before_gives_the_digits_of_a_new_one() -> None:
    rotor, bearings = stepped(30), bearings_of("both senses")
    solver = WhirlSolver(rotor, bearings)
    before = solver.modes(SPEED, count=6).eigenvalues
    for speed, count in ((3.0 * SPEED, 12), (0.5 * SPEED, 4), (SPEED, 6)):
        held, fresh = solver.modes(speed, count=count), solve_whirl(rotor, bearings, speed, count=count)
        np.testing.assert_array_equal(held.eigenvalues, fresh.eigenvalues)
    np.testing.assert_array_equal(solver.modes(SPEED, count=6).eigenvalues, before)


def test_solvers_of_other_bearings_share_nothing() -> None:
    rotor = stepped(30)
    first, other = (WhirlSolver(rotor, bearings_of("both senses", factor)) for factor in (1.0, 2.0))
    before = first.modes(SPEED, count=6).eigenvalues
    assert np.abs(other.modes(SPEED, count=6).eigenvalues - before).max() > 1.0
    np.testing.assert_array_equal(first.modes(SPEED, count=6).eigenvalues, before)


def test_a_solver_of_tabled_bearings_holds_no_more_than_it_may() -> None:
    rotor, speeds = stepped(6), np.linspace(100.0, 500.0, 9)
    tables = [
        replace(bearing, stiffness=np.array([bearing.stiffness, 2.0 * bearing.stiffness]), speeds=speeds[[0, -1]])
        for bearing in bearings_of("both senses")
    ]
    solver = WhirlSolver(rotor, tables)
    for speed in (*speeds.tolist(), 100.0):
        constant = [bearing.at_speed(speed) for bearing in tables]
        expected = solve_whirl(rotor, constant, speed, count=4).eigenvalues
        np.testing.assert_allclose(solver.modes(speed, count=4).eigenvalues, expected, rtol=1e-10)
    assert len(solver._held) == MOST_HELD


def test_a_diagram_by_a_solver_is_that_of_its_rotor_and_bearings() -> None:
    rotor, bearings = stepped(6), bearings_of("both senses")
    solver, speeds = WhirlSolver(rotor, bearings), np.linspace(0.0, 400.0, 5)
    own = campbell(rotor, bearings, speeds, count=4)
    shared = campbell(rotor, bearings, speeds, count=4, solver=solver)
    np.testing.assert_array_equal(shared.eigenvalues, own.eigenvalues)
    with pytest.raises(RotorError, match="rotor of the solver is 'stepped'"):
        campbell(rotor, bearings_of("both senses", 2.0), speeds, count=4, solver=solver)
