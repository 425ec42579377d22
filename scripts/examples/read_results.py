"""Results of a finished run read from its folder with xarray alone: names, units, the loudest lines of a spectrum."""

import sys
import tempfile
from pathlib import Path

import xarray as xr

import gearwhine as gw

if len(sys.argv) > 1:
    folder = Path(sys.argv[1])
else:
    folder = Path(tempfile.mkdtemp())
    gw.load(Path(__file__).with_name("two_gears.toml")).run().write(folder, pictures=False)

with xr.open_dataset(folder / "results.nc") as data:
    units = {name: variable.attrs["units"] for name, variable in data.data_vars.items() if "units" in variable.attrs}
    force = data["mesh_force_spectrum"].isel(contact=0).to_series()
loudest = force.nlargest(5).sort_index()

for name in ("mesh_force", "bearing_force", "gear_displacement", "mesh_stiffness"):
    print(f"{name}: {units[name]}")
for frequency, amplitude in loudest.items():
    print(f"{frequency:8.1f} Hz {amplitude:9.2f} N")
