"""The march in blocks: they add up to the whole, and it goes on from any checkpoint to the same bits."""

import io
from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.coupling import (
    CoupledSystem,
    CouplingError,
    SpeedProfile,
    TransientError,
    TransientOutputs,
    TransientSettings,
    simulate,
)
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector, LinearConnector
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.time.integration import Checkpoint
from gearwhine.coupling.time.transient import ENERGY_BOUND, integrate_blocks, integration_key, transient_figures

BLOCK = 64
RECORD = ("times", "displacement", "velocity", "acceleration", "compression", "force")


def machine() -> CoupledSystem:
    """Two masses pressed together, on springs, with loads that turn: meshes whose periods have no common multiple."""
    zeros = np.zeros((2, 2))
    body = Component("masses", ("torsion", "torsion"), np.diag([0.2, 0.1]), 0.02 * np.eye(2), zeros)
    contact = ToothContact(1.6, piecewise.quadratic(0.8, 1.2, 0.8, 1.6), piecewise.constant(0.0, 1.6), 0.01)
    first = ContactConnector("first", np.array([1.0, -1.0]), contact, 0.0, 0.17, np.zeros((0, 3)))
    second = replace(first, name="second", mesh_frequency=0.17 * np.sqrt(2.0))
    tie = LinearConnector("tie", np.array([[1.0], [0.5]]), np.array([[0.3]]), np.array([[0.01]]))
    return CoupledSystem(
        (body,),
        (0.0,),
        linear=(tie,),
        contacts=(first, second),
        load=np.array([1.0, -1.0]),
        harmonic_loads=(HarmonicLoad(0.5, np.array([0.1 + 0.0j, 0.0j])),),
    )


SYSTEM = machine()
ROWS = TransientOutputs(np.eye(2), np.eye(2), np.eye(2))
SETTINGS = TransientSettings(duration=60.0, record_from=10.0, sample_interval=0.1, largest_step=0.1, tolerance=1e-4)
RUN_UP = SpeedProfile(np.array([0.0, 60.0]), np.array([0.5, 1.5]))


def on_file(checkpoint: Checkpoint) -> Checkpoint:
    """What comes back of a checkpoint that was written."""
    file = io.BytesIO()
    np.savez(file, **checkpoint.as_arrays())
    file.seek(0)
    return Checkpoint.from_arrays(np.load(file))


@pytest.mark.parametrize("speed_profile", [None, RUN_UP])
def test_a_march_goes_on_from_every_checkpoint_to_the_same_bits(speed_profile: SpeedProfile | None) -> None:
    blocks = list(integrate_blocks(SYSTEM, SETTINGS, ROWS, speed_profile=speed_profile, samples_per_block=BLOCK))
    assert len(blocks) == blocks[0].count > 5
    assert sum(len(block.force) for block in blocks) == SETTINGS.samples
    for number in range(len(blocks) - 1):
        after = on_file(blocks[number].after)
        rest = integrate_blocks(
            SYSTEM, SETTINGS, ROWS, speed_profile=speed_profile, samples_per_block=BLOCK, after=after
        )
        for one, other in zip(blocks[number + 1 :], rest, strict=True):
            assert one.first == other.first
            assert all(getattr(one, name).tobytes() == getattr(other, name).tobytes() for name in RECORD)
            first, second = one.after.as_arrays(), other.after.as_arrays()
            assert all(first[name].tobytes() == second[name].tobytes() for name in first if name != "seconds")


def test_blocks_change_no_more_than_the_tolerance() -> None:
    """Where time is cut elsewhere the steps differ; finer steps bring both to the same motion."""
    fine = replace(SETTINGS, tolerance=1e-5)
    whole = simulate(SYSTEM, fine, ROWS)
    blocks = list(integrate_blocks(SYSTEM, fine, ROWS, samples_per_block=BLOCK))
    assert np.concatenate([block.times for block in blocks]) == pytest.approx(whole.times)
    together = np.concatenate([block.displacement for block in blocks])
    assert together == pytest.approx(whole.displacement, abs=1e-3 * np.abs(whole.displacement).max())


@pytest.mark.parametrize("record_from", [np.nextafter(18.0, 0.0), 18.0, np.nextafter(18.0, 20.0)])
def test_contact_figures_begin_with_the_record_where_a_block_does(record_from: float) -> None:
    """A block begins at 18 s, the tenth part of 60 s taken three times; rounding may put the record beside it."""
    settings = replace(SETTINGS, record_from=float(record_from))
    blocks = list(integrate_blocks(SYSTEM, settings, ROWS, samples_per_block=60))
    assert len(blocks) == 10
    figures = transient_figures(settings, blocks[-1].after)
    force = np.concatenate([block.force for block in blocks])
    assert figures.mean_force == pytest.approx(force.mean(axis=0), rel=5e-3)
    assert (figures.peak_force >= figures.mean_force).all()


@pytest.mark.parametrize("size", [1e6, -1e6, 1e-3])
def test_a_balance_may_miss_a_hundredth_of_the_rounding_of_what_is_stored(size: float) -> None:
    """Parts of 1e-10 of an energy that stays come and go by rounding; a part of 2e-10 of it is lost."""
    *_, last = integrate_blocks(SYSTEM, SETTINGS, ROWS, samples_per_block=60)
    still = replace(last.after, totals=np.zeros(5), highest=size, lowest=size, start_energy=size)
    assert transient_figures(SETTINGS, replace(still, energy=(1.0 + 0.9e-10) * size)).energy.error < 1e-2
    with pytest.raises(TransientError, match="the energies do not balance"):
        transient_figures(SETTINGS, replace(still, energy=(1.0 + 2e-10) * size))


def test_a_cache_that_forgets_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    before = simulate(SYSTEM, SETTINGS, ROWS)
    monkeypatch.setattr("gearwhine.coupling.time.step_matrices.StepCache._MOST_BYTES", 1)
    after = simulate(SYSTEM, SETTINGS, ROWS)
    assert all(getattr(before, name).tobytes() == getattr(after, name).tobytes() for name in RECORD)


def test_a_key_stands_for_the_very_march() -> None:
    def key(system=SYSTEM, settings=SETTINGS, rows=ROWS, speed_profile=None, block=BLOCK):  # type: ignore[no-untyped-def]
        return integration_key(system, settings, rows, speed_profile=speed_profile, samples_per_block=block)

    nudged = SYSTEM.load * (1.0 + np.finfo(float).eps)
    other_contact = replace(SYSTEM.contacts[0], phase=0.1)
    others = [
        key(system=replace(SYSTEM, load=nudged)),
        key(system=replace(SYSTEM, contacts=(other_contact, SYSTEM.contacts[1]))),
        key(settings=replace(SETTINGS, tolerance=2e-4)),
        key(settings=replace(SETTINGS, duration=61.0)),
        key(rows=replace(ROWS, velocity=2.0 * np.eye(2))),
        key(speed_profile=RUN_UP),
        key(block=2 * BLOCK),
    ]
    assert key() == key(system=machine())
    assert len({key(), *others}) == 1 + len(others)


def test_a_block_holds_something() -> None:
    with pytest.raises(CouplingError, match="blocks of 0 samples"):
        next(integrate_blocks(SYSTEM, SETTINGS, ROWS, samples_per_block=0))


def test_a_motion_that_misses_more_of_its_energy_than_the_bound_is_refused() -> None:
    """Of the greatest of the work, of what is lost and of the swing of the stored energy."""
    after = list(integrate_blocks(SYSTEM, SETTINGS, ROWS))[-1].after
    scale = max(np.abs(after.totals).max(), after.highest - after.lowest)
    for part, refused in ((0.5, False), (1.5, True)):
        missing = replace(after, energy=after.energy + part * ENERGY_BOUND * scale)
        with pytest.raises(TransientError, match=r"do not balance: 1\.5 % is missing") if refused else nullcontext():
            transient_figures(SETTINGS, missing)
