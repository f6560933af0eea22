#pragma once
#include <string>
#include <utility>
#include <vector>

#include "export/validate/rule_book.h"

namespace quadsonde::product {

/// A breach of a rule.
struct Finding {
  const Rule* rule = nullptr;
  std::string where;  ///< variable, variable:attribute, message, byte; empty: the file as a whole
  std::string what;   ///< what is wrong
};

/// Not more of each rule than somebody would read.
class Findings {
 public:
  static constexpr std::size_t most_of_a_rule = 40;

  void add(const Rule* rule, std::string where, std::string what) {
    std::size_t same = 0;
    for (const auto& f : list_) same += f.rule == rule;
    if (same < most_of_a_rule)
      list_.push_back({rule, std::move(where), std::move(what)});
    else
      ++left_out_;
  }
  const std::vector<Finding>& list() const { return list_; }
  /// Breaches that are not listed because their rule is met so often.
  std::size_t left_out() const { return left_out_; }

 private:
  std::vector<Finding> list_;
  std::size_t left_out_ = 0;
};

}  // namespace quadsonde::product
