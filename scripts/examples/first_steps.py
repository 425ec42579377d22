"""A bundled gearbox, from its case to housing modes, a sensor's spectrum, a figure and a results folder."""

import gearwhine as gw

study = gw.load("small-gearbox", {"operation.speed": "3000 rpm"})
modes = study.modes()  # every housing mode below 3 kHz
run = study.run()  # rotors, gears, coupled modes, motion over time

frequencies = modes.dataset["housing_frequency"]  # xarray, with units
print(frequencies.values.round(1), frequencies.units, modes.proofs["certificate"])
top = run.document["sensors"][0]  # its lines by name, the highest first
for line in top["peaks"][:3]:
    print(line["frequency_hz"], line["amplitude_m_per_s2"], line["name"])

run.plot("spectrum").savefig("spectrum.png")
run.write("results", pictures=False)
