"""Analyses of a rotor on its bearings: Campbell diagram, critical speeds, unbalance, statics, forced response."""
