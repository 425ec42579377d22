"""A mesh's bias and the race of many starts, on systems whose answers are known in closed form."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from gearwhine.housing import HousingError
from gearwhine.housing.updating import (
    Effort,
    MeshBias,
    Meshes,
    ModalState,
    MultistartResult,
    Parameter,
    Surrogate,
    Target,
    multistart_search,
    search,
    serial_map,
)
from gearwhine.housing.updating.mesh_bias import Debiased, debiased
from gearwhine.housing.updating.sensitivities import ModalSensitivities
from gearwhine.housing.updating.trust_region import Design
from gearwhine.numerics.arrays import FloatArray

OWN = np.array([100.0, 130.0, 170.0, 230.0])
N = len(OWN)
MOTIONS = np.random.default_rng(2).normal(size=(N, 9))
FREE = [Parameter(name, 0.05, 20.0, 1.0, 1.0) for name in "abcd"]


@dataclass(frozen=True)
class Oscillators:
    """Springs e^z on unit masses, ω_i = ω0_i exp(½ z_i), coupled a little by a fifth spring, on a coarse mesh."""

    coordinates: FloatArray

    @property
    def stiffness(self) -> FloatArray:
        return np.diag(OWN**2 * np.exp(self.coordinates)) + 300.0 * np.ones((N, N))

    @property
    def _solved(self) -> tuple[FloatArray, FloatArray]:
        values, vectors = np.linalg.eigh(self.stiffness)
        return np.sqrt(values), vectors

    @property
    def state(self) -> ModalState:
        frequencies, vectors = self._solved
        return state_of(frequencies, vectors)

    def surrogate(self) -> Surrogate:
        frequencies, vectors = self._solved
        own = OWN**2 * np.exp(self.coordinates)
        rates = np.einsum("ka,k,kb->kab", vectors, own, vectors)
        return Surrogate.about(
            self.coordinates, state_of(frequencies, vectors), ModalSensitivities(rates, np.zeros((N, N, N)))
        )


def state_of(frequencies: FloatArray, vectors: FloatArray) -> ModalState:
    motions = vectors.T @ MOTIONS
    return ModalState(frequencies, motions[:, :4].reshape(N, 2, 2), motions[:, 4:])


def coarse(coordinates: FloatArray, near: Design | None) -> Oscillators:
    return Oscillators(coordinates)


SOFTER = np.array([0.97, 0.9, 0.94, 0.88])  # how much softer a finer mesh has the springs, each its own part


def fine(coordinates: FloatArray) -> ModalState:
    return Finer(coordinates).state


def bias_at(coordinates: FloatArray) -> MeshBias:
    return MeshBias.between(Oscillators(coordinates).state, fine(coordinates))


def finely(coordinates: FloatArray, near: Design | None) -> "Finer":
    return Finer(coordinates)


@dataclass(frozen=True)
class Finer(Oscillators):
    """The same on the fine mesh."""

    @property
    def stiffness(self) -> FloatArray:
        scale = np.sqrt(SOFTER)
        return np.asarray(scale[:, None] * super().stiffness * scale)

    def surrogate(self) -> Surrogate:
        _, vectors = self._solved
        own = SOFTER * OWN**2 * np.exp(self.coordinates)
        rates = np.einsum("ka,k,kb->kab", vectors, own, vectors)
        return Surrogate.about(self.coordinates, self.state, ModalSensitivities(rates, np.zeros((N, N, N))))


def test_where_the_bias_was_learned_the_fine_frequencies_come_out() -> None:
    z = np.array([0.2, -0.1, 0.3, 0.0])
    assert Debiased(Oscillators(z), bias_at(z)).state.frequencies == pytest.approx(fine(z).frequencies, rel=1e-3)
    assert Debiased(Oscillators(z), None).state.frequencies == pytest.approx(Oscillators(z).state.frequencies)


def test_elsewhere_it_takes_off_most_of_the_mesh_even_where_modes_have_changed_places() -> None:
    bias = bias_at(np.zeros(N))
    z = np.array([0.9, 0.1, -0.7, 0.2])  # the first is above the second now, and the third below both
    plain, without = Oscillators(z), Debiased(Oscillators(z), bias)
    errors = np.abs(np.log(plain.state.frequencies / fine(z).frequencies))
    left = np.abs(np.log(without.state.frequencies / fine(z).frequencies))
    assert errors.max() > 0.04
    assert left.max() < 0.004


def test_the_surrogate_of_a_design_without_bias_goes_where_designs_without_bias_go() -> None:
    """Through the crossing of two modes: what is left is of the second order in the step."""
    bias = bias_at(np.zeros(N))
    begin, way = np.array([0.52, 0.0, 0.0, 0.1]), np.array([0.3, -0.2, 0.1, 0.2])
    surrogate, left = Debiased(Oscillators(begin), bias).surrogate(), []
    for step in (0.2, 0.1):
        there = begin + step * way
        truth = Debiased(Oscillators(there), bias).state.frequencies
        left.append(np.abs(np.log(surrogate.at(there).state.frequencies / truth)).max())
    assert left[0] < 2e-3
    assert left[1] < 0.35 * left[0]
    assert surrogate.at(begin).state.frequencies == pytest.approx(Debiased(Oscillators(begin), bias).state.frequencies)


def test_a_bias_leaves_the_number_of_rigid_modes() -> None:
    z = np.zeros(N)

    @dataclass(frozen=True)
    class Afloat(Oscillators):
        @property
        def state(self) -> ModalState:
            return replace(super().state, n_rigid=6)

    bias = MeshBias(np.linalg.pinv(MOTIONS), np.full(N, -0.02))
    state = Debiased(Afloat(z), bias).state
    assert state.frequencies == pytest.approx(Oscillators(z).state.frequencies * np.exp(-0.02))
    assert state.n_rigid == 6


def target_at(z: FloatArray) -> Target:
    return Target(fine(z).frequencies, np.full(N, 0.002), (1.0, 1e4))


def test_a_search_on_the_coarse_mesh_ends_where_the_fine_one_would() -> None:
    target = target_at(np.array([0.3, -0.2, 0.25, 0.1]))
    bias = bias_at(np.zeros(N))
    begin = Debiased(Oscillators(np.zeros(N)), bias)
    found = search(debiased(coarse, bias), target, FREE, begin, Effort(trust=0.2, solves=15, starts=4))
    missed = np.log(fine(found.design.coordinates).frequencies / target.frequencies)
    assert np.abs(missed).max() < 0.004
    blind = search(coarse, target, FREE, Oscillators(np.zeros(N)), Effort(trust=0.2, solves=15, starts=4))
    assert np.abs(np.log(fine(blind.design.coordinates).frequencies / target.frequencies)).max() > 0.02


def run_race(target: Target, count: int, each: Any = serial_map, solves: int = 8, seed: int = 1) -> MultistartResult:
    begin = np.zeros(N)
    effort = Effort(solves=solves, starts=4, seed=seed)
    return multistart_search(Meshes(coarse, finely), target, FREE, Oscillators(begin), fine(begin), effort, count, each)


def test_a_race_ends_with_what_the_fine_mesh_calls_met_and_says_so() -> None:
    secret = np.array([0.5, -0.4, 0.45, 0.2])
    said: list[str] = []
    begin = np.zeros(N)
    target = target_at(secret)
    raced = multistart_search(
        Meshes(coarse, finely),
        target,
        FREE,
        Oscillators(begin),
        fine(begin),
        Effort(solves=60, starts=5),
        4,
        progress=said.append,
    )
    assert raced.is_met
    assert np.abs(np.log(fine(raced.coordinates).frequencies / target.frequencies)).max() < 2 * 0.002
    assert raced.misfit.errors == pytest.approx(np.log(fine(raced.coordinates).frequencies / target.frequencies))
    assert "all that is asked for" in said[-1]
    assert any(np.array_equal(raced.coordinates, point) for point in raced.seen)


@pytest.mark.slow
def test_how_the_work_is_shared_out_changes_nothing() -> None:
    """Tasks done in another order, each anew, give the same to the last bit."""

    def backwards(work: Callable[[Any], Any], tasks: Sequence[Any]) -> list[Any]:
        return [work(task) for task in reversed(tasks)][::-1]

    target = target_at(np.array([1.2, -0.9, 1.0, -1.3]))
    one, other = run_race(target, 3), run_race(target, 3, backwards)
    assert np.array_equal(one.coordinates, other.coordinates)
    assert one.misfit.value == other.misfit.value
    assert [step.found for step in one.steps] == [step.found for step in other.steps]
    assert [step.found for step in one.steps] != [step.found for step in run_race(target, 3, seed=2).steps]


@pytest.mark.slow
def test_no_design_of_the_fine_mesh_is_solved_twice() -> None:
    """A heat begins with the designs that the last one ended with, and the race hands out the best."""
    solved: list[tuple[float, ...]] = []

    def noted(coordinates: FloatArray, near: Design | None) -> Finer:
        solved.append(tuple(coordinates))
        return Finer(coordinates)

    # So narrow that no heat meets it.
    target = replace(target_at(np.array([1.2, -0.9, 1.0, -1.3])), noise=np.full(N, 1e-12))
    begin = np.zeros(N)
    raced = multistart_search(
        Meshes(coarse, noted), target, FREE, Oscillators(begin), fine(begin), Effort(solves=12), 3
    )
    assert len(solved) > 4
    assert len(set(solved)) == len(solved)
    assert raced.design is not None
    assert np.array_equal(raced.design.coordinates, raced.coordinates)
    assert raced.misfit.errors == pytest.approx(np.log(raced.design.state.frequencies / target.frequencies))


@pytest.mark.slow
def test_a_race_outlives_starts_that_are_no_housing() -> None:
    def fragile(coordinates: FloatArray, near: Design | None) -> Oscillators:
        if coordinates[0] < -0.2:
            raise HousingError("walls meet")
        return Oscillators(coordinates)

    begin = np.zeros(N)
    target = target_at(np.array([0.5, -0.4, 0.45, 0.2]))
    raced = multistart_search(
        Meshes(fragile, finely), target, FREE, Oscillators(begin), fine(begin), Effort(solves=60, starts=5), 4
    )
    assert raced.is_met


@dataclass(frozen=True)
class TwoBasins:
    """One parameter, one mode: ln ω² goes with z, but from z > 0.5 on the mode has another shape, and none between."""

    coordinates: FloatArray

    def surrogate(self) -> Surrogate:
        (z,) = self.coordinates
        shape = np.array([[1.0, 0.0]]) if z < 0.5 else np.array([[0.0, 1.0]])
        state = ModalState(np.array([100.0 * np.exp(0.5 * z)]), np.ones((1, 1, 2)), np.ones((1, 1)), shape)
        return Surrogate(self.coordinates, state, np.ones((1, 1, 1)), np.zeros((1, 1, 1)))

    @property
    def state(self) -> ModalState:
        return self.surrogate().at(self.coordinates).state


def test_a_race_finds_a_basin_that_no_step_leads_to() -> None:
    """The measured shape is that of the far side; near the start nothing is better than the start itself."""

    def either(coordinates: FloatArray, near: Design | None) -> TwoBasins:
        return TwoBasins(coordinates)

    measured = np.array([100.0 * np.exp(0.5)])
    target = Target(measured, np.array([0.05]), (1.0, 1e4), shapes=np.array([[0.0, 1.0]]))
    begin, effort = either(np.array([-3.0]), None), Effort(solves=60)
    alone = multistart_search(Meshes(either, None), target, FREE[:1], begin, None, replace(effort, solves=6), 1)
    several = multistart_search(Meshes(either, None), target, FREE[:1], begin, None, effort, 4)
    assert alone.misfit.mac is not None
    assert alone.misfit.mac[0] == 0.0
    assert several.misfit.mac is not None
    assert several.misfit.mac[0] == pytest.approx(1.0)
    assert several.coordinates[0] == pytest.approx(1.0, abs=0.1)
