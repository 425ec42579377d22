"""Tooth contact: stiffness and deviation of a pair of teeth, face slices, contact law, lookup tables, kernels."""
