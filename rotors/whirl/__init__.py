"""Damped, gyroscopic whirl in both planes: exact equations, eigenvalues, and the proof that none is missing."""
