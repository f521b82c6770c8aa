"""Robot description files: URDF, SRDF, their meshes, and capsules that contain the geometry of the links."""
