#pragma once
// Problems as they are met, not more than somebody would read.
#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "ingest/flight/problem.h"

namespace quadsonde::ingest::mcap {

class ProblemList {
 public:
  static constexpr std::size_t kMost = 200;

  void add(Problem problem) {
    if (list_.size() < kMost)
      list_.push_back(std::move(problem));
    else
      ++left_out_;
  }
  /// Tells, once, how many were not kept.
  void close(const std::string& file_name) {
    if (left_out_ > 0 && list_.size() == kMost)
      list_.push_back({Kind::damaged, fmt::format("{} more problems are not listed", left_out_),
                       {file_name, {}, {}, {}}, ""});
  }
  bool empty() const { return list_.empty(); }
  const std::vector<Problem>& list() const { return list_; }

 private:
  std::vector<Problem> list_;
  std::uint64_t left_out_ = 0;
};

}  // namespace quadsonde::ingest::mcap
