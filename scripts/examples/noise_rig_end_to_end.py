"""NASA's gear noise rig from its case to spectra, measured modes and a results folder, on a coarse and quick mesh."""

import sys
import tempfile

import gearwhine as gw

COARSE = {"housing.box.mesh_size": "40 mm", "transient.revolutions": 12, "transient.discard": 8}
MESH_HZ = 28 * 5500 / 60  # 28 teeth at 5500 rpm

study = gw.load("nasa-gear-noise-rig", COARSE | {"transient.tolerance": 5e-3})
run = study.run()
folder = sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp()
files = run.write(folder, pictures=False)

for pair in run.document["compare"]["pairs"]:
    print(f"{pair['measured_hz']:6.0f} Hz measured, {pair['model_hz']:6.0f} Hz: {pair['error_percent']:+5.1f} %")
line = run.dataset["sensor_spectrum"].sel(frequency=MESH_HZ, method="nearest")
for name, amplitude in line.to_series().items():
    print(f"{name}: {amplitude:.2f} m/s² at the mesh frequency of {MESH_HZ:.0f} Hz")
mean_force = float(run.dataset["mesh_force"].isel(contact=0).mean())
print(f"mean tooth force {mean_force:.0f} N; energy balance closes to {run.proofs['energy_error']:.1e}")
print(f"{len(files)} files in {folder}")
