"""Results of a finished run read with xarray alone: names, units, the loudest lines of a sensor."""

import sys
import tempfile
from pathlib import Path

import numpy as np
import xarray as xr

import gearwhine as gw

if len(sys.argv) > 1:
    folder = Path(sys.argv[1])
else:
    folder = Path(tempfile.mkdtemp())
    gw.load(Path(__file__).with_name("two_gears.toml")).run().write(folder, pictures=False)

with xr.open_dataset(folder / "results.nc") as data:
    units = {name: variable.attrs.get("units", "") for name, variable in data.data_vars.items()}
    force = data["mesh_force_spectrum"].isel(contact=0)
    loudest = force.isel(frequency=np.argsort(-force.values)[:5]).sortby("frequency").load()

for name in sorted(units)[:8]:
    print(f"{name}: {units[name] or 'no unit'}")
for frequency, amplitude in zip(loudest["frequency"].values, loudest.values, strict=True):
    print(f"{frequency:8.1f} Hz {amplitude:9.2f} N")
