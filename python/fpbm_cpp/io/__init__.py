"""Motions and arms in files: runs and back, tables, datasets, ROS bags, URDF, C++ headers."""
