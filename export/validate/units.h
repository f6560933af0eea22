#pragma once
// What units mean, by UDUNITS.
#include <map>
#include <set>
#include <string>
#include <utility>

#include "ingest/flight/problem.h"

namespace quadsonde::product {

struct UnitAnswer {
  bool known = false;        ///< UDUNITS can read the units
  bool convertible = false;  ///< to the other ones
  bool same = false;         ///< a number means the same in both
};

/// Questions first, then all answers at once: units out of foreign files are read in a child process.
class Units {
 public:
  /// Whether `units` are units, and what they have to do with `other` (which may be empty).
  void ask(const std::string& units, const std::string& other = "") { questions_.insert({units, other}); }
  /// Fails where UDUNITS has no database or dies of a question.
  ingest::Result<void> answer();
  /// Nothing known of what was not asked.
  UnitAnswer of(const std::string& units, const std::string& other = "") const;

 private:
  using Question = std::pair<std::string, std::string>;
  std::set<Question> questions_;
  std::map<Question, UnitAnswer> answers_;
};

}  // namespace quadsonde::product
