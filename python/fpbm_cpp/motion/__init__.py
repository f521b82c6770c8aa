"""Motions: simulated, tracked within limits, swept by the thousand, and the data that they come to.

Data flows one way: run (data) ← simulation ← workers, sweeping. Modules do not have the names of their functions.
"""
