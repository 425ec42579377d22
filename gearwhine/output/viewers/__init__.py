"""Libraries of the interactive report, as their authors publish them: see README.md beside this file."""
