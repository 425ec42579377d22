"""What each command does: stages, then files, then the document that it prints.

Each module is read by the commands that need it: those on housings go without rotors and gears.
"""
