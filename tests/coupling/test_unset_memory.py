"""Memory that is allocated and not set takes no part in a motion: kernels as plain Python, with poison in it.

Without compilation a read beyond the end of an array raises, too.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]

# Every array that is made without values holds a poison; the kernels make theirs by the same function.
RUN = """
import json, sys
import numpy as np

poison = float(sys.argv[1])


def poisoned(make):
    def made(*args, **options):
        values = make(*args, **options)
        if values.dtype.kind in "fc":
            values.fill(poison)
        elif values.dtype.kind in "iu":
            values.fill(-(1 << 30))
        return values

    return made


np.empty, np.empty_like = poisoned(np.empty), poisoned(np.empty_like)

from dataclasses import replace
from gearwhine.coupling import CoupledSystem, TransientOutputs, TransientSettings, simulate
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.periodic import periodic_response

contact = ToothContact(1.6, piecewise.quadratic(0.8, 1.2, 0.8, 1.6), piecewise.constant(0.0, 1.6), 0.05)
masses = Component("masses", ("torsion", "torsion"), np.diag([0.2, 0.1]), 0.02 * np.eye(2), np.zeros((2, 2)))
drive = ContactConnector("drive", np.array([1.0, -1.0]), contact, 0.0, 0.45, np.array([[0.2, 2.0 * np.pi * 0.45, 0.1]]))
back = replace(drive, name="back", direction=-drive.direction, clearance=0.3, loaded=False)
ripple = HarmonicLoad(2.0 * np.pi * 0.9, np.array([0.3 + 0.1j, -0.2]))
system = CoupledSystem((masses,), (0.0,), (), (drive, back), 0.5 * drive.direction, (ripple,))
settings = TransientSettings(3.0, 1.0, 0.1, 0.1, tolerance=1e-2)
rows = TransientOutputs(np.eye(2), np.eye(2), np.eye(2))
def motions():
    told = {}
    for method in ("newmark", "exact"):
        found = simulate(system, replace(settings, method=method), rows)
        parts = [found.displacement, found.velocity, found.acceleration, found.compression, found.force]
        told[method] = [float(value) for part in parts for value in part.ravel()]
        told[method] += [*map(float, vars(found.energy).values()), float(found.steps), *map(float, found.contact_loss)]
    motion = periodic_response(system, tolerance=1e-2)
    told["periodic"] = [*map(float, motion.displacement), *map(float, motion.velocity), *map(float, motion.peak_force)]
    told["periodic"] += [float(value) for value in np.abs(motion.floquet.values)]
    return told


each = []
for poison in map(float, sys.argv[1:]):
    each.append(motions())
print(json.dumps(each))
"""


def motions(*poisons: str, compiled: bool = False) -> list[dict[str, list[float]]]:
    environment = os.environ | {"PYTHONPATH": str(ROOT), "NUMBA_DISABLE_JIT": "0" if compiled else "1"}
    script = RUN if not compiled else RUN.replace("np.empty, np.empty_like = ", "_ = ")
    done = subprocess.run(
        [sys.executable, "-c", script, *poisons], env=environment, capture_output=True, text=True, check=True
    )
    told: list[dict[str, list[float]]] = json.loads(done.stdout)
    return told


@pytest.mark.slow
def test_no_motion_depends_on_memory_that_was_not_set() -> None:
    (poisoned, other), (compiled,) = motions("nan", "1e300"), motions("0", compiled=True)
    assert poisoned == other
    for method, values in poisoned.items():
        assert np.isfinite(values).all(), method
        np.testing.assert_allclose(values, compiled[method], rtol=1e-6, atol=1e-9, err_msg=method)
