"""Files of motions and arms: run files, and C++ headers."""
