#pragma once

/// Configures and runs the controller with every preset, and with one joint too few.
void every_arm();
