"""Connector forces, compiled: tooth contacts, rolling bearings and gaps, and the arrays that their kernels take."""
