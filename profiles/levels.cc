#include "profiles/levels.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace quadsonde::profiles {
namespace {

using estimator::WindEstimate;

constexpr double von_karman = 0.40;
constexpr double gravity = 9.80665;
constexpr double kappa_dry = 0.2857;  // R / c_p of dry air

double middle(const Bin& bin) { return (bin.bottom + bin.top) / 2; }
const WindEstimate* usable(const Bin& bin) {
  return bin.quality == Quality::bad ? nullptr : std::get_if<WindEstimate>(&bin.wind);
}

/// Covariance of a bin's wind as the mean state at its height.
Eigen::Matrix2d mean_state_covariance(const Bin& bin, const WindEstimate& wind) {
  const double sampling = bin.sd_sampling.value_or(0);
  return wind.covariance + sampling * sampling * Eigen::Matrix2d::Identity();
}

/// 1-sigma share of the speed that the calibration leaves open, alike in all bins: nearly all of its part lies along
/// the wind, sd_calibration is that over both components.
double shared_part(const Bin& bin, const WindEstimate& wind) {
  const double along = std::sqrt(2.0) * bin.sd_calibration.value_or(0), speed = wind.v_NA_N.norm();
  if (speed < 1e-6) return 0;
  const Eigen::Vector2d e = wind.v_NA_N / speed;
  return std::min(along, std::sqrt(std::max(0.0, 0.9999 * e.dot(wind.covariance * e)))) / speed;
}

/// A covariance without the part along the wind that all heights share.
Eigen::Matrix2d without_shared(const WindEstimate& wind, double shared) {
  return wind.covariance - shared * shared * wind.v_NA_N * wind.v_NA_N.transpose();
}

struct SpeedAt {
  double height, speed, sd, shared;
};
double mean_shared(const std::vector<SpeedAt>& all) {
  double sum = 0;
  for (const auto& s : all) sum += s.shared;
  return all.empty() ? 0 : sum / static_cast<double>(all.size());
}
/// Bins with a wind between two heights, with the sd of their speed as the mean state's, the shared part left out.
std::vector<SpeedAt> speeds(const Leg& leg, double lowest, double highest) {
  std::vector<SpeedAt> all;
  for (const auto& bin : leg.bins) {
    const auto* wind = usable(bin);
    const double z = bin.height_agl ? bin.height_agl->m : middle(bin);
    if (!wind || !wind->has_covariance || z < lowest || z > highest) continue;
    auto whole = *wind;
    const double shared = shared_part(bin, *wind);
    whole.covariance = mean_state_covariance(bin, *wind) + without_shared(*wind, shared) - wind->covariance;
    const double sd = estimator::speed_sd(whole);
    if (wind->v_NA_N.norm() > 0.2) all.push_back({z, wind->v_NA_N.norm(), std::max(sd, 0.01), shared});
  }
  return all;
}
bool wide_enough(const std::vector<SpeedAt>& all) {
  return all.size() >= 3 && all.back().height >= 2 * all.front().height;
}

/// Weighted straight line y = a + b x; covariance from the weights, widened where the points scatter more.
struct Line {
  double a = 0, b = 0;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};
Line fit_line(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& sd) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Eigen::Vector2d row(1, x[i]);
    normal += row * row.transpose() / (sd[i] * sd[i]);
    right += row * y[i] / (sd[i] * sd[i]);
  }
  Line line;
  const Eigen::Matrix2d inverse = normal.inverse();
  const Eigen::Vector2d solution = inverse * right;
  line.a = solution.x(), line.b = solution.y();
  double chi2 = 0;
  for (std::size_t i = 0; i < x.size(); ++i) chi2 += std::pow((y[i] - line.a - line.b * x[i]) / sd[i], 2);
  line.covariance = inverse * std::max(1.0, chi2 / static_cast<double>(x.size() - 2));
  return line;
}

double potential_temperature(const Bin& bin) { return *bin.temperature_k * std::pow(1e5 / *bin.pressure_pa, kappa_dry); }

/// Index of the speed's maximum and the drop above it, if that is a jet.
struct Nose {
  std::size_t at;
  double drop;
};
std::optional<Nose> find_nose(const std::vector<SpeedAt>& s) {
  for (std::size_t i = 1; i + 1 < s.size(); ++i) {
    if (s[i].speed < s[i - 1].speed || s[i].speed < s[i + 1].speed) continue;
    // The minimum above, up to where the speed is higher than here again.
    double least = s[i].speed;
    for (std::size_t k = i + 1; k < s.size() && s[k].speed <= s[i].speed; ++k) least = std::min(least, s[k].speed);
    if (s[i].speed - least >= 2 && s[i].speed >= 1.25 * least) return Nose{i, s[i].speed - least};
  }
  return std::nullopt;
}

/// Of the take-off point in the profile's datum.
std::optional<double> height_of_takeoff(const WindProfile& profile) {
  if (profile.datum == Datum::agl) return 0;
  for (const auto& leg : profile.legs)
    for (const auto& bin : leg.bins)
      if (bin.height_agl && bin.height_msl) return bin.height_msl->m - bin.height_agl->m;
  return std::nullopt;
}

std::vector<double> all_heights(const WindProfile& profile, const LevelSettings& settings) {
  auto heights = settings.heights;
  if (profile.hub_height) heights.push_back(*profile.hub_height);
  std::sort(heights.begin(), heights.end());
  heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
  return heights;
}

std::vector<LevelWind> above_takeoff(const Leg& leg, std::vector<double> heights, double takeoff) {
  for (auto& height : heights) height += takeoff;
  auto winds = winds_at(leg, heights);
  for (auto& level : winds) level.height -= takeoff;
  return winds;
}

}  // namespace

std::vector<LevelWind> winds_at(const Leg& leg, const std::vector<double>& heights) {
  std::vector<LevelWind> all;
  for (const double z : heights) {
    LevelWind level{z, std::nullopt};
    for (std::size_t i = 0; i < leg.bins.size(); ++i) {
      const auto& bin = leg.bins[i];
      const auto* here = usable(bin);
      if (!here || z < bin.bottom || z >= bin.top) continue;
      const bool above = z >= middle(bin);
      const std::size_t k = above ? i + 1 : i - 1;
      const auto* there = k < leg.bins.size() ? usable(leg.bins[k]) : nullptr;
      level.wind = *here;
      level.shared = shared_part(bin, *here);
      if (!there) break;
      const double w = std::abs(z - middle(bin)) / (bin.top - bin.bottom);
      level.wind->v_NA_N = (1 - w) * here->v_NA_N + w * there->v_NA_N;
      // Neighbours share most of their error: the mean of the covariances, not that of independent values.
      level.wind->covariance = (1 - w) * here->covariance + w * there->covariance;
      break;
    }
    all.push_back(std::move(level));
  }
  return all;
}

std::optional<Shear> shear_between(const LevelWind& lower, const LevelWind& upper) {
  if (!lower.wind || !upper.wind || upper.height <= lower.height) return std::nullopt;
  const double dz = upper.height - lower.height;
  const Eigen::Vector2d d = upper.wind->v_NA_N - lower.wind->v_NA_N;
  const double shared = (lower.shared + upper.shared) / 2;
  WindEstimate difference{d, without_shared(*lower.wind, lower.shared) + without_shared(*upper.wind, upper.shared),
                          true};
  const double sd = std::hypot(estimator::speed_sd(difference), shared * d.norm());
  Shear shear{lower.height, upper.height, {d.norm() / dz, sd / dz}, std::nullopt};
  const auto from = estimator::to_report(*lower.wind).from_deg, to = estimator::to_report(*upper.wind).from_deg;
  const auto sd_from = estimator::direction_sd_deg(*lower.wind), sd_to = estimator::direction_sd_deg(*upper.wind);
  if (from && to && sd_from && sd_to)
    shear.veer = Uncertain{std::remainder(*to - *from, 360.0), std::hypot(*sd_from, *sd_to)};
  return shear;
}

std::optional<PowerLaw> power_law(const Leg& leg) {
  const auto all = speeds(leg, 5, 150);
  if (!wide_enough(all)) return std::nullopt;
  std::vector<double> x, y, sd;
  for (const auto& s : all) x.push_back(std::log(s.height / 10)), y.push_back(std::log(s.speed)), sd.push_back(s.sd / s.speed);
  const auto line = fit_line(x, y, sd);
  const double v = std::exp(line.a);
  return PowerLaw{{line.b, std::sqrt(line.covariance(1, 1))},
                  {v, v * std::hypot(std::sqrt(line.covariance(0, 0)), mean_shared(all))},
                  all.size()};
}

std::optional<LogLaw> log_law(const Leg& leg) {
  const auto all = speeds(leg, 5, 100);
  if (!wide_enough(all)) return std::nullopt;
  std::vector<double> x, y, sd;
  for (const auto& s : all) x.push_back(std::log(s.height)), y.push_back(s.speed), sd.push_back(s.sd);
  const auto line = fit_line(x, y, sd);
  if (line.b <= 0) return std::nullopt;  // a speed that falls with height has no roughness
  LogLaw law;
  law.friction_velocity = {von_karman * line.b,
                           von_karman * std::hypot(std::sqrt(line.covariance(1, 1)), line.b * mean_shared(all))};
  // ln z0 = -a / b
  const Eigen::Vector2d gradient(-1 / line.b, line.a / (line.b * line.b));
  law.log_roughness = {-line.a / line.b, std::sqrt(gradient.dot(line.covariance * gradient))};
  law.roughness = std::exp(law.log_roughness.value);
  law.bins = all.size();
  return law;
}

std::optional<Jet> low_level_jet(const Leg& leg) {
  const auto all = speeds(leg, 5, 1500);
  const auto nose = find_nose(all);
  if (!nose) return std::nullopt;
  const auto& top = all[nose->at];
  Jet jet{top.height, {top.speed, std::hypot(top.sd, top.shared * top.speed)}, nose->drop, 0};
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  constexpr int draws = 1000;
  int found = 0;
  for (int d = 0; d < draws; ++d) {
    auto drawn = all;
    for (auto& s : drawn) s.speed = std::abs(s.speed + s.sd * normal(random));
    const auto again = find_nose(drawn);
    found += again && std::abs(drawn[again->at].height - jet.height) <= 30;
  }
  jet.probability = static_cast<double>(found) / draws;
  return jet;
}

std::optional<BulkRichardson> bulk_richardson(const Leg& leg) {
  const Bin *low = nullptr, *high = nullptr;
  for (const auto& bin : leg.bins) {
    if (!usable(bin) || !bin.temperature_k || !bin.pressure_pa) continue;
    if (!low) low = &bin;
    high = &bin;
  }
  if (!low || low == high) return std::nullopt;
  const double dz = middle(*high) - middle(*low);
  const auto &a = *usable(*low), &b = *usable(*high);
  const Eigen::Vector2d d = b.v_NA_N - a.v_NA_N;
  const double square = d.squaredNorm();
  if (square < 0.01) return std::nullopt;  // no shear, no number
  const double theta_low = potential_temperature(*low), theta_high = potential_temperature(*high);
  const double ri = gravity / (0.5 * (theta_low + theta_high)) * (theta_high - theta_low) * dz / square;
  const double shared_a = shared_part(*low, a), shared_b = shared_part(*high, b);
  const double sd_speed =
      std::hypot(estimator::speed_sd({d, without_shared(a, shared_a) + without_shared(b, shared_b), true}),
                 (shared_a + shared_b) / 2 * std::sqrt(square));
  return BulkRichardson{middle(*low), middle(*high), {ri, std::abs(ri) * 2 * sd_speed / std::sqrt(square)}};
}

ProfileLevels describe_levels(const WindProfile& profile, const LevelSettings& settings) {
  ProfileLevels levels;
  const Leg* leg = nullptr;
  for (const auto& candidate : profile.legs)
    if (!leg || candidate.name == LegName::all) leg = &candidate;
  if (!leg) return levels;
  if (const auto takeoff = height_of_takeoff(profile))
    levels.winds = above_takeoff(*leg, all_heights(profile, settings), *takeoff);
  const LevelWind* below = nullptr;
  for (const auto& level : levels.winds) {
    if (!level.wind) continue;
    if (below)
      if (auto shear = shear_between(*below, level)) levels.shears.push_back(*shear);
    below = &level;
  }
  if (profile.datum != Datum::agl) return levels;
  levels.power = power_law(*leg);
  levels.log = log_law(*leg);
  levels.jet = low_level_jet(*leg);
  levels.richardson = bulk_richardson(*leg);
  return levels;
}

}  // namespace quadsonde::profiles
