"""What a person sees on the terminal: a function for each command, given the document that its JSON holds."""

from gearwhine.screen.sweep import show_sweep

__all__ = ["show_sweep"]
