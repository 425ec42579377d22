"""Numerical methods that the room shares: compiled kernels, banded matrices, Gauss rules, trust regions."""
