"""Motions: simulation, tracking within limits, sweeps, and their data.

Modules depend on one another in one direction: run_data ← task_errors ← tables, rosbag ← run ← simulation ← sweeping.
Names of modules differ from names of functions.
"""
