"""Measured natural frequencies of a housing beside a model's, and the model's modulus fitted to them.

The measurement is a twin: the same box of a steel whose modulus of elasticity the model does not know.
"""

import gearwhine as gw

MESH = {"housing.box.mesh_size": "45 mm"}
SECRET = {"material.steel.youngs_modulus": "196 GPa"}

twin = gw.load("steel-box", MESH | SECRET).modes()
measured = twin.dataset["housing_frequency"].values[:6]  # Hz
modulus = {"name": "modulus", "keys": ["material.steel.youngs_modulus"], "range": ["180 GPa", "230 GPa"]}
study = gw.load("steel-box", MESH | {"measured.frequencies": measured.tolist(), "update.parameter": [modulus]})

before = study.compare()
for pair in before.document["pairs"]:
    print(f"{pair['measured_hz']:7.1f} Hz measured, {pair['model_hz']:7.1f} Hz: {pair['error_percent']:+.2f} %")

fit = study.update()
fitted = fit.dataset.sel(parameter="modulus")
print(f"modulus {1e-9 * float(fitted['value_before']):.1f} GPa before, ", end="")
print(f"{1e-9 * float(fitted['value_after']):.1f} ± {1e-9 * float(fitted['value_deviation']):.1f} GPa after the fit")
print(f"rms error {before.document['rms_error_percent']:.2f} % before, {fit.document['rms_error_percent']:.2f} % after")
