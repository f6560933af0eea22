#pragma once
// The way a scenario flies, and how the nose is held on it.
#include <Eigen/Core>
#include <vector>

namespace quadsonde::ingest {

/// How the nose is held.
struct HeadingRule {
  enum class Kind { fixed, turning, along_track };
  Kind kind = Kind::fixed;
  double degrees = 0;     ///< fixed: the heading; turning: the first heading
  double rate_deg_s = 0;  ///< turning
};

struct PathLeg {
  enum class Kind { hover, climb, line, square, circle };
  Kind kind = Kind::hover;
  double duration = 0;          ///< [s]; climbs and lines may give it by their end instead
  double speed = 0;             ///< horizontal [m/s]; climb: vertical, up or down as `to_height` tells
  double to_height = 0;         ///< climb [m above take-off]
  double course_deg = 0;        ///< line: where it goes; square: of its first side
  double side_duration = 10;    ///< square [s]
  bool back_and_forth = false;  ///< line: turn back every side_duration
  double radius = 20;           ///< circle [m]
  double pause_every = 0;       ///< climb: pause each time so many metres are done; 0 = none
  double pause = 0;             ///< [s]
  HeadingRule heading;
};

/// What the pilot asks for at one instant.
struct Wish {
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero();  // NED
  double heading = 0;
};

/// The legs with 3 s on the ground and a climb at 1 m/s to start_height before them, and the way back behind.
std::vector<PathLeg> with_take_off_and_landing(std::vector<PathLeg> path, double start_height);

/// Walks path legs at a fixed step. The legs must outlive it.
class Path {
 public:
  /// @param first_height  above take-off [m]   @param step  [s]
  Path(const std::vector<PathLeg>& legs, double first_height, double step);
  bool done() const { return leg_ >= legs_.size(); }
  const Wish& next();

 private:
  Eigen::Vector3d velocity(const PathLeg& leg);
  double climb(const PathLeg& leg);
  bool finished(const PathLeg& leg) const;
  void turn(const PathLeg& leg);
  void begin_next();

  const std::vector<PathLeg>& legs_;
  double step_;
  std::size_t leg_ = 0;
  double time_in_leg_ = 0, climbed_ = 0, pause_left_ = 0;
  Wish wish_;
};

}  // namespace quadsonde::ingest
