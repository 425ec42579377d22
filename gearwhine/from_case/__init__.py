"""Library objects built from a case: rotors, gears, bearings, mesh, fixtures, machine."""
