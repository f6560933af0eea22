#pragma once
// How a reader's benchmark is timed and printed.
#include <fmt/format.h>
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <functional>
#include <string>

namespace quadsonde::bench {

/// Peak resident memory of this process so far [MB].
inline double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Processor time of this process [s]: what one core needs, whoever else is running.
inline double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Processor seconds of the best of three runs.
inline double best_of_three(const std::function<void()>& run) {
  double best = 1e300;
  for (int i = 0; i < 3; ++i) {
    const double start = processor_seconds();
    run();
    best = std::min(best, processor_seconds() - start);
  }
  return best;
}

inline void print_head() {
  fmt::print("{:<34} {:>8} {:>8} {:>12} {:>12}\n", "what", "CPU s", "MB/s", "messages/s", "peak MB");
}
inline void print_row(const std::string& what, double seconds, std::size_t bytes, std::uint64_t messages) {
  fmt::print("{:<34} {:>8.3f} {:>8.0f} {:>12.3g} {:>12.0f}\n", what, seconds,
             static_cast<double>(bytes) * 1e-6 / seconds, static_cast<double>(messages) / seconds, peak_memory_mb());
}

}  // namespace quadsonde::bench
