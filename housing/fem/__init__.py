"""Finite elements of a solid: assembly, sparse matrices, surface integrals, factorisation."""
