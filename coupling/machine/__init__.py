"""The machine: its description, components, connectors and loads, and the coupled system assembled of them."""
