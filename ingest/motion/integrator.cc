#include "ingest/motion/integrator.h"

#include <cvodes/cvodes.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace quadsonde::ingest {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

struct Inputs {
  Vector2d slope, slope_rate;
  double heading, heading_rate, lift, v_down;
};

/// The course between two nodes and the parameters: what the right-hand sides read.
struct Segment {
  const MotionNode* from = nullptr;
  const MotionNode* to = nullptr;
  const MotionParameters* parameters = nullptr;

  Inputs at(double t) const {
    const double span = to->time - from->time, part = (t - from->time) / span;
    Inputs in;
    in.slope_rate = (to->slope - from->slope) / span;
    in.heading_rate = (to->heading - from->heading) / span;
    in.slope = from->slope + part * (to->slope - from->slope);
    in.heading = from->heading + part * (to->heading - from->heading);
    in.lift = from->lift + part * (to->lift - from->lift);
    in.v_down = from->v_down + part * (to->v_down - from->v_down);
    return in;
  }
};

Matrix2d turn(double heading) {
  Matrix2d r;
  r << std::cos(heading), -std::sin(heading), std::sin(heading), std::cos(heading);
  return r;
}

Vector3d airspeed(const Inputs& in, const Vector2d& v, const MotionParameters& p) {
  return {v.x() - p.wind.x(), v.y() - p.wind.y(), in.v_down};
}

/// Derivatives of vdot by v and by the parameters, at one state.
struct Slopes {
  Matrix2d by_v;
  Eigen::Matrix<double, 2, m_columns> by_parameter;
};

Slopes slopes(const Inputs& in, const Vector2d& v, const MotionParameters& p) {
  const Vector3d a = airspeed(in, v, p);
  const double size = std::max(a.norm(), 1e-12);
  const double factor = climb_factor(p.drag, -a.z()).value;
  const double c = (p.drag.linear + p.drag.quadratic * size) * factor;
  const Vector2d along = in.slope * a.z() + a.head<2>();  // what c multiplies, negative
  Slopes out;
  out.by_v = -c * Matrix2d::Identity() - (p.drag.quadratic * factor / size) * along * a.head<2>().transpose();
  out.by_parameter.setZero();
  out.by_parameter.middleCols<2>(m_wind_n) = -out.by_v;
  const Matrix2d r = turn(in.heading);
  out.by_parameter.middleCols<2>(m_trim_x) = r;
  out.by_parameter.col(m_linear) = -factor * along;
  out.by_parameter.col(m_quadratic) = -factor * size * along;
  const Vector2d turned = r * p.trim;
  // Read later: the value that was there before.
  out.by_parameter.col(m_latency) =
      -in.slope_rate * (in.lift - c * a.z()) - in.heading_rate * Vector2d(-turned.y(), turned.x());
  return out;
}

int right_hand_side(realtype t, N_Vector y, N_Vector ydot, void* data) {
  const auto& segment = *static_cast<const Segment*>(data);
  const Inputs in = segment.at(t);
  const Eigen::Map<const Vector2d> v(NV_DATA_S(y));
  const auto& p = *segment.parameters;
  const Vector2d b = turn(in.heading) * p.trim;
  const Vector2d vdot = horizontal_acceleration<double>(p.drag, in.slope, in.lift, airspeed(in, v, p), b);
  double* out = NV_DATA_S(ydot);
  out[0] = vdot.x(), out[1] = vdot.y(), out[2] = v.x(), out[3] = v.y();
  return std::isfinite(out[0]) && std::isfinite(out[1]) ? 0 : -1;
}

int sensitivity_side(int columns, realtype t, N_Vector y, N_Vector, N_Vector* s, N_Vector* sdot, void* data, N_Vector,
                     N_Vector) {
  const auto& segment = *static_cast<const Segment*>(data);
  const Eigen::Map<const Vector2d> v(NV_DATA_S(y));
  const Slopes d = slopes(segment.at(t), v, *segment.parameters);
  for (int k = 0; k < columns; ++k) {
    const Eigen::Map<const Vector2d> sv(NV_DATA_S(s[k]));
    const Vector2d rate = d.by_v * sv + d.by_parameter.col(k);
    double* out = NV_DATA_S(sdot[k]);
    out[0] = rate.x(), out[1] = rate.y(), out[2] = sv.x(), out[3] = sv.y();
  }
  return 0;
}

/// Owns everything that SUNDIALS hands out.
class Cvodes {
 public:
  explicit Cvodes(const IntegrationSettings& settings) : with_s_(settings.sensitivities), settings_(settings) {}
  Cvodes(const Cvodes&) = delete;
  Cvodes& operator=(const Cvodes&) = delete;
  ~Cvodes() {
    if (memory_) CVodeFree(&memory_);
    if (solver_) SUNNonlinSolFree(solver_);
    if (s_solver_) SUNNonlinSolFree(s_solver_);
    if (s_) N_VDestroyVectorArray(s_, m_columns);
    if (y_) N_VDestroy(y_);
    if (context_) SUNContext_Free(&context_);
  }

  bool start(double t, const Vector2d& v0, const Vector2d& p0, Segment* segment) {
    if (SUNContext_Create(nullptr, &context_) != 0) return false;
    y_ = N_VNew_Serial(4, context_);
    memory_ = CVodeCreate(CV_ADAMS, context_);
    if (!y_ || !memory_) return false;
    Eigen::Map<Eigen::Vector4d>(NV_DATA_S(y_)) << v0, p0;
    solver_ = SUNNonlinSol_FixedPoint(y_, 0, context_);
    const bool ok = solver_ && CVodeInit(memory_, right_hand_side, t, y_) == CV_SUCCESS &&
                    CVodeSStolerances(memory_, settings_.relative, settings_.absolute) == CV_SUCCESS &&
                    CVodeSetUserData(memory_, segment) == CV_SUCCESS &&
                    CVodeSetMaxNumSteps(memory_, 100000) == CV_SUCCESS &&
                    CVodeSetErrHandlerFn(
                        memory_, [](int, const char*, const char*, char*, void*) {}, nullptr) == CV_SUCCESS &&
                    CVodeSetNonlinearSolver(memory_, solver_) == CV_SUCCESS;
    return ok && (!with_s_ || start_sensitivities());
  }
  /// Behind a kink the history of the multistep method is of no use.
  bool restart(double t) {
    return CVodeReInit(memory_, t, y_) == CV_SUCCESS &&
           (!with_s_ || CVodeSensReInit(memory_, CV_SIMULTANEOUS, s_) == CV_SUCCESS);
  }
  /// To t, and not beyond `stop`.
  bool advance(double t, double stop) {
    realtype reached = 0;
    if (CVodeSetStopTime(memory_, stop) != CV_SUCCESS) return false;
    if (CVode(memory_, t, y_, &reached, CV_NORMAL) < 0) return false;
    return !with_s_ || CVodeGetSens(memory_, &reached, s_) == CV_SUCCESS;
  }
  MotionState state(double t) const {
    MotionState out;
    const double* y = NV_DATA_S(y_);
    out.time = t;
    out.v << y[0], y[1];
    out.p << y[2], y[3];
    for (int k = 0; with_s_ && k < m_columns; ++k)
      out.sensitivity.col(k) = Eigen::Map<const Eigen::Vector4d>(NV_DATA_S(s_[k]));
    return out;
  }

 private:
  bool start_sensitivities() {
    s_ = N_VCloneVectorArray(m_columns, y_);
    if (!s_) return false;
    for (int k = 0; k < m_columns; ++k) N_VConst(0, s_[k]);
    NV_Ith_S(s_[m_v0_n], 0) = 1;
    NV_Ith_S(s_[m_v0_e], 1) = 1;
    std::vector<realtype> absolute(m_columns, settings_.absolute);
    s_solver_ = SUNNonlinSol_FixedPointSens(m_columns + 1, y_, 0, context_);
    return s_solver_ && CVodeSensInit(memory_, m_columns, CV_SIMULTANEOUS, sensitivity_side, s_) == CV_SUCCESS &&
           CVodeSensSStolerances(memory_, settings_.relative, absolute.data()) == CV_SUCCESS &&
           CVodeSetSensErrCon(memory_, SUNTRUE) == CV_SUCCESS &&
           CVodeSetNonlinearSolverSensSim(memory_, s_solver_) == CV_SUCCESS;
  }

  bool with_s_;
  IntegrationSettings settings_;
  SUNContext context_ = nullptr;
  void* memory_ = nullptr;
  N_Vector y_ = nullptr;
  N_Vector* s_ = nullptr;
  SUNNonlinearSolver solver_ = nullptr, s_solver_ = nullptr;
};

bool in_order(const MotionCourse& course, const std::vector<double>& times) {
  if (course.size() < 2 || course.back().time <= course.front().time) return false;
  const auto earlier = [](const MotionNode& a, const MotionNode& b) { return a.time < b.time; };
  return std::is_sorted(course.begin(), course.end(), earlier) && std::is_sorted(times.begin(), times.end()) &&
         (times.empty() || (times.front() >= course.front().time && times.back() <= course.back().time));
}

}  // namespace

Result<std::vector<MotionState>> integrate(const MotionCourse& course, const Vector2d& v0, const Vector2d& p0,
                                           const MotionParameters& parameters, const std::vector<double>& times,
                                           const IntegrationSettings& settings) {
  if (!in_order(course, times)) return fail(Kind::usage, "the course and the times to integrate to must ascend");
  Segment segment{&course[0], &course[1], &parameters};
  Cvodes solver(settings);
  if (!solver.start(course.front().time, v0, p0, &segment))
    return fail(Kind::no_answer, "SUNDIALS could not be set up");
  std::vector<MotionState> out;
  out.reserve(times.size());
  bool fresh = true;
  for (std::size_t i = 0; i + 1 < course.size() && out.size() < times.size(); ++i) {
    const double from = course[i].time, stop = course[i + 1].time;
    while (out.size() < times.size() && times[out.size()] <= from) out.push_back(solver.state(times[out.size()]));
    // A part shorter than the clock's resolution is a jump.
    if (stop - from <= 1e-9) continue;
    segment.from = &course[i], segment.to = &course[i + 1];
    if (!fresh && !solver.restart(from)) return fail(Kind::no_answer, "SUNDIALS could not be restarted");
    fresh = false;
    while (out.size() < times.size() && times[out.size()] < stop) {
      const double t = times[out.size()];
      if (t > from + 1e-9 && !solver.advance(t, stop))
        return fail(Kind::no_answer, fmt::format("the integration ended at {:.3f} s", t));
      out.push_back(solver.state(t));
    }
    if (!solver.advance(stop, stop))
      return fail(Kind::no_answer, fmt::format("the integration ended at {:.3f} s", stop));
  }
  while (out.size() < times.size()) out.push_back(solver.state(times[out.size()]));
  return out;
}

}  // namespace quadsonde::ingest
