#pragma once
// By how much all headings of a flight are off, from its own motion.
#include <optional>

#include "ingest/flight/flight.h"

namespace quadsonde::ingest {

struct HeadingOffset {
  double deg = 0;  ///< to be ADDED to every logged heading
  double sd_deg = 0;
  std::size_t windows = 0;  ///< of 3 s
  /// Beyond its own uncertainty, and beyond what a heading is taken to be off anyhow.
  bool determined(double heading_sd_deg) const;
};

/// The thrust that the tilt shows must point where the vehicle accelerates and where it drags against the air. Written
/// with N + iE as one complex number, phi the offset, L = g - vdot_d, means over 3 s:
///     L s = exp(-i phi) (vdot + c (v - w)) - exp(i psi) b
/// Least squares for phi, c, w and b. The sd holds the residuals' correlation from window to window, and what 0.1 s of
/// latency would turn: in a steady turn the two cannot be told apart. Neither hover nor a wind alone shows an offset:
/// there the sd is tens of degrees. A compass whose error depends on the heading is no constant offset.
/// Empty where there are fewer than 10 windows or the fit does not come to an end.
/// @param latency_s  how much older the velocity is than the attitude
/// Source: equation (1) of the design notes, section 2; the trim's prior is 3 deg.
std::optional<HeadingOffset> estimate_heading_offset(const Flight& flight, double latency_s = 0);

}  // namespace quadsonde::ingest
