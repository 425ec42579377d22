"""Figures of rotors: Campbell diagram, mode shapes, critical speeds, responses."""
