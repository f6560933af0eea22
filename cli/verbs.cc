#include "cli/verb.h"

namespace quadsonde::cli {

std::vector<std::unique_ptr<Verb>> all_verbs() {
  std::vector<std::unique_ptr<Verb>> verbs;
  verbs.push_back(make_run_verb());
  verbs.push_back(make_info_verb());
  verbs.push_back(make_check_verb());
  verbs.push_back(make_estimate_verb());
  verbs.push_back(make_profile_verb());
  verbs.push_back(make_compare_verb());
  verbs.push_back(make_convert_verb());
  verbs.push_back(make_simulate_verb());
  verbs.push_back(make_calibrate_verb());
  verbs.push_back(make_validate_verb());
  for (auto& verb : make_archive_verbs()) verbs.push_back(std::move(verb));
  return verbs;
}

}  // namespace quadsonde::cli
