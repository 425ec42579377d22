"""The coupled system of a machine: components, connectors, meshes and loads in one set of modal coordinates."""
