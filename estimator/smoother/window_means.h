#pragma once
// Means of a stream over windows of time, in one walk forward.
#include <Eigen/Core>
#include <optional>

#include "ingest/flight/flight.h"

namespace quadsonde::estimator {

/// @tparam Value  what the mean is of: a fixed-size vector made of a sample by `of`
template <class Sample, class Value>
class WindowMeans {
 public:
  using Of = Value (*)(const Sample&);
  WindowMeans(const ingest::Stream<Sample>& stream, Of of) : stream_(stream), of_(of) {}

  /// Mean over the finite samples in (from, to]; empty with less than `least` of them. Windows come in order.
  std::optional<Value> over(ingest::LogTime from, ingest::LogTime to, std::size_t least = 1) {
    while (first_ < stream_.size() && stream_.time[first_] <= from) ++first_;
    Value sum = Value::Zero();
    std::size_t count = 0;
    for (std::size_t i = first_; i < stream_.size() && stream_.time[i] <= to; ++i) {
      const Value value = of_(stream_.value[i]);
      if (!value.allFinite()) continue;
      sum += value;
      ++count;
    }
    if (count < least || count == 0) return std::nullopt;
    return Value(sum / static_cast<double>(count));
  }

 private:
  const ingest::Stream<Sample>& stream_;
  Of of_;
  std::size_t first_ = 0;
};

}  // namespace quadsonde::estimator
