"""Machines whose planets turn with carriers: sidebands, harmonic balance over the turning, phasing, exponents."""
