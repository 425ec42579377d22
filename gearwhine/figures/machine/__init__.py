"""Figures of the coupled machine: its modes, steady state, transient, run-up and sweep."""
