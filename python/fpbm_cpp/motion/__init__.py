"""Motions: simulated, tracked within limits, swept by the thousand, and the data that they come to.

Data flows one way: run (data) ← simulation, tracking ← plan, chunks ← sweeping. The modules' names are not those of
their functions: simulation holds simulate(), tracking holds track(), sweeping holds sweep().
"""
