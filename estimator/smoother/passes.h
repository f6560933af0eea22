#pragma once
// The two passes: WindFilter forward, Rauch, Tung and Striebel backward, with what exact bin statistics need.
// Source: estimator/MODEL.md sections 7 and 8.
#include <vector>

#include "estimator/filter/online_drag.h"
#include "estimator/filter/wind_filter.h"
#include "estimator/smoother/steps.h"

namespace quadsonde::estimator {

using ConsiderCovariance = Eigen::Matrix<double, consider_count, consider_count>;

/// One step between the passes and after them. Between: x_s = x + gain x_s(next), and so for P and S; after:
/// smoothed state, covariance and sensitivity. Both fit the same place: 1.6 kB a step.
struct SmoothedStep {
  State<double> x = State<double>::Zero();
  StateMatrix<double> P = StateMatrix<double>::Zero();
  StateMatrix<double> gain = StateMatrix<double>::Zero();  ///< towards the next active step
  Sensitivity<double> S = Sensitivity<double>::Zero();
};

/// Whether a pass learns drag and latency: going over to every new estimate at once, or only gathering what the flight
/// tells of them while the filter keeps the law that it has.
enum class Learning : unsigned char { off, adopt, gather };

struct PassSettings {
  WindModel<double> model;
  FilterLimits<double> limits;
  Eigen::Vector2d trim = Eigen::Vector2d::Zero();               ///< prior mean of b [m/s2]
  Eigen::Matrix2d trim_covariance = Eigen::Matrix2d::Identity();
  double velocity_scale = 1;        ///< of the steps' variances
  bool jump_test = true;
  std::vector<std::size_t> jumps;   ///< steps before which W is opened (found by an earlier pass)
  double restart_after = 2;         ///< of rejects [s]
  bool keep_trace = false;
  bool causal = false;              ///< the trim thaws once the heading has turned, sigma_u follows the turbulence
  bool adapt_turbulence = false;    ///< causal: sigma_u by EM over the past 120 s
  Learning learning = Learning::off;
  ConsiderCovariance consider = ConsiderCovariance::Zero();  ///< prior of what is learned and of the rest
  double ln_factor_ahead = 0, latency_ahead = 0;  ///< gather: prior means less what the filter runs with
  double most_latency = 0.5;        ///< that may be added [s]; the log's own one is in the steps already
  double least_latency = 0;
};

/// What the smoother knows, step by step. Only active steps (those the filter ran on) are here.
struct SmootherTrace {
  std::vector<SmoothedStep> steps;
  std::vector<std::ptrdiff_t> of_point;   ///< index into steps for each point of the series, or -1
  std::vector<std::size_t> breaks;        ///< active steps at which the filter was restarted
  ConsiderCovariance consider = ConsiderCovariance::Zero();
  double turbulence_sd = 0.5, turbulence_time = 10;
  bool trim_is_state = true;
  std::vector<Step> input;                ///< of the final pass, one per point of the series
  PassSettings settings;                  ///< of the final pass
};

/// The wind's part of a posterior.
struct WindPosterior {
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();          ///< over ground
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();        ///< noise and, if it is a state, trim
  Eigen::Matrix2d without_trim = Eigen::Matrix2d::Zero();      ///< as if the trim were known
  Eigen::Matrix<double, 2, consider_count> sensitivity = Eigen::Matrix<double, 2, consider_count>::Zero();
};
WindPosterior wind_posterior(const State<double>& x, const StateMatrix<double>& P, const Sensitivity<double>& S,
                             bool trim_is_state);

struct CausalPoint {
  WindPosterior wind;
  bool trim_is_state = false;
  Eigen::Matrix2d considered = Eigen::Matrix2d::Zero();  ///< learning: what the parameters add at this time
};

/// Drag and latency at a step, against what the pass began with.
struct LearnedStep {
  float ln_factor = 0, ln_factor_sd = 0;
  bool updated = false;  ///< this step's velocity told of them
};

/// What a pass has learned by its end.
struct LearnedDrag {
  double ln_factor = 0, ln_factor_sd = 0;
  double latency = 0, latency_sd = 0;  ///< beyond the one in the steps [s]
  double seconds = 0;                  ///< during which it learned
  ConsiderCovariance covariance = ConsiderCovariance::Zero();  ///< at the learned law, in the order of ConsiderIndex
};

struct ForwardPass {
  double log_likelihood = 0;
  double nis_sum = 0;
  std::size_t updates = 0;
  std::vector<std::size_t> found_jumps;   ///< step index of each detection
  int rejected = 0, restarts = 0;
  std::vector<Outcome> outcome;           ///< per step
  std::vector<bool> active;               ///< per step: the filter ran
  std::vector<CausalPoint> causal;        ///< per step, in causal mode
  std::vector<LearnedStep> learning;      ///< per step, where the pass learns
  LearnedDrag learned;
  std::vector<Eigen::Vector2d> whitened;  ///< per step; zero where there was no update
  State<double> x = State<double>::Zero();
  StateMatrix<double> P = StateMatrix<double>::Zero();
  SmootherTrace trace;                    ///< with keep_trace: ready for smooth()
};

ForwardPass run_forward(const std::vector<Step>& steps, const PassSettings& settings);

/// Turns the trace of a forward pass into smoothed values, in place.
void smooth(SmootherTrace& trace);

/// 1 - coherence of the heading: sqrt(1 - |mean exp(i psi)|^2), over the sound steps up to and including `until`.
double heading_index(const std::vector<Step>& steps, std::size_t until);

}  // namespace quadsonde::estimator
