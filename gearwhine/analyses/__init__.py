"""Analyses of a case: one function for each, from the case to its :class:`Result`.

A command, a method of :class:`gearwhine.Study` and an analysis have one name. The analyses of housings are imported
without rotors and gears.
"""
