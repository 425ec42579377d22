"""The rotor as it is described: shaft segments, materials, discs, bearings and loads."""
