#pragma once
// Profiles as WMO FM 94 BUFR, edition 4, master tables version 31.
#include <string>

#include "export/uasdc/observations.h"

namespace quadsonde::product {

/// Which form a profile takes.
enum class BufrForm {
  /// 3 01 150 + 3 09 021, what centres know from wind profilers: u and v to 0.1 m/s with their uncertainties, heights
  /// to 1 m, times to the minute. One message per leg.
  profiler,
  /// The list of the WMO UAS demonstration campaign: one subset per bin, speed to 0.1 m/s, direction to 1 degree,
  /// times to the second, and what sensors of the air measured.
  uasdc,
  /// Self-describing, for archives: direction to 0.1 degree, speed to 0.01 m/s, times to the second, uncertainties.
  /// No centre expects it; every decoder reads it. One message per leg.
  own
};

struct BufrRequest {
  BufrForm form = BufrForm::profiler;
  bool keep_bad = false;  ///< also bins of quality bad
};

/// The messages of a flight, one after the other.
///
/// Up and down where the profile has them, else the merged leg. A bin without a wind is a level whose values are
/// missing (uasdc: it was never anywhere, and is not written); bins of quality bad are left out. Legs of more than 254
/// levels become several messages: 0 31 001 cannot count further. Where a number does not fit its element the value is
/// missing, never another. North is 360; calm is speed 0, direction 0; in the campaign's list a speed whose direction
/// is not known is left out with it. 0 33 003: good 0, doubtful 1, bad 3, else missing; 0 33 002 knows no bad: 1.
///
/// The same input gives the same bytes.
/// Fails as profile_records does, with Kind::no_answer when nothing is left, with Kind::usage for bins below 1 m,
/// whose heights would collide, and with Kind::write_failed when ecCodes does.
/// Source: WMO-No. 306, Vol. I.2, FM 94 BUFR, Tables B and D; synoptic/wmo-uasdc, nc2bufr (2024-06).
ingest::Result<std::string> profile_bufr(const profiles::WindProfile& profile, const estimator::WindSeries& series,
                                         const AirRecord& record, const NetcdfMetadata& metadata,
                                         const BufrRequest& request = {});

}  // namespace quadsonde::product
