"""Record of a time integration in blocks: histories block by block, and their spectra."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

import coupling as room
from gearwhine.march_files import Arrays, Blocks
from gearwhine.stages.sampling import Sampling

FloatArray = npt.NDArray[np.float64]


def block_arrays(columns: FloatArray, held: FloatArray, after: room.Checkpoint) -> Arrays:
    """Stored arrays of a block: its samples, the filter's state, and the state to restart from."""
    return {"columns": columns, "held": held, **after.as_arrays()}


@dataclass(frozen=True)
class Signals:
    """Recorded signals of a transient: histories, and the modal motion behind them."""

    histories: room.Histories
    modal: room.ModalRecord

    @property
    def times(self) -> FloatArray:
        """[s], shape (s,)."""
        return self.histories.times

    @property
    def columns(self) -> FloatArray:
        """Every signal beside the others, shape (s, k)."""
        return np.concatenate([self.histories.columns, self.modal.columns], axis=1)

    def with_columns(self, times: FloatArray, columns: FloatArray) -> "Signals":
        """Other samples of the same signals, from what :attr:`columns` gives."""
        modal = self.modal.columns.shape[1]
        split = columns.shape[1] - modal
        return Signals(
            self.histories.with_columns(times, columns[:, :split]), self.modal.with_columns(columns[:, split:])
        )


@dataclass(frozen=True)
class MarchRecord:
    """A finished march.

    Attributes
    ----------
    sampling : Sampling
    blocks : Blocks
        At least one.
    signals : Signals
        Names of the signals; samples in it do not count.
    """

    sampling: Sampling
    blocks: Blocks
    signals: Signals

    @property
    def end(self) -> room.Checkpoint:
        """State at the end of the integration."""
        return room.Checkpoint.from_arrays(self.blocks[len(self.blocks) - 1])

    @property
    def samples(self) -> int:
        """Number of stored samples."""
        return self.sampling.decimation.kept(self.end.sample)

    def pieces(self) -> Iterator[Signals]:
        """The histories, block by block."""
        done = 0
        for number in range(len(self.blocks)):
            columns = self.blocks[number]["columns"]
            yield self._named(columns, done)
            done += len(columns)

    def stretches(self) -> Iterator[Signals]:
        """The histories in stretches of equal length, the last of which ends with the record."""
        length = min(self.sampling.stretch, self.samples)
        skipped = self.samples % length
        waiting, done = self.signals.columns[:0], 0
        for piece in self.pieces():
            columns = piece.columns
            if skipped:
                dropped = min(skipped, len(columns))
                columns, skipped, done = columns[dropped:], skipped - dropped, done + dropped
            waiting = np.concatenate([waiting, columns]) if len(waiting) else columns
            while len(waiting) >= length:
                yield self._named(waiting[:length], done)
                waiting, done = waiting[length:], done + length

    def last_stretch(self) -> Signals:
        """The last of them; of a record that fits in memory, all of it."""
        length = min(self.sampling.stretch, self.samples)
        parts: list[FloatArray] = []
        for number in reversed(range(len(self.blocks))):
            parts.insert(0, self.blocks[number]["columns"])
            if sum(map(len, parts)) >= length:
                break
        columns = parts[0] if len(parts) == 1 else np.concatenate(parts)
        return self._named(columns[len(columns) - length :], self.samples - length)

    def _named(self, columns: FloatArray, first: int) -> Signals:
        """The samples under their names, counted from a first one."""
        recorded = self.sampling.decimation.delay + self.sampling.decimation.factor * np.arange(
            first, first + len(columns), dtype=np.float64
        )
        settings = self.sampling.settings
        return self.signals.with_columns(settings.record_from + settings.sample_interval * recorded, columns)

    def spectrum(self, stretch: FloatArray, limit: float) -> room.Spectrum:
        """Lines of signals over one stretch, shape (..., s), as far as the record holds them in full.

        Of a long record, that is up to a limit [Hz].
        """
        spectrum = room.amplitude_spectrum(stretch, self.sampling.interval, self.sampling.window)
        return _below(spectrum, limit) if self.sampling.is_long else spectrum


def record_spectra(
    record: MarchRecord, last: room.Histories, limit: float
) -> tuple[dict[str, room.Spectrum], dict[str, room.Spectrum]]:
    """Spectra of the sensors' accelerations and of the mesh forces.

    Of the whole where it fits in memory, and given as ``last``; of a long record averaged over its stretches, up to the
    limit [Hz] below which all of it was kept.
    """
    sensors, meshes = list(last.sensor_acceleration), list(last.mesh_force)
    if not record.sampling.is_long:
        of_sensors, of_meshes = (
            {name: record.spectrum(signal, limit) for name, signal in group.items()}
            for group in (last.sensor_acceleration, last.mesh_force)
        )
        return of_sensors, of_meshes
    if not sensors and not meshes:
        return {}, {}
    rows = (
        np.array([*stretch.histories.sensor_acceleration.values(), *stretch.histories.mesh_force.values()])
        for stretch in record.stretches()
    )
    together = _below(room.averaged_spectrum(rows, record.sampling.interval, record.sampling.window), limit)
    each = [
        replace(together, amplitude=amplitude, phase=phase)
        for amplitude, phase in zip(together.amplitude, together.phase, strict=True)
    ]
    return dict(zip(sensors, each, strict=False)), dict(zip(meshes, each[len(sensors) :], strict=True))


def _below(spectrum: room.Spectrum, limit: float) -> room.Spectrum:
    """The lines up to a limit [Hz], and two more: a line at the limit stands out only beside its neighbours."""
    kept = int(np.searchsorted(spectrum.frequencies, limit + 2.0 * spectrum.frequencies[1], side="right"))
    return replace(
        spectrum,
        frequencies=spectrum.frequencies[:kept],
        amplitude=spectrum.amplitude[..., :kept],
        phase=spectrum.phase[..., :kept],
    )
