"""Exchange of whole machines with other programs; a folder for each format."""
