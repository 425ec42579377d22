"""Sound radiated by a housing: surface, boundary elements, Rayleigh integral, radiation resistance and levels."""
