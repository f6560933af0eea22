#pragma once
// Work on bytes that nobody vouches for, by libraries that were not made for such: in a process of its own.
#include <cstdint>
#include <functional>
#include <string>

#include "ingest/flight/problem.h"

namespace quadsonde::product {

struct IsolationLimits {
  double seconds = 20;                                  ///< of wall time; the child is killed after it
  std::uint64_t memory_bytes = std::uint64_t{1} << 30;  ///< beyond what the caller has already
  std::uint64_t answer_bytes = std::uint64_t{256} << 20;
};

/// Runs `work` in a child process that can write no file, and hands back what it returns. The child may crash, hang or
/// want too much memory without harm. It has this thread alone and never returns from `work`'s caller, so `work` must
/// not wait for a lock that another thread may hold; the caller takes such locks before.
/// Fails with Kind::damaged when the child crashed or gave nothing, with Kind::limit when it took too long or said too
/// much, and with Kind::no_answer when there is no process to be had.
ingest::Result<std::string> isolated(const std::function<std::string()>& work, const IsolationLimits& limits = {});

}  // namespace quadsonde::product
