#include "export/pipeline/problems.h"

#include <algorithm>

namespace quadsonde::product {

void add_once(std::vector<ingest::Problem>& all, const ingest::Problem& problem) {
  const auto text = ingest::to_string(problem);
  const auto same = [&](const ingest::Problem& known) { return ingest::to_string(known) == text; };
  if (std::none_of(all.begin(), all.end(), same)) all.push_back(problem);
}

void add_once(std::vector<ingest::Problem>& all, const std::vector<ingest::Problem>& more) {
  for (const auto& problem : more) add_once(all, problem);
}

}  // namespace quadsonde::product
