#include "estimator/smoother/estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "estimator/filter/classic_filter.h"
#include "estimator/smoother/likelihood.h"
#include "estimator/smoother/passes.h"
#include "estimator/smoother/self_checks.h"
#include "estimator/smoother/vertical_wind.h"

namespace quadsonde::estimator {
namespace {

using ingest::Flight;
using ingest::Kind;
using ingest::Vehicle;

constexpr double degree = std::numbers::pi / 180;

/// Density for the flight: told, measured, or of the standard atmosphere at the flight's mean height.
struct Density {
  double value = ingest::sea_level_air_density;
  bool standard = true;
};

Density flight_density(const Flight& flight, const Vehicle& vehicle, const EstimateSettings& settings) {
  if (settings.air_density_kg_m3) return {*settings.air_density_kg_m3, false};
  double sum = 0;
  int count = 0;
  for (const auto& sample : flight.air.value)
    if (sample.pressure_pa && sample.temperature_k)
      sum += ingest::air_density(*sample.pressure_pa, *sample.temperature_k, sample.relative_humidity_pct.value_or(50)),
          ++count;
  if (count > 0) return {sum / count, false};
  if (flight.height_msl.empty()) return {vehicle.air_density_kg_m3, true};
  double height = 0;
  for (const auto& h : flight.height_msl.value) height += h.m;
  return {ingest::standard_air_density(height / static_cast<double>(flight.height_msl.size())), true};
}

Eigen::Matrix2d trim_jacobian() {
  // b = g (tan trim_pitch, -tan trim_roll), per degree, rows b_x b_y, columns roll pitch.
  const double g = ingest::standard_gravity * degree;
  Eigen::Matrix2d J;
  J << 0, g, -g, 0;
  return J;
}

/// A calibrated trim is weighed, not believed: its sd carries 0.3 degrees more into the next flight.
Eigen::Matrix2d trim_covariance(const Vehicle& vehicle) {
  Eigen::Matrix2d C = vehicle.covariance.block<2, 2>(ingest::p_trim_roll, ingest::p_trim_roll);
  constexpr double between_flights_deg = 0.3;
  C += between_flights_deg * between_flights_deg * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d J = trim_jacobian();
  return J * C * J.transpose();
}

ConsiderCovariance consider_covariance(const Vehicle& vehicle, const EstimateSettings& settings,
                                       const Eigen::Matrix2d& trim, bool trim_is_state) {
  ConsiderCovariance C = ConsiderCovariance::Zero();
  const int from[] = {ingest::p_linear, ingest::p_quadratic, ingest::p_latency, ingest::p_climb_linear,
                      ingest::p_climb_quadratic};
  const int to[] = {c_linear, c_quadratic, c_latency, c_climb_linear, c_climb_quadratic};
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) C(to[i], to[j]) = vehicle.covariance(from[i], from[j]);
  // From flight to flight both coefficients move by one factor.
  const Eigen::Vector2d coefficients(vehicle.drag.linear, vehicle.drag.quadratic);
  C.block<2, 2>(c_linear, c_linear) +=
      vehicle.between_flights_rel_sd * vehicle.between_flights_rel_sd * coefficients * coefficients.transpose();
  C(c_heading, c_heading) = std::pow(settings.heading_sd_deg * degree, 2);
  if (!trim_is_state) C.block<2, 2>(c_trim_x, c_trim_x) = trim;
  return C;
}

/// PSD of the acceleration noise that the attitude's error makes: white per sample, or correlated.
double tilt_psd(const Vehicle& vehicle, double attitude_interval) {
  const double sd = ingest::standard_gravity * vehicle.tilt_sd_deg * degree;
  return vehicle.tilt_correlation_s > 0 ? 2 * sd * sd * vehicle.tilt_correlation_s : sd * sd * attitude_interval;
}

/// One flight's estimation, stage by stage.
class Estimation {
 public:
  Estimation(const Flight& flight, const Vehicle& vehicle, const EstimateSettings& settings)
      : flight_(flight), settings_(settings), density_(flight_density(flight, vehicle, settings)) {
    // Without a mass asked for, scaling cannot fail.
    vehicle_ = *ingest::flown_at(vehicle, std::nullopt, density_.value);
  }

  WindSeries run() {
    lay_steps();
    prepare();
    if (settings_.mode == Mode::classic)
      run_classic();
    else if (settings_.mode == Mode::causal)
      run_causal();
    else
      run_smoothed();
    finish_diagnostics();
    return std::move(series_);
  }

 private:
  void lay_steps() {
    StepSettings s;
    s.latency = vehicle_.latency_s;
    s.drag = vehicle_.drag.linear;
    s.max_gap = settings_.max_gap_s;
    s.velocity_sd = settings_.velocity_sd_m_s;
    s.causal = settings_.mode == Mode::causal;
    steps_ = make_steps(flight_, s);
  }

  void prepare() {
    const double Y = heading_index(steps_.steps, steps_.steps.size());
    pass_.model.drag = vehicle_.drag;
    pass_.model.turbulence_time = settings_.turbulence_time_s;
    pass_.model.turbulence_sd = settings_.turbulence_sd_m_s.value_or(0.5);
    pass_.model.wind_time_psd = settings_.wind_time_psd;
    pass_.model.wind_height_psd = settings_.wind_height_psd;
    pass_.model.tilt_psd = tilt_psd(vehicle_, steps_.attitude_interval);
    pass_.model.vertical_sd = settings_.vertical_wind_sd_m_s;
    pass_.model.vertical_time = settings_.vertical_wind_time_s;
    pass_.model.trim_is_state = Y >= 0.4 && settings_.mode != Mode::causal;
    pass_.limits.gate_nis = settings_.gate_nis;
    pass_.trim = ingest::standard_gravity * Eigen::Vector2d(std::tan(vehicle_.trim_pitch_deg * degree),
                                                            -std::tan(vehicle_.trim_roll_deg * degree));
    pass_.trim_covariance = trim_covariance(vehicle_);
    pass_.jump_test = settings_.jump_test;
    pass_.restart_after = std::max(pass_.restart_after, settings_.max_gap_s);
    auto& d = series_.diagnostics;
    d.heading_index = Y;
    d.trim_estimated = Y >= 0.4;
    d.air_density = density_.value;
    d.standard_density = density_.standard;
    d.climb_linear = vehicle_.drag.climb_linear;
    d.climb_linear_sd = vehicle_.parameter_sd(ingest::p_climb_linear);
    d.climb_quadratic = vehicle_.drag.climb_quadratic;
    d.climb_quadratic_sd = vehicle_.parameter_sd(ingest::p_climb_quadratic);
    d.velocity_sd = settings_.velocity_sd_m_s;
    series_.mode = settings_.mode;
  }

  // -- the two-sided estimate

  void run_smoothed() {
    fit_velocity_noise();
    if (settings_.online_drag) learn_drag();
    find_jumps();
    fit_turbulence();
    if (fit_climb_law()) fit_turbulence();
    if (settings_.jump_test && !jump_test_off_) find_jumps();
    pass_.keep_trace = true;
    ForwardPass forward = run_forward(steps_.steps, pass_);
    auto trace = std::make_shared<SmootherTrace>(std::move(forward.trace));
    trace->consider = considered(pass_.model.trim_is_state);
    smooth(*trace);
    widen_climb_law(*trace);
    note(forward);
    for (std::size_t k = 0; k < steps_.steps.size(); ++k) {
      const auto at = trace->of_point[k];
      if (at < 0) {
        add_point(k, nullptr, trace->consider, pass_.model.trim_is_state);
        continue;
      }
      const auto& s = trace->steps[static_cast<std::size_t>(at)];
      const auto wind = wind_posterior(s.x, s.P, s.S, pass_.model.trim_is_state);
      add_point(k, &wind, trace->consider, pass_.model.trim_is_state);
    }
    if (!trace->steps.empty()) note_trim(trace->steps.back().x, trace->steps.back().P);
    series_.diagnostics.vertical = estimate_vertical_wind(flight_, vehicle_, density_.value, steps_.steps, series_);
    check_itself(forward, trace->consider);
    trace->input = steps_.steps;
    trace->settings = pass_;
    series_.trace = trace;
  }

  ConsiderCovariance considered(bool trim_is_state) const {
    ConsiderCovariance C = consider_covariance(vehicle_, settings_, pass_.trim_covariance, trim_is_state);
    if (!learned_) return C;
    // The climb law may have been found meanwhile; it stands beside what was learned.
    for (const int i : {c_linear, c_quadratic, c_latency})
      for (const int j : {c_linear, c_quadratic, c_latency}) C(i, j) = (*learned_)(i, j);
    return C;
  }

  /// Drag factor and latency of the whole flight: Gauss and Newton, the innovations of one pass after the other at the
  /// law of the one before. Where the motion never tells of them, everything stays as it is.
  void learn_drag() {
    auto pass = pass_;
    pass.jump_test = false;
    pass.jumps.clear();
    pass.learning = Learning::gather;
    const auto prior_law = vehicle_.drag;
    const double prior_latency = vehicle_.latency_s;
    const auto prior = consider_covariance(vehicle_, settings_, pass_.trim_covariance, pass_.model.trim_is_state);
    ForwardPass told;
    double ln_factor = 0, latency = prior_latency;
    const auto go_over = [&](double factor_by, double latency_by) {
      ln_factor += factor_by, latency += latency_by;
      pass.model.drag.linear = prior_law.linear * std::exp(ln_factor);
      pass.model.drag.quadratic = prior_law.quadratic * std::exp(ln_factor);
      vehicle_.latency_s = latency;
      vehicle_.drag = pass.model.drag;
      if (std::abs(latency_by) > 1e-4) lay_steps();
    };
    // From the vehicle file's law alone the rounds may end elsewhere where the latency is not known either (a drag 30 %
    // too small, 30 seeds: 16 % rms, 40 % at worst); the causal pass, which goes over at once, leads near the right
    // one.
    if (const auto first = run_forward(steps_.steps, adopting(pass, prior)); first.learned.seconds > 0)
      go_over(first.learned.ln_factor, first.learned.latency);
    constexpr int most_rounds = 8;
    for (int round = 0; round < most_rounds; ++round) {
      // In the first rounds the law is still wrong, and the gate would throw out what says so.
      pass.limits.gate_nis = round < 2 ? 1e9 : settings_.gate_nis;
      pass.consider = at_factor(prior, std::exp(ln_factor));
      pass.ln_factor_ahead = -ln_factor;
      pass.latency_ahead = prior_latency - latency;
      if (!settings_.turbulence_sd_m_s)
        pass.model.turbulence_sd = most_likely_turbulence(steps_.steps, without_learning(pass));
      told = run_forward(steps_.steps, pass);
      if (told.learned.seconds == 0) break;
      const double move = std::clamp(told.learned.ln_factor, -0.4, 0.4);
      const double later = std::clamp(latency + told.learned.latency, 0.0, 0.6) - latency;
      go_over(move, later);
      if (round >= 3 && std::abs(move) < 0.1 * told.learned.ln_factor_sd) break;
    }
    note_learned(told, ln_factor, latency, prior_latency);
    if (told.learned.seconds == 0) return;
    pass_.model.drag = vehicle_.drag;
    learned_ = told.learned.covariance;
  }

  /// As the causal estimate learns: every new drag and latency is gone over to at once.
  PassSettings adopting(PassSettings pass, const ConsiderCovariance& prior) const {
    pass.learning = Learning::adopt;
    pass.consider = prior;
    // No attitude is read before the velocity that it explains, and none half a second behind it.
    pass.least_latency = -vehicle_.latency_s;
    pass.most_latency = 0.6 - vehicle_.latency_s;
    return pass;
  }

  static PassSettings without_learning(PassSettings pass) {
    pass.learning = Learning::off;
    return pass;
  }

  /// ln of the factor has one sd wherever the law stands; delta's own grows with it.
  static ConsiderCovariance at_factor(ConsiderCovariance C, double factor) {
    C.middleRows<2>(c_linear) *= factor;
    C.middleCols<2>(c_linear) *= factor;
    return C;
  }

  void note_learned(const ForwardPass& pass, double ln_factor, double latency, double prior_latency) {
    OnlineDrag drag;
    drag.seconds = pass.learned.seconds;
    drag.factor = std::exp(ln_factor);
    drag.sd = pass.learned.ln_factor_sd;
    drag.latency = drag.seconds > 0 ? latency : prior_latency;
    drag.latency_sd = pass.learned.latency_sd;
    for (std::size_t k = 0; k < pass.learning.size(); ++k) {
      if (!pass.learning[k].updated) continue;
      const auto when = steps_.steps[k].time;
      if (!drag.first) drag.first = when;
      drag.last = when;
    }
    learning_ = pass.learning;
    series_.diagnostics.online_drag = drag;
  }

  /// The climb law is an exponent: at sd s of it the drag may be exp(1.96 s) too small, not only 1.96 s. Its
  /// sensitivities are stretched so that the 95 % interval reaches that far on both sides.
  void widen_climb_law(SmootherTrace& trace) const {
    const Eigen::Matrix2d C = trace.consider.block<2, 2>(c_climb_linear, c_climb_linear);
    for (std::size_t k = 0; k < steps_.steps.size(); ++k) {
      const auto at = trace.of_point[k];
      if (at < 0) continue;
      const double v_c = -steps_.steps[k].input.v_down;
      const Eigen::Vector2d lever(v_c, v_c * v_c);
      const double reach = 1.96 * std::sqrt(std::max(0.0, lever.dot(C * lever)));
      if (reach < 0.01) continue;
      // The exponent is clipped at ln .3, so no error of it exceeds a factor 1 / .3.
      const double stretched = std::min(std::expm1(reach), 1 / 0.3 - 1);
      trace.steps[static_cast<std::size_t>(at)].S.middleCols<2>(c_climb_linear) *= std::max(1.0, stretched / reach);
    }
  }

  /// Numbers that need no truth; what fails where it could be shown makes every value doubtful.
  void check_itself(const ForwardPass& forward, const ConsiderCovariance& consider) {
    const double sigma = pass_.model.turbulence_sd, time = pass_.model.turbulence_time;
    auto& checks = series_.diagnostics.self_checks;
    checks.push_back(heading_crosstalk(series_, steps_.steps, sigma, time));
    checks.push_back(velocity_crosstalk(series_, steps_.steps, excitation(), time));
    checks.push_back(split_halves(series_, sigma, time));
    checks.push_back(innovation_size(forward));
    checks.push_back(innovation_whiteness(forward));
    checks.push_back(hold_out(steps_.steps, pass_, consider));
    if (!flight_.accelerometer.empty())
      checks.push_back(accelerometer_path(flight_, pass_.model.drag, series_, steps_.steps));
    Reasons failed;
    for (const auto& check : checks)
      if (check.judged && !check.passed) failed.add(check.reason);
    add_to_all(series_, failed);
  }

  /// Where the wind stepped: W is opened half a second before each detection, where a second pass finds it.
  void find_jumps() {
    pass_.jumps.clear();
    if (!settings_.jump_test) return;
    pass_.jump_test = true;
    const auto pass = run_forward(steps_.steps, pass_);
    pass_.jump_test = false;
    const double minutes = steps_.steps.empty() ? 0 : steps_.steps.back().seconds / 60;
    series_.diagnostics.jumps = static_cast<int>(pass.found_jumps.size());
    if (pass.found_jumps.size() >= 4 && static_cast<double>(pass.found_jumps.size()) > 0.5 * minutes) {
      // So many steps are no weather: the model does not fit, and opening W would push the trim about.
      jump_test_off_ = true;
      return;
    }
    for (const auto found : pass.found_jumps) {
      std::size_t k = found;
      while (k > 0 && steps_.steps[found].seconds - steps_.steps[k].seconds < 0.5) --k;
      pass_.jumps.push_back(k + 1);
    }
  }

  void fit_turbulence() {
    if (settings_.turbulence_sd_m_s) return;
    pass_.model.turbulence_sd = most_likely_turbulence(steps_.steps, pass_);
  }

  /// A velocity made of positions states no noise, and it is not white: where 0.1 m/s does not fit, it is widened.
  void fit_velocity_noise() {
    if (flight_.velocity.origin != ingest::VelocityOrigin::differentiated || !flight_.velocity.sd.empty()) return;
    auto calm = pass_;
    calm.jump_test = false;
    const auto pass = run_forward(steps_.steps, calm);
    if (pass.updates == 0 || pass.nis_sum < 2.3 * static_cast<double>(pass.updates)) return;
    pass_.velocity_scale = most_likely_velocity_scale(steps_.steps, calm);
    series_.diagnostics.velocity_sd = settings_.velocity_sd_m_s * std::sqrt(pass_.velocity_scale);
  }

  /// Ascent and descent see the same wind, so that they tell what the climb does to the drag.
  bool fit_climb_law() {
    const auto evidence = climb_evidence(steps_.steps);
    ClimbLaw prior;
    prior.value = {vehicle_.drag.climb_linear, vehicle_.drag.climb_quadratic};
    prior.covariance = vehicle_.covariance.block<2, 2>(ingest::p_climb_linear, ingest::p_climb_linear);
    const bool known = prior.covariance.determinant() <= 0;
    if (!settings_.estimate_climb_law || evidence == ClimbEvidence::none || known) return false;
    const auto law = most_likely_climb_law(steps_.steps, pass_, prior, evidence);
    pass_.model.drag.climb_linear = vehicle_.drag.climb_linear = law.value.x();
    pass_.model.drag.climb_quadratic = vehicle_.drag.climb_quadratic = law.value.y();
    vehicle_.covariance.middleRows<2>(ingest::p_climb_linear).setZero();
    vehicle_.covariance.middleCols<2>(ingest::p_climb_linear).setZero();
    vehicle_.covariance.block<2, 2>(ingest::p_climb_linear, ingest::p_climb_linear) = law.covariance;
    auto& d = series_.diagnostics;
    d.climb_linear = law.value.x();
    d.climb_linear_sd = std::sqrt(law.covariance(0, 0));
    d.climb_quadratic = law.value.y();
    d.climb_quadratic_sd = std::sqrt(law.covariance(1, 1));
    d.climb_estimated = true;
    return true;
  }

  // -- the causal estimate

  void run_causal() {
    pass_.causal = true;
    pass_.adapt_turbulence = !settings_.turbulence_sd_m_s.has_value();
    const auto frozen = consider_covariance(vehicle_, settings_, pass_.trim_covariance, false);
    if (settings_.online_drag) pass_ = adopting(pass_, frozen);
    const auto pass = run_forward(steps_.steps, pass_);
    series_.diagnostics.jumps = static_cast<int>(pass.found_jumps.size());
    note(pass);
    note_trim(pass.x, pass.P);
    pass_.model.turbulence_sd = pass.trace.turbulence_sd;
    if (settings_.online_drag)
      note_learned(pass, pass.learned.ln_factor, vehicle_.latency_s + pass.learned.latency, vehicle_.latency_s);
    for (std::size_t k = 0; k < steps_.steps.size(); ++k) {
      const auto& point = pass.causal[k];
      const bool learned = settings_.online_drag && pass.learned.seconds > 0;
      add_point(k, pass.active[k] ? &point.wind : nullptr, frozen, point.trim_is_state,
                learned ? &point.considered : nullptr);
    }
  }

  // -- the published filter

  void run_classic() {
    ClassicConstants constants;
    constants.mass = vehicle_.mass_kg.value_or(1);
    constants.drag = vehicle_.drag.linear * constants.mass;
    ClassicFilter filter(constants);
    // Its constants hold at 10 Hz: velocity and thrust direction are averaged onto that grid.
    const auto& steps = steps_.steps;
    std::size_t k = 0;
    while (k < steps.size()) {
      const double end = steps[k].seconds + constants.step - 1e-6;
      Eigen::Vector3d n = Eigen::Vector3d::Zero();
      Eigen::Vector2d v = Eigen::Vector2d::Zero();
      std::size_t first = k;
      double count = 0;
      for (; k < steps.size() && (k == first || steps[k].seconds < end); ++k) {
        if (!steps[k].sound && steps[k].fault == Reason::no_attitude) continue;
        ++count;
        const Eigen::Vector2d s = steps[k].input.slope;
        n += Eigen::Vector3d(-s.x(), -s.y(), 1).normalized();
        v += steps[k].v;
      }
      // A slower log repeats its last values: the filter knows no other rate.
      const double until = k < steps.size() ? steps[k].seconds : steps.back().seconds + constants.step;
      const int repeats =
          std::clamp(static_cast<int>(std::lround((until - steps[first].seconds) / constants.step)), 1, 20);
      for (int i = 0; count > 0 && i < repeats; ++i) filter.step(n / count, v / count);
      for (std::size_t i = first; i < k; ++i) add_classic_point(i, filter);
    }
  }

  // -- points

  WindPoint place_point(std::size_t k) {
    const Step& step = steps_.steps[k];
    WindPoint point;
    if (const auto& drag = series_.diagnostics.online_drag; drag && k < learning_.size()) {
      const LearnedStep& then = learning_[k];
      const bool whole = settings_.mode == Mode::smoothed;
      point.drag = {whole ? static_cast<float>(drag->factor) : std::exp(then.ln_factor),
                    whole ? static_cast<float>(drag->sd) : then.ln_factor_sd, then.updated};
    }
    point.time = step.time - ingest::seconds(vehicle_.latency_s);
    point.utc = flight_.clock.to_utc(point.time);
    point.v_up = -step.input.v_down;
    if (const auto i = nearest(flight_.position, point.time, 0)) point.place = flight_.position.value[*i];
    point.height_msl = height_at(flight_.height_msl, point.time, msl_hint_);
    point.height_agl = height_at(flight_.height_ground, point.time, agl_hint_);
    if (!point.height_agl && point.height_msl && settings_.takeoff)
      point.height_agl = ingest::above_takeoff(*point.height_msl, *settings_.takeoff);
    return point;
  }

  template <class T>
  std::optional<std::size_t> nearest(const ingest::Stream<T>& stream, ingest::LogTime t, int) {
    if (stream.empty()) return std::nullopt;
    const auto at = ingest::last_at_or_before(stream, t);
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(at, 0));
  }

  template <class H>
  static std::optional<H> height_at(const ingest::Stream<H>& stream, ingest::LogTime t, std::size_t& hint) {
    if (stream.empty()) return std::nullopt;
    while (hint + 1 < stream.size() && stream.time[hint + 1] <= t) ++hint;
    if (hint + 1 >= stream.size() || stream.time[hint] > t) return stream.value[hint];
    const double span = ingest::to_seconds(stream.time[hint + 1] - stream.time[hint]);
    const double part = span > 0 ? ingest::to_seconds(t - stream.time[hint]) / span : 0;
    return H{stream.value[hint].m + part * (stream.value[hint + 1].m - stream.value[hint].m)};
  }

  void add_point(std::size_t k, const WindPosterior* wind, const ConsiderCovariance& consider, bool trim_is_state,
                 const Eigen::Matrix2d* considered = nullptr) {
    const Step& step = steps_.steps[k];
    WindPoint point = place_point(k);
    if (!wind || !step.sound) {
      point.wind = NoEstimate{step.sound ? Reason::converging : step.fault};
      point.reasons.add(std::get<NoEstimate>(point.wind).reason);
      series_.points.push_back(std::move(point));
      return;
    }
    if (wind->without_trim(0, 0) > 1 || wind->without_trim(1, 1) > 1) {
      point.wind = NoEstimate{Reason::converging};
      point.reasons.add(Reason::converging);
      series_.points.push_back(std::move(point));
      return;
    }
    WindEstimate estimate;
    estimate.v_NA_N = wind->wind;
    auto C = consider;
    if (trim_is_state) C.block<2, 2>(c_trim_x, c_trim_x).setZero();
    const Eigen::Matrix2d constant = wind->sensitivity * C * wind->sensitivity.transpose();
    estimate.covariance = wind->covariance + (considered ? *considered : constant);
    point.wind = estimate;
    point.v_AB_N = wind->velocity - wind->wind;
    judge(point, estimate, step, trim_is_state);
    series_.points.push_back(std::move(point));
  }

  void add_classic_point(std::size_t k, const ClassicFilter& filter) {
    WindPoint point = place_point(k);
    if (!steps_.steps[k].sound) {
      point.wind = NoEstimate{steps_.steps[k].fault};
      point.reasons.add(steps_.steps[k].fault);
      series_.points.push_back(std::move(point));
      return;
    }
    WindEstimate estimate;
    estimate.v_NA_N = filter.wind();
    estimate.has_covariance = false;
    point.wind = estimate;
    point.v_AB_N = filter.airspeed();
    // It reports no uncertainty, so it can never be called good.
    point.quality = Quality::doubtful;
    if (vehicle_.is_prior()) point.reasons.add(Reason::uncalibrated);
    series_.points.push_back(std::move(point));
  }

  /// What makes a value doubtful. Source: MODEL.md section 10.
  void judge(WindPoint& point, const WindEstimate& wind, const Step& step, bool trim_is_state) {
    Reasons doubts;
    if (step.input.v_down > descent_limit()) doubts.add(Reason::fast_descent);
    if (!trim_is_state) doubts.add(Reason::trim_unobserved);
    const double speed = wind.v_NA_N.norm();
    const double widest = std::sqrt(std::max(wind.covariance(0, 0), wind.covariance(1, 1)));
    if (widest > 1 && widest > 0.3 * speed) doubts.add(Reason::wide_uncertainty);
    const double airspeed = (step.v - wind.v_NA_N).norm();
    auto& d = series_.diagnostics;
    d.max_airspeed = std::max(d.max_airspeed, airspeed);
    if (vehicle_.airspeed_range_m_s.y() > 0 && airspeed > 1.1 * vehicle_.airspeed_range_m_s.y())
      doubts.add(Reason::outside_airspeed_range);
    if (point.height_agl && point.height_agl->m < 3) doubts.add(Reason::low_height);
    if (jump_test_off_) doubts.add(Reason::model_fault);
    point.quality = doubts.at_best();
    point.reasons.add(doubts);
    if (vehicle_.is_prior()) point.reasons.add(Reason::uncalibrated);
    if (density_.standard) point.reasons.add(Reason::standard_density);
  }

  /// Half the induced velocity of the hover where mass and rotors are known, 2 m/s at most [m/s].
  double descent_limit() const {
    constexpr double most = 2;
    if (!vehicle_.mass_kg || !vehicle_.rotor_diameter_m || vehicle_.rotors == 0) return most;
    const double area = vehicle_.rotors * std::numbers::pi / 4 * std::pow(*vehicle_.rotor_diameter_m, 2);
    const double induced = std::sqrt(*vehicle_.mass_kg * ingest::standard_gravity / (2 * density_.value * area));
    return std::min(most, induced / 2);
  }

  // -- what the flight says about itself

  void note(const ForwardPass& pass) {
    auto& d = series_.diagnostics;
    d.rejected = pass.rejected;
    d.restarts = pass.restarts;
    d.log_likelihood = pass.log_likelihood;
    d.nis_mean = pass.updates ? pass.nis_sum / static_cast<double>(pass.updates) : 0;
    d.jump_test_off = jump_test_off_;
  }

  void note_trim(const State<double>& x, const StateMatrix<double>& P) {
    const double g = ingest::standard_gravity * degree;
    auto& d = series_.diagnostics;
    d.trim_deg = {-x(i_b + 1) / g, x(i_b) / g};
    const auto& prior = pass_.trim_covariance;
    const bool frozen = P(i_b, i_b) == 0;
    d.trim_sd_deg = {std::sqrt(frozen ? prior(1, 1) : P(i_b + 1, i_b + 1)) / g,
                     std::sqrt(frozen ? prior(0, 0) : P(i_b, i_b)) / g};
  }

  void finish_diagnostics() {
    auto& d = series_.diagnostics;
    d.sigma_u = pass_.model.turbulence_sd;
    d.excitation = excitation();
    for (const auto& step : steps_.steps) d.max_tilt_deg = std::max(d.max_tilt_deg, step.tilt / degree);
  }

  double excitation() const {
    ExcitationSums sums;
    for (const auto& step : steps_.steps)
      if (step.sound) sums.add(step.v.x(), step.v.y(), step.heading);
    return sums.weight() < 3 ? 0 : sums.index();
  }

  const Flight& flight_;
  const EstimateSettings& settings_;
  Density density_;
  Vehicle vehicle_;
  Steps steps_;
  PassSettings pass_;
  WindSeries series_;
  std::optional<ConsiderCovariance> learned_;  ///< in place of the vehicle's, where drag and latency were learned
  std::vector<LearnedStep> learning_;          ///< per step, where they were to be
  bool jump_test_off_ = false;
  std::size_t msl_hint_ = 0, agl_hint_ = 0;
};

}  // namespace

ingest::Result<WindSeries> estimate_wind(const Flight& flight, const Vehicle& vehicle,
                                         const EstimateSettings& settings) {
  if (flight.attitude.empty())
    return ingest::fail(Kind::missing, "the flight has no attitude, and the wind is read from the tilt", {},
                        "log the attitude (quaternion or roll, pitch, yaw) at 5 Hz or more");
  if (flight.velocity.empty())
    return ingest::fail(Kind::missing, "the flight has neither velocity nor a position to take it from", {},
                        "log the GPS velocity or position");
  auto series = Estimation(flight, vehicle, settings).run();
  const bool any = std::any_of(series.points.begin(), series.points.end(),
                               [](const WindPoint& p) { return std::holds_alternative<WindEstimate>(p.wind); });
  if (!any) {
    const Reason why =
        series.points.empty() ? Reason::no_samples : std::get<NoEstimate>(series.points.back().wind).reason;
    return ingest::fail(Kind::no_answer, fmt::format("no instant of this flight has a wind: {}", sentence(why)), {},
                        "fly for a minute or more with attitude and velocity logged, turning the nose once round");
  }
  return series;
}

}  // namespace quadsonde::estimator
