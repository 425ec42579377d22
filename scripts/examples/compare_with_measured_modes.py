"""Natural modes of the rig's housing beside NASA's measured ones, before and after its numbers are updated."""

import gearwhine as gw

MESH = {"housing.box.mesh_size": "40 mm"}
errors = {}
for name in ("nasa-gear-noise-rig-nominal", "nasa-gear-noise-rig-updated"):
    comparison = gw.load(name, MESH).compare()
    errors[name] = comparison.document["rms_error_percent"]
    print(name)
    for pair in comparison.document["pairs"]:
        print(f"  {pair['measured_hz']:6.0f} Hz measured, {pair['model_hz']:6.0f} Hz: {pair['error_percent']:+5.1f} %")
    print(f"  rms {errors[name]:.2f} %")
pairs = comparison.dataset[["measured_frequency", "model_frequency"]]
print(pairs)
