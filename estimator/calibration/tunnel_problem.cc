#include "estimator/calibration/tunnel_problem.h"

#include <ceres/ceres.h>
#include <ceres/covariance.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "ingest/motion/drag.h"

namespace quadsonde::estimator {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double outlier = 2;  // [sigma] of the Cauchy loss
// Columns are scaled by prior sds: a direction that the runs tell twenty times worse than the prior is not determined.
constexpr double least_singular = 0.05;

/// One sample against the sinusoids of tunnel_fit.h.
struct TiltResidual {
  double heading, pitch, roll, chi, noise, linear_scale, quadratic_scale;

  template <class T>
  bool operator()(const T* linear, const T* quadratic, const T* trim, const T* offset, const T* wind,
                  T* residual) const {
    using std::abs, std::cos, std::sin;
    const T c = *linear * linear_scale + *quadratic * quadratic_scale * abs(*wind);
    const T amplitude = c * *wind / ingest::standard_gravity;
    const T angle = *offset + (chi - heading);
    residual[0] = (pitch + amplitude * cos(angle) - trim[0]) / noise;
    residual[1] = (roll - amplitude * sin(angle) - trim[1]) / noise;
    return true;
  }
};
using TiltCost = ceres::AutoDiffCostFunction<TiltResidual, 2, 1, 1, 2, 1, 1>;

/// A number known beforehand.
struct Known {
  double value, sd;
  template <class T>
  bool operator()(const T* x, T* residual) const {
    residual[0] = (*x - value) / sd;
    return true;
  }
};
using KnownCost = ceres::AutoDiffCostFunction<Known, 1, 1>;

struct KnownPair {
  Eigen::Vector2d value;
  double sd;
  template <class T>
  bool operator()(const T* x, T* residual) const {
    for (int i = 0; i < 2; ++i) residual[i] = (x[i] - value(i)) / sd;
    return true;
  }
};
using KnownPairCost = ceres::AutoDiffCostFunction<KnownPair, 2, 2>;

TiltResidual residual_of(const ProblemRun& run, const TunnelSample& s) {
  return {s.heading, s.pitch, s.roll, run.chi, run.noise, run.linear_scale, run.quadratic_scale};
}

/// The problem over a state that it changes; neither may move while it lives.
void build(ceres::Problem& problem, const std::vector<ProblemRun>& runs, const std::optional<TunnelTrim>& trim,
           bool quadratic, CommonState& state) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto& run = runs[i];
    // A run of samples that repeat each other weighs as much as its effective number; its outliers are judged by one.
    auto* loss = new ceres::ScaledLoss(new ceres::CauchyLoss(outlier), 1 / run.inflation, ceres::TAKE_OWNERSHIP);
    for (const auto& s : *run.samples)
      problem.AddResidualBlock(new TiltCost(new TiltResidual(residual_of(run, s))), loss, &state.linear,
                               &state.quadratic, state.trim.data(), &state.offset, &state.wind[i]);
    problem.AddResidualBlock(new KnownCost(new Known{run.wind_speed, run.wind_speed_sd}), nullptr, &state.wind[i]);
  }
  if (trim) {
    const Eigen::Vector2d value(std::tan(trim->pitch_deg * degree), std::tan(trim->roll_deg * degree));
    problem.AddResidualBlock(new KnownPairCost(new KnownPair{value, std::max(trim->sd_deg, 1e-3) * degree}), nullptr,
                             state.trim.data());
  }
  if (!quadratic) problem.SetParameterBlockConstant(&state.quadratic);
}

/// Blocks in the order that the header promises.
std::vector<double*> blocks_of(CommonState& state) {
  std::vector<double*> blocks{&state.linear, &state.quadratic, state.trim.data(), &state.offset};
  for (auto& wind : state.wind) blocks.push_back(&wind);
  return blocks;
}

Eigen::MatrixXd dense(const ceres::CRSMatrix& sparse) {
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
  for (int row = 0; row < sparse.num_rows; ++row)
    for (int k = sparse.rows[static_cast<std::size_t>(row)]; k < sparse.rows[static_cast<std::size_t>(row) + 1]; ++k)
      full(row, sparse.cols[static_cast<std::size_t>(k)]) += sparse.values[static_cast<std::size_t>(k)];
  return full;
}

/// What the parameters are known to before any run: the class prior's spread, 3 deg of trim, 20 deg of direction.
Eigen::VectorXd prior_sds(const std::vector<ProblemRun>& runs) {
  Eigen::VectorXd sds(5 + static_cast<Eigen::Index>(runs.size()));
  sds.head<5>() << 0.07, 0.004, 3 * degree, 3 * degree, 20 * degree;
  for (std::size_t i = 0; i < runs.size(); ++i) sds(5 + static_cast<Eigen::Index>(i)) = runs[i].wind_speed_sd;
  return sds;
}

std::optional<Eigen::MatrixXd> covariance_of(ceres::Problem& problem, const std::vector<double*>& blocks,
                                             Eigen::Index size) {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  options.null_space_rank = 0;
  options.min_reciprocal_condition_number = 1e-14;
  options.num_threads = 1;
  ceres::Covariance covariance(options);
  const std::vector<const double*> parameters(blocks.begin(), blocks.end());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> full(size, size);
  if (!covariance.Compute(parameters, &problem) || !covariance.GetCovarianceMatrix(parameters, full.data()))
    return std::nullopt;
  return Eigen::MatrixXd(full);
}

void solve(ceres::Problem& problem, CommonFit& fit) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-12;
  options.parameter_tolerance = 1e-11;
  options.gradient_tolerance = 1e-12;
  options.num_threads = 1;  // the same sums in the same order, so the same digits
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  fit.cost = summary.final_cost;
  fit.iterations += static_cast<int>(summary.iterations.size());
  fit.converged = summary.termination_type == ceres::CONVERGENCE;
}

}  // namespace

CommonFit solve_common(const std::vector<ProblemRun>& runs, const std::optional<TunnelTrim>& trim, bool quadratic,
                       const CommonState& start) {
  CommonFit fit;
  fit.state = start;
  if (!quadratic) fit.state.quadratic = 0;
  ceres::Problem problem;
  build(problem, runs, trim, quadratic, fit.state);
  solve(problem, fit);
  // The bounds as an active set: a coefficient that wants to be negative is held at zero and the rest solved again.
  // Ceres's own bounds end at the same place, in some hundred steps along the bound.
  for (double* coefficient : {&fit.state.quadratic, &fit.state.linear}) {
    if (*coefficient >= 0) continue;
    *coefficient = 0;
    problem.SetParameterBlockConstant(coefficient);
    solve(problem, fit);
  }
  return fit;
}

CommonUncertainty uncertainty_of(const std::vector<ProblemRun>& runs, const std::optional<TunnelTrim>& trim,
                                 const CommonState& at, bool quadratic) {
  CommonState state = at;
  ceres::Problem problem;
  build(problem, runs, trim, quadratic, state);
  const auto blocks = blocks_of(state);
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = blocks;
  options.num_threads = 1;
  ceres::CRSMatrix sparse;
  CommonUncertainty out;
  if (!problem.Evaluate(options, nullptr, nullptr, nullptr, &sparse)) return out;
  Eigen::MatrixXd whitened = dense(sparse);
  const Eigen::VectorXd sds = prior_sds(runs);
  if (whitened.cols() == sds.size()) whitened = whitened * sds.asDiagonal();
  // Singular values by the triangle of a QR step: the same ones, from a matrix of a few columns.
  const Eigen::MatrixXd triangle = Eigen::HouseholderQR<Eigen::MatrixXd>(whitened)
                                       .matrixQR()
                                       .topRows(whitened.cols())
                                       .triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(triangle, Eigen::ComputeFullV);
  out.singular_values = svd.singularValues();
  out.rank = static_cast<int>((out.singular_values.array() > least_singular).count());
  out.weakest = svd.matrixV().col(whitened.cols() - 1).head<5>();
  const auto free = whitened.cols() - (quadratic ? 0 : 1);
  if (out.rank == free) out.covariance = covariance_of(problem, blocks, static_cast<Eigen::Index>(5 + runs.size()));
  if (out.covariance && quadratic) {
    // With the winds marginalised: the widest direction of what remains, against the prior.
    const Eigen::Matrix<double, 5, 1> scale = sds.head<5>().cwiseInverse();
    const Eigen::Matrix<double, 5, 5> scaled =
        scale.asDiagonal() * out.covariance->topLeftCorner<5, 5>() * scale.asDiagonal();
    out.weakest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 5, 5>>(scaled).eigenvectors().col(4);
  }
  return out;
}

Eigen::Vector2d tilt_residual(const ProblemRun& run, const TunnelSample& sample, const Eigen::Matrix<double, 6, 1>& p,
                              Eigen::Matrix<double, 2, 6>* jacobian) {
  const TiltCost cost(new TiltResidual(residual_of(run, sample)));
  const double* blocks[] = {&p(0), &p(1), &p(2), &p(4), &p(5)};
  Eigen::Vector2d residual;
  Eigen::Vector2d linear, quadratic, offset, wind;
  Eigen::Matrix<double, 2, 2, Eigen::RowMajor> trim;
  double* jacobians[] = {linear.data(), quadratic.data(), trim.data(), offset.data(), wind.data()};
  cost.Evaluate(blocks, residual.data(), jacobian ? jacobians : nullptr);
  if (jacobian) *jacobian << linear, quadratic, trim, offset, wind;
  return residual;
}

}  // namespace quadsonde::estimator
