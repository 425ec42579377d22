"""NASA's gear noise rig from its case file to spectra, pictures and a results folder; a coarse mesh keeps it short."""

import sys
import tempfile

import gearwhine as gw

COARSE = {"housing.box.mesh_size": "40 mm", "transient.revolutions": 12, "transient.discard": 8}
COARSE |= {"transient.tolerance": 5e-3, "housing.frequency_limit": "3.2 kHz"}

study = gw.load("nasa-gear-noise-rig", COARSE)
run = study.simulate()
folder = sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp()
files = run.write(folder, pictures=False)

spectrum = run.dataset["sensor_spectrum"]
mesh_frequency = study.case.operation.speed / 6.283185307179586 * study.case.gear[0].teeth
line = float(spectrum.sel(frequency=mesh_frequency, method="nearest").max())
print(f"mesh line {mesh_frequency:.0f} Hz: {line:.3g} m/s² at the loudest sensor")
print(f"energy balance closes to {run.proofs['energy_error']:.1e}")
print(f"{len(files)} files in {folder}")
