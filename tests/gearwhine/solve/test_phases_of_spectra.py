"""Phases of spectra: those of cosines on the time axis of the histories, and of the steady motion."""

from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr

import gearwhine as gw

pytestmark = pytest.mark.usefixtures("mechanisms_left_out")

TURN = 60.0 / 3000.0  # of the bundled pair's shafts [s]
TEETH = 28
BEGIN = 4.37  # turns before the record: 122.36 mesh periods


@cache
def study() -> gw.CaseStudy:
    """The bundled spur pair on the flanks of its drive alone, without its unbalance."""
    return gw.load("spur-pair", {"operation.speed": "3000 rpm", "rotor.0.unbalance": []})


@cache
def run(more: float) -> xr.Dataset:
    """A run with some turns after those before the record."""
    turns = {"transient.revolutions": BEGIN + more, "transient.discard": BEGIN, "transient.tolerance": 1e-5}
    return study().changed(turns).simulate().dataset


def line(data: Any, harmonic: int) -> complex:
    """Return the stored line of the mesh force at a multiple of the mesh frequency."""
    at = {"contact": 0, "frequency": int(np.argmin(np.abs(data["frequency"].values - harmonic * TEETH / TURN)))}
    amplitude, phase = (float(data[f"mesh_force_spectrum{part}"].isel(at)) for part in ("", "_phase"))
    return amplitude * complex(np.exp(1j * phase))


@pytest.mark.slow
def test_a_line_is_the_cosine_on_the_axis_of_its_history() -> None:
    data = run(4.0)
    assert data["mesh_force_spectrum"].attrs["window"] == "uniform"
    times, force = data["time"].values, data["mesh_force"].isel(contact=0).values.astype(np.float64)
    assert abs(times[0] - BEGIN * TURN) < 1e-9
    for harmonic in (1, 2, 3):
        tone = 2.0 * np.mean((force - force.mean()) * np.exp(-2j * np.pi * harmonic * TEETH / TURN * times))
        assert abs(line(data, harmonic) - tone) < 1e-4 * abs(tone)


@pytest.mark.slow
def test_run_and_steady_motion_have_one_phase() -> None:
    """Both follow the same teeth from t = 0 on: the steady motion over its period has the lines of the run."""
    steady = study().steady().dataset
    force = steady["steady_mesh_force"].isel(steady_motion=0, contact=0).values
    times = steady["period_time"].values
    strongest = abs(line(run(4.0), 1))
    for harmonic in (1, 2, 3):
        tone = 2.0 * np.mean((force - force.mean()) * np.exp(-2j * np.pi * harmonic * TEETH / TURN * times))
        assert abs(line(run(4.0), harmonic) - tone) < 0.02 * strongest
