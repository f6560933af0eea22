#pragma once
// Watching and stopping work in progress.
#include <atomic>
#include <functional>
#include <string_view>

#include "ingest/flight/problem.h"

namespace quadsonde::product {

/// What a caller may watch and stop. Everything may be left out. The functions that take a Control end within a
/// moment after `stop` is set, with the Problem of stopped(); nothing half-written stays behind. The one long stage
/// that cannot be left is the estimator's: a caller that will not wait for it may end the process as soon as
/// `writing` is 0, because no file is begun after `stop` is set.
struct Control {
  std::function<void(std::string_view stage, double share)> progress;  ///< share of the whole, 0 to 1
  const std::atomic<bool>* stop = nullptr;
  std::atomic<int>* writing = nullptr;  ///< outputs begun and not yet finished or taken back

  bool stopped() const { return stop && stop->load(); }
  void report(std::string_view stage, double share) const {
    if (progress) progress(stage, share);
  }
};

inline ingest::Problem stopped_problem() {
  return {ingest::Kind::no_answer, "stopped before it was finished", {}, "nothing was written; run it again"};
}

}  // namespace quadsonde::product
