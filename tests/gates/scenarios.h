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

/// 6 m/s toward 40 degrees, 80 s, yaw 20 deg/s.
ingest::Scenario considered_hover();
ingest::Scenario considered_square();
/// S3 at another climb rate, with stops of 20 s every 30 m; the caller draws the climb law.
ingest::Scenario s5_ascent(double climb_rate, bool pauses);
/// The same flight by the rigid body.
ingest::Scenario rigid(ingest::Scenario scenario);

}  // namespace quadsonde::gates
