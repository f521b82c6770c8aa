#pragma once

#include "stack_tasks.hpp"

namespace fpbm::bindings {

/// A stream of points for a task of a tracker: fpbm::Stream of postures or poses. The type of the stream is compiled in
/// bind_stream.cpp only.
class PyStream {
 public:
  PyStream(TaskKind kind_, int size_, double dt_) : kind(kind_), size(size_), dt(dt_) {}
  PyStream(const PyStream&) = delete;
  PyStream& operator=(const PyStream&) = delete;
  virtual ~PyStream() = default;

  [[nodiscard]] virtual StackTarget ahead(double seconds) const noexcept = 0;
  virtual void advance() noexcept = 0;
  virtual bool set_speed(double fraction) noexcept = 0;

  const TaskKind kind;
  const int size;  ///< Rows of a displacement.
  const double dt;
};

inline void advance_source(PyStream& stream, double, Level, bool, double) noexcept {
  stream.advance();
}
inline void set_source_speed(PyStream& stream, double speed) noexcept {
  if (speed != 0.0) stream.set_speed(speed);
}
[[nodiscard]] inline const StackTarget& target_at(const StackTarget& target) noexcept {
  return target;
}

}  // namespace fpbm::bindings
