#pragma once
// Topics of other programs as parts of a flight, and the flight that the parts make together.
#include <memory>
#include <string>
#include <vector>

#include "ingest/mcap/registry.h"
#include "ingest/mcap/topic_handler.h"
#include "ingest/mcap/topic_map.h"

namespace quadsonde::ingest::foreign {

/// What one channel tells of the flight; times are MCAP's.
struct Part {
  std::string topic, schema;
  bool named = false;  ///< by the user's map: its streams go before all others
  Flight flight;
};

/// The parts of all channels. Handlers write into them, so they stay where they are.
class Parts {
 public:
  /// A handler by the user's map or, for streams that it does not name, by the schema: Foxglove's LocationFix,
  /// PoseInFrame and Log; ROS 2's (and ROS 1's) NavSatFix, Imu, Odometry, PoseStamped and TwistStamped; PX4's own
  /// (px4_msgs); JSON by the names of its fields. Nothing for all else.
  std::unique_ptr<TopicHandler> handler_for(const mcap::KnownChannel& channel, const mcap::KnownSchema* schema,
                                            const TopicMap* map);
  /// The best source for every stream: the user's own word; of velocities the receiver's where it comes at 4 Hz and
  /// covers half the time, else the estimator's; of all else the one with the most samples.
  Flight join(std::vector<Problem>& problems, const std::string& file_name);

 private:
  std::vector<std::unique_ptr<Part>> parts_;
};

}  // namespace quadsonde::ingest::foreign
