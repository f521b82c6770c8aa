#pragma once

#include <memory>
#include <utility>

#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/realtime/detail/tick_references.hpp"

namespace fpbm::bindings {

/// A tracker for code in lanes (TrackerBatch): an AnyTracker with a number of joints that is known at compile time. The
/// functions are compiled once for all kinds of processors.
template <typename Space, int N>
class LaneTracker {
 public:
  using Point = typename Space::template Point<double>;
  struct Ticked {
    Status status;
  };

  /// continuous: bits of the continuous joints.
  template <typename Tracker>
  LaneTracker(std::unique_ptr<Tracker> tracker, JointBits continuous)
      : continuous_(continuous), held_(std::make_unique<Held<Tracker>>(std::move(tracker))) {}

  /// Bits of the continuous joints.
  [[nodiscard]] JointBits continuous() const noexcept { return continuous_; }

  [[nodiscard]] Point tip() const noexcept { return held_->tip(); }
  [[nodiscard]] State<N> state() const noexcept { return held_->state(); }
  [[nodiscard]] Vector<N> acceleration() const noexcept { return held_->acceleration(); }
  [[nodiscard]] Vector<N> acceleration_change() const noexcept { return held_->acceleration_change(); }
  bool begin(const Vector<Space::kRows>& error, double length) noexcept { return held_->begin(error, length); }
  [[nodiscard]] Reference<Space> corrected(const Reference<Space>& reference) const noexcept {
    return held_->corrected(reference);
  }
  Status finish(const Reference<Space>& now, const TickReferences<Space>& references, const Vector<N>& u) noexcept {
    return held_->finish(now, references, u);
  }
  Ticked advance(const TickReferences<Space>& references) noexcept { return {held_->advance(references)}; }

 private:
  struct Holder {
    Holder() = default;
    Holder(const Holder&) = delete;
    Holder& operator=(const Holder&) = delete;
    virtual ~Holder() = default;
    [[nodiscard]] virtual Point tip() const noexcept = 0;
    [[nodiscard]] virtual State<N> state() const noexcept = 0;
    [[nodiscard]] virtual Vector<N> acceleration() const noexcept = 0;
    [[nodiscard]] virtual Vector<N> acceleration_change() const noexcept = 0;
    virtual bool begin(const Vector<Space::kRows>& error, double length) noexcept = 0;
    [[nodiscard]] virtual Reference<Space> corrected(const Reference<Space>& reference) const noexcept = 0;
    virtual Status finish(const Reference<Space>& now, const TickReferences<Space>& references,
                          const Vector<N>& u) noexcept = 0;
    virtual Status advance(const TickReferences<Space>& references) noexcept = 0;
  };

  template <typename Tracker>
  struct Held final : Holder {
    explicit Held(std::unique_ptr<Tracker> tracker) : tracker_(std::move(tracker)) {}

    [[nodiscard]] Point tip() const noexcept override { return tracker_->tip(); }
    [[nodiscard]] State<N> state() const noexcept override { return {tracker_->state().q, tracker_->state().qd}; }
    [[nodiscard]] Vector<N> acceleration() const noexcept override { return tracker_->acceleration(); }
    [[nodiscard]] Vector<N> acceleration_change() const noexcept override { return tracker_->acceleration_change(); }
    bool begin(const Vector<Space::kRows>& error, double length) noexcept override {
      return tracker_->begin(error, length);
    }
    [[nodiscard]] Reference<Space> corrected(const Reference<Space>& reference) const noexcept override {
      return tracker_->corrected(reference);
    }
    Status finish(const Reference<Space>& now, const TickReferences<Space>& references,
                  const Vector<N>& u) noexcept override {
      return tracker_->finish(now, references, u);
    }
    Status advance(const TickReferences<Space>& references) noexcept override {
      return tracker_->advance(references).status;
    }

   private:
    std::unique_ptr<Tracker> tracker_;
  };

  JointBits continuous_;
  std::unique_ptr<Holder> held_;
};

}  // namespace fpbm::bindings
