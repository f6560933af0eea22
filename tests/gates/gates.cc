// gates [--reduced | --only step|point|law|climb|rigid]
// Computes the gates of ESTIMATION.md section 10 and prints each value beside its limit; exit 1 if one does not hold.
#include <fmt/format.h>

#include <cstring>
#include <string>

#include "tests/gates/flying.h"

int main(int argc, char** argv) {
  using namespace quadsonde::gates;
  const bool reduced = argc > 1 && std::strcmp(argv[1], "--reduced") == 0;
  const int seeds = reduced ? 6 : 30;
  const std::string only = argc > 2 && std::strcmp(argv[1], "--only") == 0 ? argv[2] : "";
  const auto wanted = [&](const char* group) { return only.empty() || only == group; };
  fmt::print("classic: the published four-state filter; static: tilt and drag in balance at every instant\n");
  if (wanted("step")) step_gates(reduced ? 30 : 200);
  if (wanted("point")) point_mass_gates(seeds);
  if (wanted("law")) law_gates(seeds, reduced);
  if (wanted("climb")) climb_gates(seeds, reduced);
  if (wanted("rigid") && !reduced) rigid_gates(seeds);
  fmt::print("{} gate{} missed\n", missed(), missed() == 1 ? "" : "s");
  return missed() > 0;
}
