"""Motions: simulation, tracking within limits, sweeps, and their data.

Modules depend on one another in one direction: run (data) ← simulation ← workers, sweeping. Names of modules differ
from names of functions.
"""
