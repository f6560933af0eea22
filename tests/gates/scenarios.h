#pragma once
// The flights of the gates: ESTIMATION.md section 10.
#include "ingest/motion/simulator.h"

namespace quadsonde::gates {

ingest::Scenario s1_step(double sigma_u);
ingest::Scenario s2_hover();
ingest::Scenario s3_ascent(double climb_rate);
ingest::Scenario s4_square(double latency);
ingest::Scenario fixed_heading();
ingest::Scenario fast_hover();
ingest::Scenario trimmed_hover();

}  // namespace quadsonde::gates
