#pragma once

// Stands in for pluginlib's header of this name.
#define PLUGINLIB_EXPORT_CLASS(Class, Base)           \
  std::unique_ptr<Base> stand_in::exported_plugin() { \
    return std::make_unique<Class>();                 \
  }
