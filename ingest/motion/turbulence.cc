#include "ingest/motion/turbulence.h"

#include <algorithm>
#include <cmath>

namespace quadsonde::ingest {
namespace {

constexpr double foot = 0.3048;
constexpr double slowest = 0.5;  // [m/s]: the turbulence that passes a vehicle which drifts with the air still changes

class OrnsteinUhlenbeckGusts : public Gusts {
 public:
  OrnsteinUhlenbeckGusts(const WindField& field, double step, Gaussian& noise)
      : field_(field),
        north_(field.sigma_u, field.time_u, step, noise),
        east_(field.sigma_u, field.time_u, step, noise),
        down_(field.sigma_w, field.time_w, step, noise) {}
  Eigen::Vector3d next(double height, const Eigen::Vector2d&, double) override {
    Eigen::Vector3d gust;
    gust.z() = down_.next();
    gust.y() = east_.next();
    gust.x() = north_.next();
    if (field_.sigma_exponent != 0)
      gust *= std::pow(std::max(height, 1.0) / field_.reference_height, field_.sigma_exponent);
    return gust;
  }

 private:
  const WindField& field_;
  OrnsteinUhlenbeck north_, east_, down_;
};

class DrydenGusts : public Gusts {
 public:
  DrydenGusts(const WindField& field, double step, Gaussian& noise)
      : wind_at_6m_(field.wind_at_6m.value_or(field.mean(20 * foot, 0).norm())),
        step_(step),
        along_(noise),
        across_(noise),
        down_(noise) {}
  Eigen::Vector3d next(double height, const Eigen::Vector2d& mean, double airspeed) override {
    const DrydenScales scales = dryden_scales(height, wind_at_6m_);
    const double way = std::max(airspeed, slowest) * step_;
    const double u = scales.sigma_u * along_.next(way / scales.length_u);
    const double v = scales.sigma_u * across_.next(way / scales.length_u);
    const double w = scales.sigma_w * down_.next(way / scales.length_w);
    const double speed = mean.norm();
    const Eigen::Vector2d ahead = speed > 1e-6 ? Eigen::Vector2d(mean / speed) : Eigen::Vector2d(1, 0);
    return {u * ahead.x() - v * ahead.y(), u * ahead.y() + v * ahead.x(), w};
  }

 private:
  double wind_at_6m_, step_;
  DrydenLongitudinal along_;
  DrydenTransversal across_, down_;
};

}  // namespace

DrydenScales dryden_scales(double height, double wind_at_6m) {
  const double h = std::clamp(height / foot, 10.0, 1000.0);
  const double base = 0.177 + 0.000823 * h;
  DrydenScales scales;
  scales.length_w = h * foot;
  scales.length_u = h / std::pow(base, 1.2) * foot;
  scales.sigma_w = 0.1 * wind_at_6m;
  scales.sigma_u = scales.sigma_w / std::pow(base, 0.4);
  return scales;
}

double DrydenLongitudinal::next(double a) {
  const double decay = std::exp(-a);
  return value_ = decay * value_ + std::sqrt(-std::expm1(-2 * a)) * noise_();
}

// In time over T: dx1 = -x1 + sqrt(2) dW, dx2 = x1 - x2; stationary covariance [1 1/2; 1/2 1/2]. The filter's output is
// (sqrt(3) x1 + (1 - sqrt(3)) x2) / sqrt(2), of variance (3 + sqrt(3) (1 - sqrt(3)) + (1 - sqrt(3))^2 / 2) / 2 = 1.
DrydenTransversal::DrydenTransversal(Gaussian& noise) : noise_(noise), first_(noise()), second_(0) {
  second_ = 0.5 * first_ + 0.5 * noise();
}

double DrydenTransversal::next(double a) {
  // Transition exp(-a) [1 0; a 1]; driving noise Q = P - Phi P Phi', so that the variance holds at any step.
  const double e = std::exp(-a), e2 = e * e;
  const double q11 = -std::expm1(-2 * a);
  const double q12 = 0.5 - e2 * (a + 0.5);
  const double q22 = 0.5 - e2 * (a * a + a + 0.5);
  const double l11 = std::sqrt(q11), l21 = l11 > 0 ? q12 / l11 : 0;
  const double l22 = std::sqrt(std::max(q22 - l21 * l21, 0.0));
  const double n1 = noise_(), n2 = noise_();
  second_ = e * (a * first_ + second_) + l21 * n1 + l22 * n2;
  first_ = e * first_ + l11 * n1;
  constexpr double root3 = 1.7320508075688772;
  return (root3 * first_ + (1 - root3) * second_) / std::sqrt(2.0);
}

std::unique_ptr<Gusts> make_gusts(const WindField& field, double step, Gaussian& noise) {
  if (field.turbulence == WindField::Turbulence::dryden) return std::make_unique<DrydenGusts>(field, step, noise);
  return std::make_unique<OrnsteinUhlenbeckGusts>(field, step, noise);
}

}  // namespace quadsonde::ingest
