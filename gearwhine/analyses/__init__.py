"""Analyses of a case: one function for each, from the case to its :class:`Result`.

A command, a method of :class:`gearwhine.Study` and an analysis have one name, but for these: the command ``load`` is
`operating_point` here, as `gearwhine.load` reads a case; ``report`` and ``export`` are `write_report` and
`export_results`. The analyses of housings are imported without rotors and gears.
"""
