#include "profiles/make_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "estimator/smoother/chi_square.h"
#include "profiles/bin_statistics.h"
#include "profiles/legs.h"
#include "profiles/optimal.h"

namespace quadsonde::profiles {
namespace {

using estimator::Reason;
using estimator::WindEstimate;
using estimator::WindSeries;
using ingest::Kind;

/// Where and when the samples of a bin were.
struct Location {
  double agl = 0, msl = 0, lat = 0, lon = 0;
  std::size_t agl_count = 0, msl_count = 0, place_count = 0, utc_count = 0;
  std::int64_t first_utc = 0;
  double utc_sum = 0;  // seconds after first_utc

  void add(const estimator::WindPoint& p) {
    if (p.height_agl) agl += p.height_agl->m, ++agl_count;
    if (p.height_msl) msl += p.height_msl->m, ++msl_count;
    if (p.place) lat += p.place->lat_deg, lon += p.place->lon_deg, ++place_count;
    if (p.utc) {
      if (utc_count == 0) first_utc = p.utc->ns;
      utc_sum += static_cast<double>(p.utc->ns - first_utc) * 1e-9, ++utc_count;
    }
  }
  void into(Bin& bin) const {
    const auto mean = [](double sum, std::size_t n) { return sum / static_cast<double>(n); };
    if (agl_count) bin.height_agl = ingest::GroundHeight{mean(agl, agl_count)};
    if (msl_count) bin.height_msl = ingest::MslHeight{mean(msl, msl_count)};
    if (place_count) bin.place = ingest::GeoPoint{mean(lat, place_count), mean(lon, place_count)};
    if (utc_count) bin.utc = ingest::UtcTime{first_utc} + ingest::seconds(mean(utc_sum, utc_count));
  }
};

/// Turns the parts of one bin and their weights into a row.
class Profiler {
 public:
  Profiler(const WindSeries& series, const ProfileSettings& settings) : series_(series), settings_(settings) {}

  ingest::Result<WindProfile> run() {
    profile_.bin_m = settings_.bin_m;
    profile_.datum = settings_.datum;
    profile_.hub_height = settings_.hub_height;
    if (const auto problem = choose_datum()) return ingest::fail(*problem);
    if (settings_.leg_times.empty()) {
      parts_ = find_parts(series_.points, heights_, settings_.bin_m);
    } else {
      auto named = named_parts(series_.points, settings_.leg_times);
      if (!named) return ingest::fail(named.error());
      parts_ = std::move(*named);
    }
    profile_.found = found_legs(series_, parts_, heights_);
    if (auto note = note_no_climb(parts_, heights_, settings_.bin_m)) profile_.notes.push_back(std::move(*note));
    collect();
    if (low_ > high_)
      return ingest::fail(Kind::no_answer, "no instant of this flight has both a wind and a height", {},
                          "see `quadsonde info` for what the log lacks");
    write_legs();
    if (settings_.method == Method::optimal)
      if (const auto problem = estimate_optimal()) return ingest::fail(*problem);
    return std::move(profile_);
  }

 private:
  std::optional<ingest::Problem> choose_datum() {
    heights_ = heights_in(settings_.datum);
    if (any(heights_)) return std::nullopt;
    const Datum other = settings_.datum == Datum::agl ? Datum::msl : Datum::agl;
    heights_ = heights_in(other);
    if (!any(heights_))
      return ingest::Problem{Kind::missing, "the flight has no height, so there is no profile", {},
                             "log a barometer or GNSS height"};
    profile_.datum = other;
    profile_.problems.push_back(
        {Kind::missing,
         settings_.datum == Datum::agl ? "the height of the take-off point is not known: bins are above mean sea level"
                                       : "the height above mean sea level is not known: bins are above take-off",
         {}, settings_.datum == Datum::agl ? "give --takeoff-msl M to get heights above take-off"
                                           : "log a GNSS height to get heights above sea level"});
    return std::nullopt;
  }

  std::vector<std::optional<double>> heights_in(Datum datum) const {
    std::vector<std::optional<double>> heights;
    heights.reserve(series_.points.size());
    for (const auto& p : series_.points) {
      if (datum == Datum::agl)
        heights.push_back(p.height_agl ? std::optional(p.height_agl->m) : std::nullopt);
      else
        heights.push_back(p.height_msl ? std::optional(p.height_msl->m) : std::nullopt);
    }
    return heights;
  }
  /// Whether a sample belongs to a bin: it has a wind and a height. Less than two metres below the take-off point the
  /// vehicle stands where it started and its barometer's drift and noise go below zero; that makes no bin underground.
  bool counts(std::size_t i) const {
    const auto& p = series_.points[i];
    const bool stands = p.height_agl && p.height_agl->m < 0 && p.height_agl->m > -2;
    return heights_[i] && !stands && std::holds_alternative<WindEstimate>(p.wind);
  }
  static bool any(const std::vector<std::optional<double>>& heights) {
    return std::any_of(heights.begin(), heights.end(), [](const auto& h) { return h.has_value(); });
  }

  void collect() {
    for (std::size_t i = 0; i < series_.points.size(); ++i) {
      if (!counts(i)) continue;
      const int bin = static_cast<int>(std::floor(*heights_[i] / settings_.bin_m));
      members_[static_cast<int>(parts_[i])][bin].push_back(i);
      low_ = std::min(low_, bin);
      high_ = std::max(high_, bin);
    }
  }

  void write_legs() {
    const bool climbs = !members_[0].empty() || !members_[1].empty();
    const auto& d = series_.diagnostics;
    Leg up{LegName::up, {}}, down{LegName::down, {}}, all{LegName::all, {}};
    for (int b = low_; b <= high_; ++b) {
      std::vector<BinMean> means;
      std::vector<std::vector<std::size_t>> behind;  // the samples of each mean
      for (const auto part : {Part::up, Part::down, Part::level}) {
        const auto found = members_[static_cast<int>(part)].find(b);
        const std::vector<std::size_t> none;
        const auto& members = found == members_[static_cast<int>(part)].end() ? none : found->second;
        const BinMean mean = bin_mean(series_, members);
        if (climbs && part == Part::up) add(up, row(b, mean, members), members);
        if (climbs && part == Part::down) add(down, row(b, mean, members), members);
        if (mean.samples) means.push_back(mean), behind.push_back(members);
      }
      if (climbs) test_difference(up.bins.back(), down.bins.back());
      leave_out_doubtful(means, behind);
      std::vector<std::size_t> together;
      for (const auto& members : behind) together.insert(together.end(), members.begin(), members.end());
      std::sort(together.begin(), together.end());
      all_means_.push_back(combined(means, d.sigma_u));
      add(all, row(b, all_means_.back(), together), together);
    }
    if (climbs) profile_.legs = {up, down};
    profile_.legs.push_back(all);
    if (climbs) write_flown();
    close_test();
  }

  /// Each ascent and descent apart. Where there is one of each at most, those are the legs.
  void write_flown() {
    std::vector<std::pair<std::size_t, std::size_t>> stretches;  // first, beyond last
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (parts_[i] == Part::level) continue;
      if (stretches.empty() || stretches.back().second != i || parts_[i] != parts_[i - 1]) stretches.emplace_back(i, i);
      stretches.back().second = i + 1;
    }
    const auto ascents =
        std::count_if(stretches.begin(), stretches.end(), [&](const auto& s) { return parts_[s.first] == Part::up; });
    const bool one_each = ascents <= 1 && static_cast<std::ptrdiff_t>(stretches.size()) - ascents <= 1;
    for (const auto& [first, end] : stretches) {
      const bool up = parts_[first] == Part::up;
      Leg leg = one_each ? profile_.legs[up ? 0 : 1] : bins_of(up ? LegName::up : LegName::down, first, end);
      if (leg_has_samples(leg)) profile_.flown.push_back(std::move(leg));
    }
  }

  static bool leg_has_samples(const Leg& leg) {
    return std::any_of(leg.bins.begin(), leg.bins.end(), [](const Bin& bin) { return bin.samples > 0; });
  }

  Leg bins_of(LegName name, std::size_t first, std::size_t end) const {
    std::map<int, std::vector<std::size_t>> members;
    for (std::size_t i = first; i < end; ++i)
      if (counts(i))
        members[static_cast<int>(std::floor(*heights_[i] / settings_.bin_m))].push_back(i);
    Leg leg{name, {}};
    for (int b = low_; b <= high_; ++b) add(leg, row(b, bin_mean(series_, members[b]), members[b]), members[b]);
    return leg;
  }

  /// @param members  in the order of time
  void add(Leg& leg, Bin bin, const std::vector<std::size_t>& members) const {
    leg.bins.push_back(std::move(bin));
    if (members.empty()) return;
    const auto &first = series_.points[members.front()].utc, &last = series_.points[members.back()].utc;
    if (!first || !last) return;
    leg.utc_from = leg.utc_from ? std::min(*leg.utc_from, *first) : *first;
    leg.utc_to = leg.utc_to ? std::max(*leg.utc_to, *last) : *last;
  }

  /// Doubtful parts of a bin, such as a fast descent, count only where no other is.
  static void leave_out_doubtful(std::vector<BinMean>& means, std::vector<std::vector<std::size_t>>& behind) {
    const auto doubtful = [](const BinMean& m) { return m.doubtful_share > 0.5; };
    if (std::all_of(means.begin(), means.end(), doubtful)) return;
    for (std::size_t i = means.size(); i-- > 0;) {
      if (!doubtful(means[i])) continue;
      means.erase(means.begin() + static_cast<std::ptrdiff_t>(i));
      behind.erase(behind.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }

  /// Covariance-weighted mean of the parts of a bin.
  BinMean combined(const std::vector<BinMean>& means, double sigma_u) const {
    if (means.empty()) return {};
    if (means.size() == 1) return means.front();
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
    std::vector<Eigen::Matrix2d> weights;
    for (const auto& m : means) {
      const double sampling = sampling_variance(sigma_u, time_u(), m.seconds);
      weights.push_back((m.noise + sampling * Eigen::Matrix2d::Identity()).inverse());
      information += weights.back();
    }
    BinMean out;
    out.turbulence.setZero();
    for (std::size_t i = 0; i < means.size(); ++i) {
      const auto& m = means[i];
      const Eigen::Matrix2d W = information.inverse() * weights[i];
      out.wind += W * m.wind;
      out.noise += W * m.noise * W.transpose();
      out.per_trim += W * m.per_trim;
      out.trim = m.trim;
      out.per_parameter += W * m.per_parameter;
      out.turbulence += m.turbulence * m.seconds;
      out.seconds += m.seconds;
      out.samples += m.samples;
      out.effective_samples += m.effective_samples;
      out.reasons.add(m.reasons);
      out.doubtful_share += m.doubtful_share * static_cast<double>(m.samples);
      out.bad_share += m.bad_share * static_cast<double>(m.samples);
    }
    out.turbulence /= std::max(out.seconds, 1e-9);
    out.doubtful_share /= static_cast<double>(out.samples);
    out.bad_share /= static_cast<double>(out.samples);
    return out;
  }

  /// The rows of `all` become nodes of a profile that is estimated as such; the legs' bins have no part in it.
  std::optional<ingest::Problem> estimate_optimal() {
    if (!series_.trace)
      return ingest::Problem{ingest::Kind::usage, "--method optimal needs the smoothed wind", {},
                             "leave --mode out, or take --method bins"};
    NodeSettings nodes;
    nodes.spacing = settings_.bin_m;
    nodes.lowest = (low_ + 0.5) * settings_.bin_m;
    nodes.count = static_cast<std::size_t>(high_ - low_ + 1);
    nodes.height_psd = settings_.height_psd;
    if (nodes.count > most_nodes)
      return ingest::Problem{ingest::Kind::usage,
                             fmt::format("--method optimal: {} nodes are too many", nodes.count), {},
                             fmt::format("take larger bins with --bin-m, so that there are at most {}", most_nodes)};
    const auto estimate = estimate_nodes(*series_.trace, heights_, nodes);
    Leg leg = profile_.legs.back();
    profile_.legs = {};
    profile_.flown = {};
    for (std::size_t i = 0; i < leg.bins.size(); ++i) fill_node(leg.bins[i], estimate, i);
    profile_.legs.push_back(std::move(leg));
    profile_.method = Method::optimal;
    profile_.optimal = OptimalDetails{{}, estimate.kernel, estimate.kernel.trace()};
    for (std::size_t i = 0; i < nodes.count; ++i)
      profile_.optimal->height.push_back(nodes.lowest + static_cast<double>(i) * nodes.spacing);
    return std::nullopt;
  }

  /// What is not a state of the node filter (drag, heading, a frozen trim) is taken over from the nearest bin mean.
  void fill_node(Bin& bin, const NodeEstimate& estimate, std::size_t i) const {
    const auto at = static_cast<Eigen::Index>(i);
    const BinMean& mean = all_means_[nearest_with_samples(i)];
    WindEstimate wind;
    wind.v_NA_N = estimate.wind.col(at);
    const Eigen::Matrix2d noise = estimate.covariance.block<2, 2>(2 * at, 2 * at);
    const Eigen::Matrix2d calibration = mean.per_parameter * series_.trace->consider * mean.per_parameter.transpose();
    wind.covariance = noise + calibration;
    if (!series_.trace->trim_is_state) wind.covariance += mean.trim_part();
    bin.wind = wind;
    bin.sd_noise = std::sqrt(noise.trace() / 2);
    bin.sd_sampling = std::nullopt;  // turbulence is apart from the nodes: a node is the mean state already
    bin.effective_samples = std::nullopt;
    bin.freedom = estimate.kernel(at, at);
    bin.resolution_m = estimate.resolution(i, settings_.bin_m);
    // Of such a node nine tenths are prior.
    if (*bin.freedom < 0.1) bin.reasons.add(Reason::few_samples);
    if (bin.quality == Quality::none) bin.reasons = mean.reasons, bin.reasons.add(Reason::few_samples);
    bin.quality = std::max(mean.bad_share > 0.5 ? Quality::bad : Quality::good, bin.reasons.at_best());
    if (bin.quality == Quality::none) bin.quality = Quality::doubtful;
  }

  std::size_t nearest_with_samples(std::size_t i) const {
    std::size_t best = i, distance = SIZE_MAX;
    for (std::size_t k = 0; k < all_means_.size(); ++k) {
      const std::size_t d = k > i ? k - i : i - k;
      if (all_means_[k].samples && d < distance) best = k, distance = d;
    }
    return best;
  }

  static constexpr std::size_t most_nodes = 200;

  double time_u() const { return series_.trace ? series_.trace->turbulence_time : 10; }

  Bin row(int index, const BinMean& mean, const std::vector<std::size_t>& members) const {
    Bin bin;
    bin.bottom = index * settings_.bin_m;
    bin.top = bin.bottom + settings_.bin_m;
    Location location;
    for (const auto i : members) location.add(series_.points[i]);
    location.into(bin);
    if (mean.samples == 0) {
      bin.reasons.add(Reason::no_samples);
      const double middle = (bin.bottom + bin.top) / 2;
      if (profile_.datum == Datum::agl)
        bin.height_agl = ingest::GroundHeight{middle};
      else
        bin.height_msl = ingest::MslHeight{middle};
      return bin;
    }
    fill(bin, mean);
    bin.spread_from_deg = direction_spread(series_, members);
    return bin;
  }

  void fill(Bin& bin, const BinMean& mean) const {
    WindEstimate wind;
    wind.v_NA_N = mean.wind;
    wind.has_covariance = series_.mode != estimator::Mode::classic;
    bin.samples = mean.samples;
    bin.reasons = mean.reasons;
    if (series_.trace) {
      const auto& C = series_.trace->consider;
      const Eigen::Matrix2d calibration = mean.per_parameter * C * mean.per_parameter.transpose();
      const Eigen::Matrix2d trim = mean.trim_part();
      wind.covariance = mean.noise + trim + calibration;
      bin.sd_calibration = std::sqrt(std::max(0.0, calibration.trace() / 2));
      bin.sd_trim = std::sqrt(std::max(0.0, trim.trace() / 2));
      bin.sd_noise = std::sqrt(std::max(0.0, mean.noise.trace() / 2));
      const auto law = mean.per_parameter.middleCols<2>(estimator::c_climb_linear);
      const Eigen::Matrix2d climb = C.block<2, 2>(estimator::c_climb_linear, estimator::c_climb_linear);
      bin.sd_climb_law = std::sqrt(std::max(0.0, (law * climb * law.transpose()).trace() / 2));
      bin.sd_sampling = std::sqrt(sampling_variance(series_.diagnostics.sigma_u, time_u(), mean.seconds));
      bin.effective_samples = mean.effective_samples;
      // Shorter than two correlation times, a bin tells nothing of its turbulence.
      if (mean.seconds >= 2 * time_u()) bin.sigma = mean.turbulence.cwiseSqrt();
    } else {
      wind.covariance = mean.noise;
    }
    bin.wind = wind;
    bool doubtful = mean.doubtful_share > 0.5;
    if (mean.samples < 10 || (series_.trace && mean.effective_samples < 1)) {
      bin.reasons.add(Reason::few_samples);
      doubtful = true;
    }
    const double widest = std::sqrt(std::max(wind.covariance(0, 0), wind.covariance(1, 1)));
    if (widest > 1 && widest > 0.3 * mean.wind.norm()) {
      bin.reasons.add(Reason::wide_uncertainty);
      doubtful = true;
    }
    bin.quality = mean.bad_share > 0.5 ? Quality::bad : doubtful ? Quality::doubtful : Quality::good;
  }

  /// chi2 = d' (C_up + C_down + turbulence)^-1 d, bin by bin.
  void test_difference(const Bin& up, const Bin& down) {
    const auto* a = std::get_if<WindEstimate>(&up.wind);
    const auto* b = std::get_if<WindEstimate>(&down.wind);
    if (!a || !b || !up.sd_sampling || !down.sd_sampling) return;
    const double sampling = std::pow(*up.sd_sampling, 2) + std::pow(*down.sd_sampling, 2);
    const Eigen::Matrix2d C = a->covariance + b->covariance + sampling * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d d = a->v_NA_N - b->v_NA_N;
    chi2_ += d.dot(C.inverse() * d);
    dof_ += 2;
  }

  void close_test() {
    if (dof_ == 0) return;
    profile_.up_down = UpDownTest{chi2_, dof_, estimator::chi_square_tail(chi2_, dof_)};
    if (profile_.up_down->p_value > 0.01) return;
    for (auto* legs : {&profile_.legs, &profile_.flown})
      for (auto& leg : *legs)
        for (auto& bin : leg.bins)
          if (bin.samples) {
            bin.reasons.add(Reason::up_down_differ);
            bin.quality = std::max(bin.quality, estimator::at_best(Reason::up_down_differ));
          }
    profile_.problems.push_back({Kind::doubtful,
                                 fmt::format("ascent and descent differ by more than their uncertainties (chi-square {:.0f} "
                                             "for {} degrees of freedom)", chi2_, dof_),
                                 {}, "compare the up and down legs before you use `all`; a slower descent differs less"});
  }

  const WindSeries& series_;
  const ProfileSettings& settings_;
  WindProfile profile_;
  std::vector<std::optional<double>> heights_;
  std::vector<Part> parts_;
  std::array<std::map<int, std::vector<std::size_t>>, 3> members_;
  std::vector<BinMean> all_means_;  ///< of the rows of `all`
  int low_ = 1 << 30, high_ = -(1 << 30);
  double chi2_ = 0;
  int dof_ = 0;
};

}  // namespace

ingest::Result<WindProfile> make_profile(const WindSeries& series, const ProfileSettings& settings) {
  return Profiler(series, settings).run();
}

}  // namespace quadsonde::profiles
