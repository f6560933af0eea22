#include "export/archive/regrid.h"

#include <algorithm>
#include <cmath>

namespace quadsonde::product {
namespace {

/// Bins of a profile that lie in one bin of the grid.
class Mean {
 public:
  /// @param overlap  length that both share [m]; @param height of the profile's bin [m]
  void add(const StoredBin& bin, double overlap, double height) {
    if (!bin.has_wind()) return;
    weight_ += overlap;
    east_ += overlap * *bin.east, north_ += overlap * *bin.north;
    samples_ += static_cast<double>(bin.samples) * overlap / height;
    has_errors_ = has_errors_ && bin.se_east && bin.se_north;
    if (has_errors_) {
      const double se_e = *bin.se_east, se_n = *bin.se_north;
      se_east_ += overlap * se_e, se_north_ += overlap * se_n;
      if (se_e * se_n > 0) correlation_ += overlap * bin.covariance.value_or(0) / (se_e * se_n);
    }
    // 1 good, 3 doubtful, 4 bad: the worst is the largest.
    worst_ = std::max(worst_, bin.quality);
    reasons_.add(bin.reasons);
  }

  StoredBin bin(double height) const {
    StoredBin out;
    if (weight_ < 0.5 * height) return out;
    out.east = east_ / weight_, out.north = north_ / weight_;
    out.speed = std::hypot(*out.east, *out.north);
    out.samples = std::max<std::int64_t>(1, std::llround(samples_));
    if (has_errors_) {
      out.se_east = se_east_ / weight_, out.se_north = se_north_ / weight_;
      out.covariance = std::clamp(correlation_ / weight_, -1.0, 1.0) * *out.se_east * *out.se_north;
    }
    out.quality = worst_, out.reasons = reasons_;
    return out;
  }

 private:
  double weight_ = 0, east_ = 0, north_ = 0, samples_ = 0, se_east_ = 0, se_north_ = 0, correlation_ = 0;
  bool has_errors_ = true;
  int worst_ = 1;
  estimator::Reasons reasons_;
};

}  // namespace

std::vector<StoredBin> regrid(const StoredProfile& profile, const StoredRecord& record, double zero,
                              const std::vector<double>& edges) {
  // Less than a millimetre is rounding, not overlap.
  constexpr double least = 1e-3;
  std::vector<StoredBin> bins;
  std::size_t from = 0;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const double bottom = edges[i] + zero, top = edges[i + 1] + zero;
    while (from < record.bins.size() && profile.top_msl_m[from] <= bottom + least) ++from;
    Mean mean;
    for (auto k = from; k < record.bins.size() && profile.bottom_msl_m[k] < top - least; ++k) {
      const double low = std::max(bottom, profile.bottom_msl_m[k]), high = std::min(top, profile.top_msl_m[k]);
      if (high - low > least) mean.add(record.bins[k], high - low, profile.top_msl_m[k] - profile.bottom_msl_m[k]);
    }
    bins.push_back(mean.bin(top - bottom));
  }
  return bins;
}

estimator::MaybeWind wind_of(const StoredBin& bin) {
  if (!bin.has_wind()) return estimator::NoEstimate{estimator::Reason::no_samples};
  estimator::WindEstimate wind;
  wind.v_NA_N = {*bin.north, *bin.east};
  wind.has_covariance = bin.se_east && bin.se_north;
  if (wind.has_covariance) {
    const double covariance = bin.covariance.value_or(0);
    wind.covariance << *bin.se_north * *bin.se_north, covariance, covariance, *bin.se_east * *bin.se_east;
  }
  return wind;
}

}  // namespace quadsonde::product
