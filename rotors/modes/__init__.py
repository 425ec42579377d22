"""Undamped modes of a shaft and the modal rotor: bending in one plane, torsion, axial motion, residual modes."""
