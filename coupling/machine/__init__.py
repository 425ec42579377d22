"""Machine: its description, components, connectors and loads, and the assembly of the coupled system."""
