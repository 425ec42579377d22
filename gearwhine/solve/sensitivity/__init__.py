"""Sensitivity of a loaded case: which wall, bearing or position changes gear pairs, sensors' lines and sound most."""
