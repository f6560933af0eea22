#include "profiles/bin_statistics.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace quadsonde::profiles {
namespace {

using estimator::i_b;
using estimator::i_u;
using estimator::i_W;
using estimator::SmootherTrace;
using estimator::WindEstimate;
using Columns = Eigen::Matrix<double, 8, 2>;

/// H' with H picking W + u.
Columns wind_columns(const estimator::StateMatrix<double>& P) { return P.middleCols<2>(i_W) + P.middleCols<2>(i_u); }
Eigen::Matrix2d wind_rows(const Columns& c) { return c.middleRows<2>(i_W) + c.middleRows<2>(i_u); }

/// Sum over all pairs of members of the covariance of their winds. Backward from the last member to the first:
/// a_k = Cov(x_k, sum of the members' winds after k) = G_k (1_{k+1} P_{k+1} H' + a_{k+1}).
Eigen::Matrix2d pair_covariance(const SmootherTrace& trace, const std::vector<std::size_t>& active) {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  if (active.empty()) return sum;
  Columns after = Columns::Zero();
  std::size_t next_member = active.size();
  for (std::size_t k = active.back() + 1; k-- > active.front();) {
    const auto& step = trace.steps[k];
    if (k < active.back()) after = (step.gain * after).eval();
    if (next_member == 0 || active[next_member - 1] != k) continue;
    --next_member;
    const Columns own = wind_columns(step.P);
    const Eigen::Matrix2d with_later = wind_rows(after);
    sum += wind_rows(own) + with_later + with_later.transpose();
    after += own;
  }
  return sum;
}

void add_trace_part(const SmootherTrace& trace, const std::vector<std::size_t>& active, BinMean& bin) {
  const double n = static_cast<double>(active.size());
  Eigen::Matrix2d own = Eigen::Matrix2d::Zero();
  for (const auto k : active) {
    const auto& step = trace.steps[k];
    const Columns columns = wind_columns(step.P);
    own += wind_rows(columns);
    if (trace.trim_is_state) bin.per_trim += columns.middleRows<2>(i_b).transpose();
    bin.per_parameter += step.S.middleRows<2>(i_W) + step.S.middleRows<2>(i_u);
    bin.turbulence += step.x.segment<2>(i_u).cwiseAbs2();
    bin.turbulence += Eigen::Vector2d(step.P(i_u, i_u), step.P(i_u + 1, i_u + 1));
  }
  bin.per_parameter /= n;
  bin.turbulence /= n;
  const Eigen::Matrix2d all = pair_covariance(trace, active) / (n * n);
  bin.effective_samples = std::max(1e-9, own.trace() / n) / std::max(1e-12, all.trace());
  bin.noise = all;
  if (trace.trim_is_state) {
    bin.trim = trace.steps[active.back()].P.block<2, 2>(i_b, i_b);
    bin.per_trim = (bin.per_trim / n * bin.trim.inverse()).eval();
    bin.noise -= bin.trim_part();
  } else {
    bin.per_trim = bin.per_parameter.middleCols<2>(estimator::c_trim_x);
    bin.per_parameter.middleCols<2>(estimator::c_trim_x).setZero();
    bin.trim = trace.consider.block<2, 2>(estimator::c_trim_x, estimator::c_trim_x);
  }
}

/// Without a trace the samples' own covariances are a bound: as if their errors were all one.
void add_bound(const estimator::WindSeries& series, const std::vector<std::size_t>& members, BinMean& bin) {
  for (const auto i : members) bin.noise += std::get<WindEstimate>(series.points[i].wind).covariance;
  bin.noise /= static_cast<double>(members.size());
  bin.effective_samples = 1;
}

void collect_reasons(const estimator::WindSeries& series, const std::vector<std::size_t>& members, BinMean& bin) {
  std::map<estimator::Reason, std::size_t> counts;
  std::size_t doubtful = 0, bad = 0;
  for (const auto i : members) {
    for (const auto reason : series.points[i].reasons.list()) ++counts[reason];
    doubtful += series.points[i].quality != Quality::good;
    bad += series.points[i].quality == Quality::bad;
  }
  for (const auto& [reason, count] : counts)
    if (5 * count >= members.size()) bin.reasons.add(reason);
  bin.doubtful_share = static_cast<double>(doubtful) / static_cast<double>(members.size());
  bin.bad_share = static_cast<double>(bad) / static_cast<double>(members.size());
}

/// Time that the members stand for: each the interval to the point before it, gaps counted as 2 s at most.
double time_in_bin(const estimator::WindSeries& series, const std::vector<std::size_t>& members) {
  double sum = 0;
  for (const auto i : members)
    if (i > 0) sum += std::min(2.0, ingest::to_seconds(series.points[i].time - series.points[i - 1].time));
  return sum;
}

}  // namespace

BinMean bin_mean(const estimator::WindSeries& series, const std::vector<std::size_t>& members) {
  BinMean bin;
  bin.samples = members.size();
  if (members.empty()) return bin;
  for (const auto i : members) bin.wind += std::get<WindEstimate>(series.points[i].wind).v_NA_N;
  bin.wind /= static_cast<double>(members.size());
  bin.seconds = time_in_bin(series, members);
  collect_reasons(series, members, bin);
  if (!series.trace) {
    add_bound(series, members, bin);
    return bin;
  }
  std::vector<std::size_t> active;
  active.reserve(members.size());
  for (const auto i : members) active.push_back(static_cast<std::size_t>(series.trace->of_point[i]));
  add_trace_part(*series.trace, active, bin);
  return bin;
}

std::optional<double> direction_spread(const estimator::WindSeries& series, const std::vector<std::size_t>& members) {
  double s = 0, c = 0, n = 0;
  for (const auto i : members) {
    const auto& w = std::get<WindEstimate>(series.points[i].wind).v_NA_N;
    if (w.norm() < 1e-6) continue;
    s += w.y() / w.norm(), c += w.x() / w.norm(), n += 1;
  }
  if (n < 2) return std::nullopt;
  const double e = std::sqrt(std::max(0.0, 1 - (s * s + c * c) / (n * n)));
  return std::asin(e) * (1 + 0.1547 * e * e * e) * 180 / std::numbers::pi;
}

double sampling_variance(double sigma_u, double time_u, double seconds) {
  if (seconds <= 0) return sigma_u * sigma_u;
  const double x = time_u / seconds;
  return sigma_u * sigma_u * 2 * x * (1 - x * (1 - std::exp(-1 / x)));
}

}  // namespace quadsonde::profiles
