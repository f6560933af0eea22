#include "profiles/merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "estimator/smoother/chi_square.h"
#include "ingest/flight/local_frame.h"

namespace quadsonde::profiles {
namespace {

using estimator::Reason;
using estimator::WindEstimate;
using ingest::fail;
using ingest::Kind;

struct Member {
  const Bin* bin;
  const WindEstimate* wind;
  Eigen::Matrix2d covariance;  ///< as the mean state's
};

const Leg* whole(const WindProfile& profile) {
  for (const auto& leg : profile.legs)
    if (leg.name == LegName::all) return &leg;
  return nullptr;
}

std::optional<ingest::GeoPoint> place_of(const WindProfile& profile) {
  for (const auto& leg : profile.legs)
    for (const auto& bin : leg.bins)
      if (bin.place) return bin.place;
  return std::nullopt;
}

double farthest(const std::vector<const WindProfile*>& profiles) {
  double most = 0;
  for (std::size_t i = 0; i < profiles.size(); ++i)
    for (std::size_t k = i + 1; k < profiles.size(); ++k) {
      const auto a = place_of(*profiles[i]), b = place_of(*profiles[k]);
      if (a && b) most = std::max(most, ingest::distance_m(*a, *b));
    }
  return most;
}

double hours_between(const std::vector<const WindProfile*>& profiles) {
  std::optional<ingest::UtcTime> first, last;
  for (const auto* profile : profiles)
    for (const auto& bin : whole(*profile)->bins)
      if (bin.utc) {
        first = first ? std::min(*first, *bin.utc) : *bin.utc;
        last = last ? std::max(*last, *bin.utc) : *bin.utc;
      }
  return first ? static_cast<double>(last->ns - first->ns) * 1e-9 / 3600 : 0;
}

ingest::Problem usage(std::string what, std::string hint) {
  return ingest::Problem{Kind::usage, std::move(what), {}, std::move(hint)};
}

std::optional<ingest::Problem> why_not(const std::vector<const WindProfile*>& profiles, const MergeSettings& settings) {
  if (profiles.size() < 2) return usage("only one flight has a profile: there is nothing to merge", "give two logs or more");
  for (const auto* profile : profiles)
    if (!whole(*profile)) return usage("a profile has no row of the whole flight", "leave --leg out when merging");
  return why_not_one_site(profiles, settings);
}

/// Mean of what is known in the bins of all flights.
void locate(Bin& out, const std::vector<Member>& members) {
  double agl = 0, msl = 0, lat = 0, lon = 0, seconds = 0, n_agl = 0, n_msl = 0, n_place = 0, n_utc = 0;
  std::int64_t first = 0;
  for (const auto& m : members) {
    if (m.bin->height_agl) agl += m.bin->height_agl->m, ++n_agl;
    if (m.bin->height_msl) msl += m.bin->height_msl->m, ++n_msl;
    if (m.bin->place) lat += m.bin->place->lat_deg, lon += m.bin->place->lon_deg, ++n_place;
    if (m.bin->utc) {
      if (n_utc == 0) first = m.bin->utc->ns;
      seconds += static_cast<double>(m.bin->utc->ns - first) * 1e-9, ++n_utc;
    }
  }
  if (n_agl > 0) out.height_agl = ingest::GroundHeight{agl / n_agl};
  if (n_msl > 0) out.height_msl = ingest::MslHeight{msl / n_msl};
  if (n_place > 0) out.place = ingest::GeoPoint{lat / n_place, lon / n_place};
  if (n_utc > 0) out.utc = ingest::UtcTime{first} + ingest::seconds(seconds / n_utc);
}

/// One vehicle's calibration does not average out over its flights. It acts along the wind, and of it the mean has
/// 1 / N already; from flight to flight the drag varies too, so this errs to the wide side.
Eigen::Matrix2d common_part(const std::vector<Member>& members, const Eigen::Vector2d& wind) {
  double variance = 0;
  const auto n = static_cast<double>(members.size());
  for (const auto& m : members) variance += 2 * std::pow(m.bin->sd_calibration.value_or(0), 2) / n;
  if (wind.norm() < 1e-6) return Eigen::Matrix2d::Zero();
  const Eigen::Vector2d along = wind.normalized();
  return variance * (1 - 1 / n) * along * along.transpose();
}

/// Covariance-weighted mean of one bin over the flights.
Bin merge_bin(const std::vector<Member>& members, double bottom, double top, SpreadTest& spread) {
  Bin out;
  out.bottom = bottom, out.top = top;
  if (members.empty()) {
    out.reasons.add(Reason::no_samples);
    return out;
  }
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  bool doubtful = true;
  for (const auto& m : members) {
    const Eigen::Matrix2d weight = m.covariance.inverse();
    information += weight;
    sum += weight * m.wind->v_NA_N;
    out.samples += m.bin->samples;
    out.reasons.add(m.bin->reasons);
    doubtful = doubtful && m.bin->quality != Quality::good;
  }
  WindEstimate wind;
  wind.covariance = information.inverse();
  wind.v_NA_N = wind.covariance * sum;
  const Eigen::Matrix2d common = common_part(members, wind.v_NA_N);
  double chi2 = 0;
  for (const auto& m : members) {
    const Eigen::Vector2d d = m.wind->v_NA_N - wind.v_NA_N;
    chi2 += d.dot(m.covariance.inverse() * d);
  }
  const int dof = 2 * static_cast<int>(members.size() - 1);
  spread.chi2 += chi2;
  spread.degrees_of_freedom += dof;
  out.quality = doubtful ? Quality::doubtful : Quality::good;
  if (dof > 0 && estimator::chi_square_tail(chi2, dof) < 1e-3) {
    wind.covariance *= chi2 / dof;
    out.quality = Quality::doubtful;
  }
  wind.covariance += common;
  out.wind = wind;
  out.effective_samples = static_cast<double>(members.size());
  locate(out, members);
  return out;
}

}  // namespace

std::optional<ingest::Problem> why_not_one_site(const std::vector<const WindProfile*>& profiles,
                                                const MergeSettings& settings) {
  for (const auto* profile : profiles)
    if (profile->bin_m != profiles.front()->bin_m || profile->datum != profiles.front()->datum)
      return usage("the profiles have other bins or another datum of heights",
                   "merge with --datum msl and one --bin-m");
  const double far = farthest(profiles);
  if (far > 1000 * settings.farthest_km)
    return usage(fmt::format("the flights are {:.0f} km apart: that is two sites, not one profile", far / 1000),
                 "merge the flights of one site");
  return std::nullopt;
}

ingest::Result<MergedProfile> merge_profiles(const std::vector<const WindProfile*>& profiles,
                                             const MergeSettings& settings) {
  if (const auto problem = why_not(profiles, settings)) return fail(*problem);
  std::map<std::int64_t, std::vector<Member>> bins;  // by index, bottom / bin_m
  const double bin_m = profiles.front()->bin_m;
  for (const auto* profile : profiles)
    for (const auto& bin : whole(*profile)->bins) {
      auto& members = bins[std::llround(bin.bottom / bin_m)];
      const auto* wind = std::get_if<WindEstimate>(&bin.wind);
      if (!wind || !wind->has_covariance || bin.quality == Quality::bad) continue;
      const double sampling = bin.sd_sampling.value_or(0);
      members.push_back({&bin, wind, wind->covariance + sampling * sampling * Eigen::Matrix2d::Identity()});
    }
  MergedProfile merged;
  merged.profile.datum = profiles.front()->datum;
  merged.profile.bin_m = bin_m;
  merged.profile.hub_height = profiles.front()->hub_height;
  Leg leg;
  for (auto index = bins.begin()->first; index <= bins.rbegin()->first; ++index)
    leg.bins.push_back(merge_bin(bins[index], static_cast<double>(index) * bin_m, static_cast<double>(index + 1) * bin_m,
                                 merged.spread));
  for (const auto* profile : profiles) {
    const auto* all = whole(*profile);
    if (all->utc_from) leg.utc_from = leg.utc_from ? std::min(*leg.utc_from, *all->utc_from) : *all->utc_from;
    if (all->utc_to) leg.utc_to = leg.utc_to ? std::max(*leg.utc_to, *all->utc_to) : *all->utc_to;
  }
  merged.profile.legs.push_back(std::move(leg));
  merged.spread.p_value = estimator::chi_square_tail(merged.spread.chi2, merged.spread.degrees_of_freedom);
  merged.hours = hours_between(profiles);
  merged.farthest_m = farthest(profiles);
  if (merged.spread.p_value < 0.01)
    merged.profile.problems.push_back(
        {Kind::doubtful,
         fmt::format("the flights differ by more than their uncertainties (chi-square {:.0f} for {} degrees of freedom "
                     "over {:.1f} h)",
                     merged.spread.chi2, merged.spread.degrees_of_freedom, merged.hours),
         {},
         "the weather changed between them, or the vehicle's drag: look at the flights one by one"});
  return merged;
}

}  // namespace quadsonde::profiles
