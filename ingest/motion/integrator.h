#pragma once
// The equations of motion over a recorded course, integrated by SUNDIALS CVODES with analytic sensitivities.
// Source: design notes, sections 2 and 6. SUNDIALS itself stays behind this header.
#include <Eigen/Core>
#include <vector>

#include "ingest/flight/problem.h"
#include "ingest/motion/drag.h"

namespace quadsonde::ingest {

/// What drives the vehicle, at one instant; linear between instants. Two nodes at one time are a jump.
struct MotionNode {
  double time = 0;                                  ///< [s]
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< thrust slope s, N and E
  double heading = 0;                               ///< [rad], unwrapped
  double lift = standard_gravity;                   ///< g - vdot_d [m/s2]
  double v_down = 0;                                ///< [m/s]
};
using MotionCourse = std::vector<MotionNode>;

struct MotionParameters {
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();  ///< v_NA_N, N and E, constant [m/s]
  DragLaw<double> drag;
  Eigen::Vector2d trim = Eigen::Vector2d::Zero();  ///< b, heading axes [m/s2]
};

/// The columns of a sensitivity. `m_latency`: the attitude (slope, heading) read later by so much [s].
enum MotionColumn {
  m_v0_n,
  m_v0_e,
  m_wind_n,
  m_wind_e,
  m_trim_x,
  m_trim_y,
  m_linear,
  m_quadratic,
  m_latency,
  m_columns
};

struct MotionState {
  double time = 0;
  Eigen::Vector2d v = Eigen::Vector2d::Zero();  ///< v_NB_N, N and E [m/s]
  Eigen::Vector2d p = Eigen::Vector2d::Zero();  ///< p_NB_N, N and E [m]
  Eigen::Matrix<double, 4, m_columns> sensitivity =
      Eigen::Matrix<double, 4, m_columns>::Zero();  ///< d(v, p)/d(column), units of both
};

struct IntegrationSettings {
  double relative = 1e-8, absolute = 1e-10;
  bool sensitivities = true;
};

/// Integrates equation (1), vdot = s (lift - c a_d) - c a_h + R(psi) b with a = v - wind and no vertical wind, from
/// the course's first node, with the Adams methods and fixed-point iteration (the equation is not stiff). The course
/// is met node by node, since its slope jumps there, and the integrator starts afresh behind each.
/// @param times  where the state is wanted [s], ascending, within the course
/// @return one state per time. Kind::usage for a course or times out of order; Kind::no_answer if SUNDIALS gives up.
/// Accuracy: 1e-7 relative against the closed solutions in tests/ingest/motion_check.
Result<std::vector<MotionState>> integrate(const MotionCourse& course, const Eigen::Vector2d& v0,
                                           const Eigen::Vector2d& p0, const MotionParameters& parameters,
                                           const std::vector<double>& times, const IntegrationSettings& settings = {});

}  // namespace quadsonde::ingest
