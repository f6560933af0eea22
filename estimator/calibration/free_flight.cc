#include "estimator/calibration/free_flight.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "estimator/calibration/excitation.h"
#include "estimator/smoother/passes.h"

namespace quadsonde::estimator {
namespace {

using ingest::fail;
using ingest::Kind;
using ingest::Problem;
using ingest::Vehicle;

// Beyond these there is no answer: half the range of ln c and the referee's distance beyond its own sd; that distance
// by itself, twice what the design notes give it, for a referee that knows little; the formal sd of ln c.
constexpr double most_half_range = 0.10, most_referee_by_itself = 0.40, most_formal = 0.15;
constexpr double least_between = 0.06;       // of the drag from flight to flight (1 sigma)
constexpr double trim_between_deg = 0.3;     // of the trim
constexpr double most_trim_sd_deg = 0.2;     // of a trim worth keeping: longer flights give 0.1
constexpr double least_likelihood_gain = 4;  // before kappa is believed
constexpr double turned_enough = 0.4;        // heading index from which a trim is told apart from wind
// A calibration starts from nothing: a class prior is a start and a scale, not evidence.
constexpr double open_ln_drag_sd = 1, open_latency_sd = 0.3;
constexpr std::array<TiltNoise, 4> noises{TiltNoise{0.5, 0}, TiltNoise{0.5, 1}, TiltNoise{1, 1}, TiltNoise{2, 1}};

struct Density {
  double value;
  bool standard;
};

Density density_of(const FreeFlight& f) {
  if (f.air_density) return {*f.air_density, false};
  double sum = 0;
  int count = 0;
  for (const auto& air : f.flight.air.value)
    if (air.pressure_pa && air.temperature_k)
      sum += ingest::air_density(*air.pressure_pa, *air.temperature_k, air.relative_humidity_pct.value_or(50)), ++count;
  if (count > 0) return {sum / count, false};
  const auto& heights = f.flight.height_msl;
  return {heights.empty() ? ingest::sea_level_air_density
                          : ingest::standard_air_density(heights.value[heights.size() / 2].m),
          true};
}

/// The vehicle's seven parameters as those of the fit: ln delta for delta, without the climb law.
FitVector parameters_of(const Vehicle& v) {
  FitVector at;
  at << std::log(v.drag.linear), v.drag.quadratic, v.latency_s, v.trim_roll_deg, v.trim_pitch_deg;
  return at;
}
constexpr std::array<int, fit_count> file_place{ingest::p_linear, ingest::p_quadratic, ingest::p_latency,
                                                ingest::p_trim_roll, ingest::p_trim_pitch};
FitMatrix covariance_of(const Vehicle& v) {
  FitMatrix C;
  for (int i = 0; i < fit_count; ++i)
    for (int j = 0; j < fit_count; ++j)
      C(i, j) = v.covariance(file_place[static_cast<std::size_t>(i)], file_place[static_cast<std::size_t>(j)]);
  C.row(f_drag) /= v.drag.linear;
  C.col(f_drag) /= v.drag.linear;
  return C;
}

/// One factor on the whole law, as a direction of the parameters: d(ln delta) = 1, d kappa = kappa.
FitVector factor_direction(const FitVector& at) {
  FitVector g = FitVector::Zero();
  g(f_drag) = 1;
  g(f_quadratic) = at(f_quadratic);
  return g;
}

/// ln of what the law must be multiplied with to have c at an airspeed.
void scale_law(FitVector& at, double factor) {
  at(f_drag) += std::log(factor);
  at(f_quadratic) *= factor;
}

/// sd of ln c at an airspeed.
double ln_drag_sd(const FitVector& at, const FitMatrix& C, double airspeed) {
  const double delta = std::exp(at(f_drag)), c = fitted_drag(at, airspeed);
  const Eigen::Vector2d lever(delta / c, airspeed / c);
  return std::sqrt(std::max(0.0, lever.dot(C.topLeftCorner<2, 2>() * lever)));
}

std::string minutes(double seconds) {
  return seconds < 120 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.1f} min", seconds / 60);
}

class Calibration {
 public:
  Calibration(const std::vector<FreeFlight>& flights, const FreeFlightSettings& settings)
      : flights_(flights), given_(settings) {
    out_.vehicle = settings.prior;
  }

  FreeFlightCalibration run() {
    look_at_flights();
    set_prior();
    if (used_.empty()) {
      refuse_by_excitation();
    } else {
      fit();
      if (!out_.refused) settle();
    }
    report();
    return std::move(out_);
  }

 private:
  // -- the flights

  void look_at_flights() {
    for (const auto& f : flights_) {
      motions_.push_back(std::make_unique<SlowMotion>(f.flight, SlowSettings{}));
      const SlowSteps& slow = motions_.back()->steps(0, 0.2);
      FreeFlightRun run;
      run.name = f.name;
      if (const auto span = ingest::time_span(f.flight)) run.seconds = ingest::to_seconds(span->second - span->first);
      const auto density = density_of(f);
      run.air_density = density.value, run.standard_density = density.standard;
      run.windows = slow.sound;
      run.excitation = excitation_index(slow.steps);
      run.heading_index = slow.steps.empty() ? 0 : heading_index(slow.steps, slow.steps.size());
      run.used = run.excitation >= enough_excitation && run.windows >= 10;
      if (!run.used)
        run.why_not = run.windows < 10
                          ? fmt::format("only {} windows of {:g} s can be used", run.windows, SlowSettings{}.window)
                          : fmt::format("X is {:.2f} m/s, below {:g}: its motion could as well be wind or trim",
                                        run.excitation, enough_excitation);
      out_.runs.push_back(run);
    }
    double square = 0, windows = 0, density = 0;
    for (std::size_t k = 0; k < out_.runs.size(); ++k) {
      const auto& run = out_.runs[k];
      if (!run.used) continue;
      used_.push_back(k);
      const auto n = static_cast<double>(run.windows);
      square += n * run.excitation * run.excitation, density += n * run.air_density, windows += n;
    }
    if (used_.empty()) {
      for (const auto& run : out_.runs) out_.excitation = std::max(out_.excitation, run.excitation);
      return;
    }
    out_.excitation = std::sqrt(square / windows);
    density_ = density / windows;
    note_density();
  }

  void note_density() {
    const bool standard =
        std::any_of(used_.begin(), used_.end(), [&](auto k) { return out_.runs[k].standard_density; });
    if (!standard) return;
    out_.notes.push_back({Kind::doubtful,
                          "the air density is not in the logs and was taken from the standard atmosphere",
                          {},
                          "some per cent of the drag may hang on it; log temperature and pressure, or give --sensor"});
  }

  FitFlight fit_flight(std::size_t k) const {
    return {motions_[k].get(), out_.runs[k].air_density / prior_.air_density_kg_m3,
            out_.runs[k].heading_index >= turned_enough};
  }

  // -- the prior

  bool updating() const { return !given_.prior.is_prior(); }

  void set_prior() {
    prior_ = given_.prior;
    if (updating()) {
      // Without a mass asked for, and with the file's own density, nothing can fail.
      prior_ = ingest::flown_at(given_.prior, given_.prior.mass_kg ? given_.mass : std::nullopt,
                                given_.prior.air_density_kg_m3)
                   .value_or(given_.prior);
    } else if (density_ > 0) {
      prior_.air_density_kg_m3 = density_;
    }
    fit_.prior = parameters_of(prior_);
    fit_.climb = prior_.drag;
    fit_.climb.linear = fit_.climb.quadratic = 0;
    fit_.density_exponent = prior_.density_exponent;
    fit_.trim_between_deg = used_.size() > 1 ? trim_between_deg : 0;
    FitMatrix C = covariance_of(prior_);
    prior_sd_ = C.diagonal().cwiseSqrt();
    if (updating()) {
      // Between its flights and these the vehicle may have changed.
      const FitVector g = factor_direction(fit_.prior);
      C += std::pow(std::max(least_between, prior_.between_flights_rel_sd), 2) * g * g.transpose();
      C(f_trim_roll, f_trim_roll) += trim_between_deg * trim_between_deg;
      C(f_trim_pitch, f_trim_pitch) += trim_between_deg * trim_between_deg;
      fit_.quadratic = true;
    } else {
      C(f_drag, f_drag) = open_ln_drag_sd * open_ln_drag_sd;
      C(f_latency, f_latency) = open_latency_sd * open_latency_sd;
    }
    C.diagonal().array() += 1e-10;
    fit_.prior_information = C.inverse();
  }

  // -- the search

  std::vector<FitFlight> used_flights() const {
    std::vector<FitFlight> all;
    for (const auto k : used_) all.push_back(fit_flight(k));
    return all;
  }

  std::vector<RefereeFlight> referee_flights() const {
    std::vector<RefereeFlight> all;
    for (const auto k : used_) {
      const auto f = fit_flight(k);
      all.push_back({&flights_[k].flight, std::pow(f.density_ratio, prior_.density_exponent), f.turned});
    }
    return all;
  }

  void fit() {
    const auto all = used_flights();
    const auto coarse = judge_without_law(referee_flights());
    FitVector start = fit_.prior;
    for (const auto& noise : noises) {
      fit_.noise = noise;
      fits_.push_back(fit_free_flights(all, fit_, start));
      if (fits_.back().converged) start = fits_.back().at;
    }
    best_ = 0;
    for (std::size_t i = 1; i < fits_.size(); ++i)
      if (fits_[i].log_likelihood > fits_[best_].log_likelihood) best_ = i;
    fit_.noise = noises[best_];
    out_.referee = judge_without_law(referee_flights(), fits_[best_].at(f_latency));
    try_quadratic(all);
    find_airspeeds();
    for (std::size_t i = 0; i < fits_.size(); ++i) {
      const auto& f = fits_[i];
      out_.assumed.push_back({noises[i], fitted_drag(f.at, out_.airspeed),
                              ln_drag_sd(f.at, f.covariance, out_.airspeed), f.at(f_latency), f.log_likelihood,
                              f.converged});
    }
    second_start(all, coarse);
    weigh();
    for (std::size_t i = 0; i < used_.size(); ++i) out_.runs[used_[i]].turbulence_sd = fits_[best_].turbulence_sd[i];
    if (used_.size() > 1) look_between();
  }

  /// kappa, if the flights ask for it by themselves.
  void try_quadratic(const std::vector<FitFlight>& all) {
    if (fit_.quadratic) {
      out_.quadratic = true;
      return;
    }
    auto free = fit_;
    free.quadratic = true;
    const auto with = fit_free_flights(all, free, fits_[best_].at);
    const double kappa_sd =
        std::sqrt(FitMatrix(with.information + only_prior_of_others()).inverse()(f_quadratic, f_quadratic));
    out_.quadratic_gain = 0.5 * std::pow(with.at(f_quadratic) / kappa_sd, 2);
    if (!with.converged || out_.quadratic_gain <= least_likelihood_gain || with.at(f_quadratic) < 0) return;
    out_.quadratic = fit_.quadratic = true;
    for (std::size_t i = 0; i < noises.size(); ++i) {
      fit_.noise = noises[i];
      fits_[i] = fit_free_flights(all, fit_, with.at);
    }
    fit_.noise = noises[best_];
  }

  /// What is known of all but kappa beforehand.
  FitMatrix only_prior_of_others() const {
    FitMatrix others = fit_.prior_information;
    others.row(f_quadratic).setZero();
    others.col(f_quadratic).setZero();
    return others;
  }

  /// Airspeeds flown, with the winds of the referee (constant per flight) or, without it, over ground. The mean weighs
  /// each by its square: a constant c fitted to c(a) a over them is c there, and not at the plain mean.
  void find_airspeeds() {
    std::vector<double> all;
    for (std::size_t i = 0; i < used_.size(); ++i) {
      const Eigen::Vector2d wind = out_.referee ? out_.referee->wind[i] : Eigen::Vector2d::Zero();
      for (const auto& step : motions_[used_[i]]->steps(fits_[best_].at(f_latency), prior_.drag.linear).steps)
        if (step.sound) all.push_back((step.v - wind).norm());
    }
    if (all.empty()) return;
    std::sort(all.begin(), all.end());
    double square = 0, cube = 0;
    for (const double a : all) square += a * a, cube += a * a * a;
    out_.airspeed = square > 0 ? cube / square : 0;
    range_ = {all[all.size() * 2 / 100], all[std::min(all.size() - 1, all.size() * 98 / 100)]};
  }

  /// The same end from another beginning.
  void second_start(const std::vector<FitFlight>& all, const std::optional<Referee>& coarse) {
    FitVector start = fit_.prior;
    start(f_drag) = std::log(coarse ? coarse->drag : 2 * std::exp(fit_.prior(f_drag)));
    start(f_latency) = coarse ? coarse->latency : 0.2;
    const auto other = fit_free_flights(all, fit_, start);
    const auto& f = fits_[best_];
    const double sd = std::sqrt(f.covariance(f_drag, f_drag));
    if (!f.converged || !other.converged || std::abs(other.at(f_drag) - f.at(f_drag)) > 0.2 * sd + 0.005)
      out_.refused = "the search ended at different drags from different starts";
  }

  void weigh() {
    double low = 1e9, high = -1e9;
    for (const auto& a : out_.assumed)
      if (a.converged) low = std::min(low, std::log(a.drag)), high = std::max(high, std::log(a.drag));
    if (out_.refused || !(high >= low)) return;
    const double middle = 0.5 * (low + high), law_half = 0.5 * (high - low);
    // Least squares err by more than the filter, most in a short flight: what lies beyond their own sd counts.
    const double away = out_.referee ? std::abs(std::log(out_.referee->drag) - middle) : 0;
    const double beyond = out_.referee ? std::max(0.0, away - out_.referee->drag_sd / out_.referee->drag) : 0;
    const double half = std::max(law_half, beyond);
    const double formal = ln_drag_sd(fits_[best_].at, fits_[best_].covariance, out_.airspeed);
    // Which noise it was, recorded flights do not tell well enough: the widest assumption states the sd.
    double widest = formal;
    for (const auto& a : out_.assumed)
      if (a.converged) widest = std::max(widest, a.drag_rel_sd);
    out_.seen = FreeFlightCalibration::Seen{std::exp(middle), std::max(widest, half), formal, half};
    if (!out_.referee)
      out_.refused = "least squares without a drag law find no drag at all";
    else if (beyond > most_half_range || away > most_referee_by_itself)
      out_.refused =
          fmt::format("least squares without a drag law find {:.3f} +- {:.3f} 1/s, {:.0f} % away from {:.3f}",
                      out_.referee->drag, out_.referee->drag_sd, 100 * away, std::exp(middle));
    else if (law_half > most_half_range)
      out_.refused = fmt::format(
          "the drag hangs on what is assumed of the noise: {:.3f} to {:.3f} 1/s, more than "
          "+-{:.0f} %",
          std::exp(low), std::exp(high), 100 * most_half_range);
    else if (formal > most_formal)
      out_.refused = fmt::format("the flights know the drag to +-{:.0f} % only (1 sigma)", 100 * formal);
  }

  /// Do the flights agree with each other?
  void look_between() {
    double chi2 = 0, spread = 0, noise = 0;
    for (std::size_t i = 0; i < used_.size(); ++i) {
      const auto one = fit_free_flights({fit_flight(used_[i])}, fit_, fits_[best_].at);
      auto& run = out_.runs[used_[i]];
      const double sd = ln_drag_sd(one.at, one.covariance, out_.airspeed);
      run.drag = fitted_drag(one.at, out_.airspeed);
      run.drag_sd = *run.drag * sd;
      const double off = std::log(*run.drag / fitted_drag(fits_[best_].at, out_.airspeed));
      chi2 += off * off / (sd * sd), spread += off * off, noise += sd * sd;
    }
    const auto n = static_cast<double>(used_.size());
    between_ = std::sqrt(std::max(0.0, (spread - noise * (n - 1) / n) / (n - 1)));
    scatter_ = std::sqrt(std::max(1.0, chi2 / (n - 1)));
  }

  // -- the vehicle

  /// The end of the search as a measurement of the vehicle, with everything that its sd must hold.
  void settle() {
    const auto& best = fits_[best_];
    FitVector at = best.at;
    FitMatrix C = best.covariance;
    const double had = fitted_drag(at, out_.airspeed);
    scale_law(at, out_.seen->drag / had);
    const double wanted = std::max(out_.seen->rel_sd, scatter_ * out_.seen->formal_rel_sd);
    const double missing = wanted * wanted - std::pow(out_.seen->formal_rel_sd, 2);
    const FitVector g = factor_direction(at);
    if (missing > 0) C += missing * g * g.transpose();
    out_.seen->rel_sd = wanted;
    for (const int i : {f_latency, f_trim_roll, f_trim_pitch}) widen_by_range(C, i);
    if (updating())
      update(at, C);
    else
      keep_what_is_determined(at, C);
    write_vehicle(at, C);
  }

  void widen_by_range(FitMatrix& C, int i) const {
    double low = 1e9, high = -1e9;
    for (const auto& f : fits_)
      if (f.converged) low = std::min(low, f.at(i)), high = std::max(high, f.at(i));
    const double half = 0.5 * (high - low);
    if (half * half > C(i, i)) C(i, i) = half * half;
  }

  /// What a calibration does not determine stays at its prior: a trim of half a minute would harm the next flight.
  void keep_what_is_determined(FitVector& at, FitMatrix& C) {
    const auto reset = [&](int i) {
      at(i) = fit_.prior(i);
      C.row(i).setZero(), C.col(i).setZero();
      C(i, i) = prior_sd_(i) * prior_sd_(i);
    };
    const double trim_sd = std::sqrt(std::max(C(f_trim_roll, f_trim_roll), C(f_trim_pitch, f_trim_pitch)));
    out_.trim_determined = trim_sd <= most_trim_sd_deg;
    if (!out_.trim_determined) reset(f_trim_roll), reset(f_trim_pitch);
    out_.latency_determined = std::sqrt(C(f_latency, f_latency)) < 0.7 * prior_sd_(f_latency);
    if (!out_.latency_determined) reset(f_latency);
  }

  /// Bayes: the prior was inside the search; what is left is that these flights differ from the vehicle's mean.
  void update(FitVector& at, FitMatrix& C) {
    const FitMatrix P = fit_.prior_information.inverse();
    const FitVector g = factor_direction(at);
    // The flights' own word, taken out of the posterior, and its sd with the variation between flights.
    const FitMatrix own_information =
        C.inverse() - fit_.prior_information +
        FitMatrix(prior_sd_.cwiseMax(1e-4).cwiseAbs2().cwiseInverse().asDiagonal()) * 1e-4;
    const FitMatrix own = own_information.inverse();
    const FitVector word = at + own * fit_.prior_information * (at - fit_.prior);
    FitMatrix R = own + least_between * least_between * g * g.transpose();
    R(f_trim_roll, f_trim_roll) += trim_between_deg * trim_between_deg;
    R(f_trim_pitch, f_trim_pitch) += trim_between_deg * trim_between_deg;
    const FitMatrix K = P * (P + R).inverse();
    at = fit_.prior + K * (word - fit_.prior);
    C = (P - K * P).eval();
    C = (0.5 * (C + C.transpose())).eval();
    out_.trim_determined = out_.latency_determined = true;
  }

  void write_vehicle(const FitVector& at, const FitMatrix& C) {
    Vehicle& v = out_.vehicle;
    v = prior_;
    v.drag.linear = std::exp(at(f_drag));
    v.drag.quadratic = at(f_quadratic);
    v.latency_s = at(f_latency);
    v.trim_roll_deg = at(f_trim_roll), v.trim_pitch_deg = at(f_trim_pitch);
    FitMatrix file = C;
    file.row(f_drag) *= v.drag.linear;
    file.col(f_drag) *= v.drag.linear;
    for (int i = 0; i < fit_count; ++i)
      for (int j = 0; j < fit_count; ++j)
        v.covariance(file_place[static_cast<std::size_t>(i)], file_place[static_cast<std::size_t>(j)]) =
            0.5 * (file(i, j) + file(j, i));
    v.between_flights_rel_sd = std::max({least_between, between_, updating() ? prior_.between_flights_rel_sd : 0.0});
    if (given_.mass) v.mass_kg = given_.mass;
    v.airspeed_range_m_s = range_;
    if (updating()) {
      v.airspeed_range_m_s.x() = std::min(range_.x(), given_.prior.airspeed_range_m_s.x());
      v.airspeed_range_m_s.y() = std::max(range_.y(), given_.prior.airspeed_range_m_s.y());
      note_moves();
    } else {
      v.id.clear(), v.name.clear();
    }
    v.tilt_sd_deg = fit_.noise.sd_deg, v.tilt_correlation_s = fit_.noise.correlation_s;
    v.method = "free-flight";
    v.excitation_m_s = out_.excitation;
    v.residual_rms_m_s2 = out_.referee ? std::optional(out_.referee->residual_rms) : std::nullopt;
    v.leave_one_out_m_s.reset();
  }

  void note_moves() {
    const Vehicle &a = given_.prior, &b = out_.vehicle;
    const auto move = [&](const char* what, const char* unit, ingest::DragParameter p, double before, double after) {
      out_.moves.push_back({what, unit, before, a.parameter_sd(p), after, b.parameter_sd(p)});
    };
    const auto c_sd = [&](const Vehicle& v) {
      const Eigen::Vector2d lever(1, out_.airspeed);
      return std::sqrt(std::max(0.0, lever.dot(v.covariance.topLeftCorner<2, 2>() * lever)));
    };
    const auto c = [&](const Vehicle& v) { return v.drag.linear + v.drag.quadratic * out_.airspeed; };
    out_.moves.push_back({fmt::format("drag at {:.1f} m/s", out_.airspeed), "1/s", c(a), c_sd(a), c(b), c_sd(b)});
    move("linear drag", "1/s", ingest::p_linear, a.drag.linear, b.drag.linear);
    move("quadratic drag", "1/m", ingest::p_quadratic, a.drag.quadratic, b.drag.quadratic);
    move("latency", "s", ingest::p_latency, a.latency_s, b.latency_s);
    move("trim in roll", "deg", ingest::p_trim_roll, a.trim_roll_deg, b.trim_roll_deg);
    move("trim in pitch", "deg", ingest::p_trim_pitch, a.trim_pitch_deg, b.trim_pitch_deg);
  }

  // -- no

  void refuse_by_excitation() {
    out_.refused =
        out_.runs.size() == 1
            ? fmt::format("{} of flight cannot tell the drag: {}", minutes(out_.runs[0].seconds), out_.runs[0].why_not)
            : fmt::format("none of {} flights can tell the drag: the largest X is {:.2f} m/s, below {:g}",
                          out_.runs.size(), out_.excitation, enough_excitation);
    if (out_.excitation < some_excitation) return;
    // For information only: what the best flight seems to say.
    for (std::size_t k = 0; k < out_.runs.size(); ++k) {
      if (out_.runs[k].excitation < out_.excitation || out_.runs[k].windows < 10) continue;
      fit_.noise = noises[1];
      const auto fit = fit_free_flights({fit_flight(k)}, fit_, fit_.prior);
      if (!fit.converged) return;
      const double sd = std::sqrt(fit.covariance(f_drag, f_drag));
      out_.seen = FreeFlightCalibration::Seen{std::exp(fit.at(f_drag)), sd, sd, 0};
      return;
    }
  }

  // -- what it all says

  void report() {
    FitMatrix information = FitMatrix::Zero();
    FitVector at = fit_.prior;
    double drag_sd = prior_sd_(f_drag);
    if (!fits_.empty()) information = fits_[best_].information, at = fits_[best_].at;
    if (!out_.refused && out_.seen) drag_sd = out_.seen->rel_sd;
    out_.identifiability = identify(information, prior_sd_.cwiseMax(1e-6), drag_sd);
    out_.identifiability.advice.push_back(
        estimator::advise(information, prior_sd_.cwiseMax(1e-6), at, fit_, out_.vehicle, !out_.refused, given_.advise));
  }

  const std::vector<FreeFlight>& flights_;
  const FreeFlightSettings& given_;
  FreeFlightCalibration out_;
  std::vector<std::unique_ptr<SlowMotion>> motions_;
  std::vector<std::size_t> used_;  ///< which of the flights
  double density_ = 0;
  Vehicle prior_;
  FitVector prior_sd_ = FitVector::Ones();
  FitSettings fit_;
  std::vector<FreeFit> fits_;  ///< one per assumption on the noise
  std::size_t best_ = 0;       ///< the likeliest
  Eigen::Vector2d range_ = Eigen::Vector2d::Zero();
  double between_ = 0, scatter_ = 1;
};

}  // namespace

ingest::Result<FreeFlightCalibration> calibrate_free_flight(const std::vector<FreeFlight>& flights,
                                                            const FreeFlightSettings& settings) {
  if (flights.empty()) return fail(Kind::usage, "no flight was given to calibrate from", {}, "give one log or more");
  for (const auto& f : flights) {
    if (f.flight.attitude.empty())
      return fail(Kind::missing, "the flight has no attitude, and the drag is read from the tilt", {f.name, {}, {}, {}},
                  "log the attitude (quaternion or roll, pitch, yaw) at 5 Hz or more");
    if (f.flight.velocity.empty())
      return fail(Kind::missing, "the flight has neither velocity nor a position to take it from", {f.name, {}, {}, {}},
                  "log the GPS velocity or position");
  }
  return Calibration(flights, settings).run();
}

}  // namespace quadsonde::estimator
