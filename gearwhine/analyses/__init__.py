"""What can be asked of a case: one function for each analysis, from the case to its :class:`Result`.

Each module is imported by the analyses that need it: those of housings go without rotors and gears.
"""
