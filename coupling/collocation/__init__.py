"""Exponential collocation: elements of time, exact in the linear machine, of transients and periodic motions."""
