"""Transient simulation: time integration from static equilibrium, its record and its energy balance.

`simulate` returns the whole record. `integrate_blocks` yields it in blocks: the samples of each block, with the
checkpoint from which the next one continues. `fingerprint` is the digest of the inputs of a computation, equal only
where all of them are equal bit for bit. `Motion` holds the simulated motion of a machine as a labelled dataset.

The driver is in :mod:`gearwhine.coupling.time.integration`; its steppers are in
:mod:`gearwhine.coupling.time.newmark_stepper` and :mod:`gearwhine.coupling.time.exponential_collocation`.
"""

import hashlib
import struct
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.connector_forces.kernel_arrays import APART, IMPULSE, PEAK
from gearwhine.coupling.errors import CouplingError, TransientError
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.machine.driving_frequencies import driving_frequencies, frequencies_of_elements, varies_within
from gearwhine.coupling.machine.speed_profile import SpeedProfile
from gearwhine.coupling.signals.spectrum import Spectrum, amplitude_spectrum, whole_period_samples
from gearwhine.coupling.time.condensation import condensed, with_static_attachments
from gearwhine.coupling.time.exponential_collocation import CollocationStepper, exact_part
from gearwhine.coupling.time.histories import HISTORY_QUANTITIES, Histories
from gearwhine.coupling.time.integration import SAMPLES_PER_BLOCK, Checkpoint, Integration, sample_times
from gearwhine.coupling.time.newmark_stepper import NewmarkStepper
from gearwhine.coupling.time.settings import RECORDED, MotionRecord, TransientOutputs, TransientSettings
from gearwhine.coupling.time.step_matrices import empty_samples
from gearwhine.numerics.arrays import FloatArray

if TYPE_CHECKING:
    import xarray as xr


ENERGY_BOUND = 1e-2
_ENERGY_ROUNDING = 1e-8  # part of the stored energy of which rounding over many steps may be a hundredth


def fingerprint(*parts: object) -> str:
    """SHA-256, as hexadecimal digits, over numbers, texts, arrays, and tuples, mappings and dataclasses of these.

    Numbers and arrays count by their bytes, so that 0 and -0 differ; mappings whatever their order.

    Raises
    ------
    TypeError
        For objects of any other type, whose difference the digest would not show.
    """
    total = hashlib.sha256()
    _feed(total, parts)
    return total.hexdigest()


def _feed(total: "hashlib._Hash", part: object) -> None:
    if isinstance(part, np.generic):
        part = part.item()
    if isinstance(part, np.ndarray) and part.dtype.kind in "biufc":
        total.update(f"array {part.dtype.str} {part.shape}\0".encode())
        total.update(np.ascontiguousarray(part).tobytes())
    elif isinstance(part, bool | int | None):
        total.update(f"{part!r}\0".encode())
    elif isinstance(part, float):
        total.update(b"float" + struct.pack("<d", part))
    elif isinstance(part, str):
        total.update(f"text {len(part)} {part}\0".encode())
    elif isinstance(part, tuple | list):
        total.update(f"{len(part)} of\0".encode())
        for inner in part:
            _feed(total, inner)
    elif isinstance(part, Mapping):
        _feed(total, sorted(part.items()))
    elif is_dataclass(part) and not isinstance(part, type):
        _feed(total, [(field.name, getattr(part, field.name)) for field in fields(part)])
    else:
        raise TypeError(f"a {type(part).__name__} has no fingerprint")


@dataclass(frozen=True, eq=False)
class Block(MotionRecord):
    """A block of the record, and the checkpoint after it.

    Attributes
    ----------
    first : int
        Number of the block's first sample.
    after : Checkpoint
    count : int
        Number of blocks of the whole run.
    """

    first: int
    after: Checkpoint
    count: int


def integrate_blocks(
    system: CoupledSystem,
    settings: TransientSettings,
    outputs: TransientOutputs,
    *,
    speed_profile: SpeedProfile | None = None,
    initial: tuple[FloatArray, FloatArray] | None = None,
    after: Checkpoint | None = None,
    samples_per_block: int = SAMPLES_PER_BLOCK,
    progress: Callable[[float], None] = lambda fraction: None,
) -> Iterator[Block]:
    """Integrate the motion of the coupled system, and yield its record block by block.

    Parameters
    ----------
    after : Checkpoint, optional
        Checkpoint to continue from, of the same run; see :func:`integration_key`.
    samples_per_block : int
        Approximate length of a block. Time is cut where blocks end, so the last digits of a result depend on it.

    Other parameters and errors are those of :func:`gearwhine.coupling.simulate`.
    """
    run, initial = _prepared(system, settings, outputs, speed_profile, initial, samples_per_block)
    state = after or run.start(initial)
    total = settings.samples
    for number in range(state.block, len(run.ends) - 1):
        first = state.sample
        last = number == len(run.ends) - 2
        count = total - first if last else _samples_until(settings, float(run.ends[number + 1]), first, total)
        samples = empty_samples(run.arrays, settings.record_from, settings.sample_interval, first, count)
        state = run.through(number, state, samples, progress)
        written = slice(state.sample - first)
        yield Block(
            first=first,
            times=sample_times(settings, first, state.sample - first),
            **{name: getattr(samples, name)[written] for name in RECORDED[1:]},
            after=state,
            count=len(run.ends) - 1,
        )


def integration_key(
    system: CoupledSystem,
    settings: TransientSettings,
    outputs: TransientOutputs,
    *,
    speed_profile: SpeedProfile | None = None,
    initial: tuple[FloatArray, FloatArray] | None = None,
    samples_per_block: int = SAMPLES_PER_BLOCK,
) -> str:
    """Digest of all inputs of a time integration: runs with the same key agree bit for bit.

    It does not cover the code and the processor: these must be stored with checkpoints as well.
    """
    run, initial = _prepared(system, settings, outputs, speed_profile, initial, samples_per_block)
    start = run.start(initial).as_arrays()
    return fingerprint(settings, run.profile, run.arrays, run.base, run.ends, run.reach, run.bounds(0), start)


def _prepared(
    system: CoupledSystem,
    settings: TransientSettings,
    outputs: TransientOutputs,
    profile: SpeedProfile | None,
    initial: tuple[FloatArray, FloatArray] | None,
    samples_per_block: int,
) -> tuple[Integration, tuple[FloatArray, FloatArray] | None]:
    """Integration of the condensed coordinates by the method that the settings ask for, and their initial state."""
    if samples_per_block < 1:
        raise CouplingError(f"blocks of {samples_per_block} samples; expected at least one")
    if settings.method == "newmark" or system.turning_names:
        # The exact method steps over modes of any frequency.
        system = with_static_attachments(system)
    followed = condensed(system)
    if followed.system is not system:
        system, rows = followed.system, (outputs.displacement, outputs.velocity, outputs.acceleration)
        outputs = TransientOutputs(*(row @ followed.recovery for row in rows))
        initial = None if initial is None else (initial[0][followed.kept], initial[1][followed.kept])
    profile = profile or SpeedProfile.steady()
    part = exact_part(system, settings, profile)
    stepper = (
        NewmarkStepper(system, settings, outputs, profile)
        if part is None
        else CollocationStepper(part, settings, outputs, profile)
    )
    return Integration(stepper, settings, profile, samples_per_block), initial


def _samples_until(settings: TransientSettings, end: float, first: int, total: int) -> int:
    """Allocate the samples up to the end of a block; rounding may move one more or less into it."""
    upto = int(np.ceil((end - settings.record_from) / settings.sample_interval)) + 2
    return min(max(upto - first, 0), total - first)


@dataclass(frozen=True)
class EnergyBalance:
    """Energy balance of a time integration [J].

    Attributes
    ----------
    change : float
        Change of the kinetic energy and of the energy in springs and teeth.
    loads : float
        Work of the loads.
    lost : float
        Energy lost to damping.
    teeth : float
        Work of the rotation: of contacts whose stiffness and shape change under load, of rolling elements, and of
        friction on the coordinates.
    scale : float
        The largest of these, of the range of the stored energy, and of the kinetic energy at any step.
    friction : float
        Energy that tooth friction took from the nominal rotation, never negative: nearly all of it turned to heat, the
        rest went to the coordinates and is in ``teeth``. No part of the balance.
    """

    change: float
    loads: float
    lost: float
    teeth: float
    scale: float
    friction: float = 0.0

    @property
    def error(self) -> float:
        """Error of the balance, as a part of the scale; infinite where a part is no number."""
        missing = abs(self.change - self.loads + self.lost - self.teeth)
        if not np.isfinite([missing, self.scale]).all():
            return float("inf")
        return missing / self.scale if self.scale > 0.0 else 0.0


@dataclass(frozen=True)
class TransientFigures:
    """Figures of a whole run; c contacts.

    Attributes
    ----------
    mean_force, peak_force : ndarray, shape (c,)
        Mean and largest force over the recorded span, from every step [N].
    contact_loss : ndarray, shape (c,)
        Part of the recorded span in which the flanks were apart.
    energy : EnergyBalance
        Energy balance over the whole span.
    steps, rejected : int
        Steps taken and steps repeated.
    smallest_step : float
        Smallest step [s].
    error : float
        Largest of the accepted error measures.
    seconds : float
        Computing time of the steps, without compilation [s].
    """

    mean_force: FloatArray
    peak_force: FloatArray
    contact_loss: FloatArray
    energy: EnergyBalance
    steps: int
    rejected: int
    smallest_step: float
    error: float
    seconds: float


@dataclass(frozen=True, eq=False)
class TransientResult(TransientFigures, MotionRecord):
    """Record of a transient at even spacing, with the figures of the run."""


def simulate(
    system: CoupledSystem,
    settings: TransientSettings,
    outputs: TransientOutputs,
    *,
    speed_profile: SpeedProfile | None = None,
    initial: tuple[FloatArray, FloatArray] | None = None,
    progress: Callable[[float], None] = lambda fraction: None,
) -> TransientResult:
    """Integrate the motion of the coupled system.

    Parameters
    ----------
    system : CoupledSystem
    settings : TransientSettings
    outputs : TransientOutputs
    speed_profile : SpeedProfile, optional
        Speed over time; by default the nominal one.
    initial : tuple of ndarray, optional
        Coordinates and rates at t = 0, shape (n,) each; by default static equilibrium at rest.
    progress : callable
        Called with the finished part of the span, from 0 to 1.

    Raises
    ------
    TransientError
        Where the motion diverges, the step would have to be absurdly small, or the energies do not balance.

    See Also
    --------
    gearwhine.coupling.time.transient.integrate_blocks : The same in blocks, for runs that are long or continued later.
    """
    integrated = integrate_blocks(
        system, settings, outputs, speed_profile=speed_profile, initial=initial, progress=progress
    )
    blocks = list(integrated)
    figures = transient_figures(settings, blocks[-1].after)
    record: dict[str, Any] = {name: np.concatenate([getattr(block, name) for block in blocks]) for name in RECORDED}
    return TransientResult(**vars(figures), **record)


def transient_figures(settings: TransientSettings, end: Checkpoint) -> TransientFigures:
    """Figures of a run from its last checkpoint.

    Raises
    ------
    TransientError
        Where the energies do not balance.
    """
    # The rounding of the stored energy is no error of the balance.
    stored = max(end.highest - end.lowest, _ENERGY_ROUNDING * max(abs(end.highest), abs(end.lowest)))
    balance = _balance(end.energy - end.start_energy, end.totals, stored)
    if balance.error > ENERGY_BOUND or end.unsettled > 0.01 * end.steps:
        unsettled = (
            f", and {end.unsettled} of {end.steps} steps left the teeth's forces unsettled" if end.unsettled else ""
        )
        raise TransientError(
            f"the energies do not balance: {100 * balance.error:.2g} % is missing, expected at most "
            f"{100 * ENERGY_BOUND:g} %{unsettled}; take a tolerance below {settings.tolerance:g}, such as "
            f"{0.2 * settings.tolerance:.1g}"
        )
    span = settings.duration - settings.record_from
    return TransientFigures(
        mean_force=end.contact_totals[:, IMPULSE] / span,
        peak_force=end.contact_totals[:, PEAK],
        contact_loss=end.contact_totals[:, APART] / span,
        energy=balance,
        steps=end.steps,
        rejected=end.rejected,
        smallest_step=end.smallest,
        error=end.worst,
        seconds=end.seconds,
    )


def _balance(change: float, totals: FloatArray, stored: float) -> EnergyBalance:
    loads, lost, teeth, motion, friction = (float(value) for value in totals)
    # Free vibration exchanges energy between motion and springs without any work or loss.
    scale = float(np.max(np.abs([loads, lost, teeth, stored, motion])))
    return EnergyBalance(change, loads, lost, teeth, scale, friction)


@dataclass(frozen=True)
class Motion:
    """Motion of a machine over whole revolutions of its first driver.

    Attributes
    ----------
    machine : CoupledMachine
    result : TransientResult
        Steps, energy balance, contact figures.
    histories : Histories
        Signals of sensors, bearings, gears and gear pairs by name.
    """

    machine: CoupledMachine
    result: TransientResult
    histories: Histories

    @property
    def energy_error(self) -> float:
        """Part of the energy that is missing from the balance of the time integration."""
        return self.result.energy.error

    @cached_property
    def dataset(self) -> "xr.Dataset":
        """Every signal with its dimensions, unit and long name."""
        import xarray as xr

        variables: dict[str, Any] = {}
        coordinates: dict[str, Any] = {
            "time": ("time", self.histories.times, {"units": "s", "long_name": "time from static equilibrium"})
        }
        for quantity in HISTORY_QUANTITIES:
            if values := quantity.of(self.histories):
                coordinates |= quantity.coordinates(list(values))
                labels = {"units": quantity.unit, "long_name": quantity.what}
                variables[quantity.name] = (quantity.dimensions, np.array(list(values.values())), labels)
        return xr.Dataset(variables, coordinates)

    def spectrum(self, quantity: str, signal: str) -> Spectrum:
        """Amplitude spectrum of one signal, for instance ``("mesh_force", "pinion -> wheel")``.

        It is that of the last whole periods of all excitations, whose lines are exact; of the whole record under Hann's
        window where it holds none.

        Raises
        ------
        KeyError
            Where there is no such quantity or signal.
        """
        values = self.dataset[quantity].sel({self.dataset[quantity].dims[0]: signal}).values
        interval, system = float(self.histories.times[1] - self.histories.times[0]), self.machine.system
        frequencies = [*driving_frequencies(system).values(), *frequencies_of_elements(system)]
        whole = whole_period_samples(len(values), interval, frequencies)
        if whole is None or varies_within(system, *self.histories.times[[0, -1]].tolist()):
            return amplitude_spectrum(values, interval, "hann")
        return amplitude_spectrum(values[-whole:], interval)
