"""Statics: static equilibrium under the mean load, and the mean mesh stiffness about it."""
