"""A bundled gearbox, from its case to housing modes, a sensor's spectrum, a figure and a results folder."""

import gearwhine as gw

study = gw.load("small-gearbox", {"operation.speed": "3000 rpm"})
modes = study.modes()  # every housing mode below 3 kHz
run = study.run()  # rotors, gears, coupled modes, motion over time

frequencies = modes.dataset["housing_frequency"]  # xarray, with units
print(frequencies.values.round(1), frequencies.units, modes.proofs["certificate"])
spectrum = run.dataset["sensor_spectrum"].sel(sensor="top", frequency=slice(0.0, 3000.0))
print(spectrum.to_series().nlargest(3))  # peak amplitudes, m/s² over Hz

run.plot("spectrum").savefig("spectrum.png")
run.write("results", pictures=False)
