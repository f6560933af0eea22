// Logs of other programs: the sample flight in three forms against its ULog, and ROS messages made here.
#include <fmt/format.h>

#include <cmath>

#include "ingest/flight/rotation.h"
#include "ingest/mcap/flight_from_mcap.h"
#include "ingest/mcap/message_decoder.h"
#include "ingest/mcap/ros_definition.h"
#include "ingest/mcap/writer.h"
#include "ingest/ulog/flight_from_ulog.h"
#include "tests/support/data.h"

namespace quadsonde::ingest {
namespace {

using mcap::MemorySink;
using mcap::Writer;

Flight flight_of(const std::vector<std::uint8_t>& bytes, const McapReadSettings& settings = {}) {
  const auto content = read_mcap(bytes, "test.mcap", settings);
  EXPECT_TRUE(content) << (content ? "" : to_string(content.error()));
  if (!content || content->flights.empty()) {
    ADD_FAILURE() << "no flight";
    return {};
  }
  return content->flights.front();
}

Flight sample(const std::string& name) { return flight_of(support::read_bytes(support::data_file("logs/mcap") / name)); }

Flight sample_ulog() {
  return read_ulog(support::read_bytes(support::data_file("logs/ulog/esc_status_log.ulg")), "esc.ulg")->flights.front();
}

/// UTC of the samples [s since the first UTC of the reference].
template <class S>
double utc(const Flight& flight, const S& stream, std::size_t i) {
  return static_cast<double>(flight.clock.to_utc(stream.time[i])->ns - 1'557'756'559'000'000'000) * 1e-9;
}

/// Every sample of one stream has its like in another: within dt [s] and with an error below tolerance.
template <class S, class Error>
void expect_same_samples(const Flight& a, const S& of_a, const Flight& b, const S& of_b, double tolerance, Error error) {
  ASSERT_FALSE(of_a.empty());
  constexpr double kClock = 0.03;  // two medians of one receiver's times, which spread by 23 ms
  std::size_t k = 0, matched = 0;
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    const double t = utc(a, of_a, i);
    while (k + 1 < of_b.size() && std::abs(utc(b, of_b, k + 1) - t) <= std::abs(utc(b, of_b, k) - t)) ++k;
    if (std::abs(utc(b, of_b, k) - t) > kClock) continue;
    ++matched;
    // The clocks differ by a constant: the neighbours may be the like, too.
    double smallest = 1e9;
    for (std::size_t n = k > 0 ? k - 1 : 0; n < std::min(k + 2, of_b.size()); ++n)
      smallest = std::min(smallest, error(of_a.value[i], of_b.value[n]));
    EXPECT_LE(smallest, tolerance) << "sample " << i;
  }
  EXPECT_GT(matched, of_a.size() * 9 / 10);
}

double distance(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return (a - b).norm(); }
double angle(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) { return a.angularDistance(b); }
double degrees_apart(const GeoPoint& a, const GeoPoint& b) {
  return std::max(std::abs(a.lat_deg - b.lat_deg), std::abs(a.lon_deg - b.lon_deg));
}

TEST(ForeignMcap, GivesTheFlightOfTheJsonSamplesAsTheirUlogDoes) {
  QUADSONDE_NEEDS_DATA("logs/mcap");
  const auto ulog = sample_ulog();
  for (const auto* name : {"esc_flight_json_lz4.mcap", "esc_flight_json_nochunk.mcap"}) {
    const auto json = sample(name);
    EXPECT_EQ(json.attitude.size(), 1099u);
    EXPECT_EQ(json.velocity.size(), 179u);
    EXPECT_EQ(json.velocity.origin, VelocityOrigin::receiver);
    EXPECT_EQ(json.velocity.origin, ulog.velocity.origin);
    EXPECT_EQ(json.barometer.size(), 110u);
    EXPECT_EQ(json.autopilot_wind.size(), 123u);
    // Floats printed as doubles: nothing is lost.
    expect_same_samples(json, json.attitude, ulog, ulog.attitude, 1e-6, angle);
    expect_same_samples(json, json.velocity, ulog, ulog.velocity, 1e-9, distance);
    expect_same_samples(json, json.position, ulog, ulog.position, 1e-9, degrees_apart);
    expect_same_samples(json, json.height_msl, ulog, ulog.height_msl, 1e-9,
                        [](MslHeight a, MslHeight b) { return std::abs(a - b); });
    expect_same_samples(json, json.local_position, ulog, ulog.local_position, 1e-9, distance);
  }
}

TEST(ForeignMcap, GivesTheFlightOfTheProtobufSampleAsItsUlogDoes) {
  QUADSONDE_NEEDS_DATA("logs/mcap");
  const auto ulog = sample_ulog(), pb = sample("esc_flight_protobuf_zstd.mcap");
  EXPECT_EQ(pb.velocity.size(), 179u);
  EXPECT_EQ(pb.attitude.size(), 315u);
  expect_same_samples(pb, pb.velocity, ulog, ulog.velocity, 1e-9, distance);
  expect_same_samples(pb, pb.position, ulog, ulog.position, 1e-9, degrees_apart);
  expect_same_samples(pb, pb.local_position, ulog, ulog.local_position, 1e-9, distance);
  // Its attitude stands at the times of the local position, interpolated between samples 36 ms apart; the vehicle
  // turns by up to 2 rad/s there.
  expect_same_samples(pb, pb.attitude, ulog, ulog.attitude, 0.05, angle);
}

TEST(ForeignMcap, KeepsWhatStandsBeforeTheCutOfACutSample) {
  QUADSONDE_NEEDS_DATA("logs/mcap");
  const auto bytes = support::read_bytes(support::data_file("logs/mcap/esc_flight_json_lz4_truncated.mcap"));
  const auto content = read_mcap(bytes, "cut.mcap");
  ASSERT_TRUE(content);
  ASSERT_EQ(content->flights.size(), 1u);
  EXPECT_EQ(content->messages - content->salvaged, 932u);
  EXPECT_GE(content->flights[0].attitude.size(), 578u);
  EXPECT_FALSE(content->problems.empty());
}

/// Plain little-endian CDR, written field by field.
class Cdr {
 public:
  explicit Cdr(bool little = true) : little_(little), bytes_{0, static_cast<std::uint8_t>(little), 0, 0} {}
  template <class T>
    requires std::is_arithmetic_v<T>
  Cdr& operator()(T value) {
    while ((bytes_.size() - 4) % sizeof(T) != 0) bytes_.push_back(0);
    const auto* at = reinterpret_cast<const std::uint8_t*>(&value);
    std::vector<std::uint8_t> raw(at, at + sizeof(T));
    if (!little_) std::ranges::reverse(raw);
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
    return *this;
  }
  Cdr& operator()(std::string_view text) {
    (*this)(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
    return *this;
  }
  Cdr& zeros(int count) {
    for (int i = 0; i < count; ++i) (*this)(0.0);
    return *this;
  }
  Cdr& header(std::int64_t ns, std::string_view frame) {
    return (*this)(static_cast<std::int32_t>(ns / 1'000'000'000))(static_cast<std::uint32_t>(ns % 1'000'000'000))(frame);
  }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  bool little_;
  std::vector<std::uint8_t> bytes_;
};

const std::string kLine(80, '=');
const std::string kHeader = kLine + "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + kLine +
                            "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
const std::string kVectors = kLine + "\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n" + kLine +
                             "\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n" + kLine +
                             "\nMSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n";
const std::string kNavSatFix =
    "# a fix\nstd_msgs/Header header\nNavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\n"
    "float64[9] position_covariance\nuint8 COVARIANCE_TYPE_UNKNOWN = 0\nuint8 position_covariance_type\n" +
    kHeader + kLine + "\nMSG: sensor_msgs/NavSatStatus\nint8 STATUS_NO_FIX = -1\nint8 status\nuint16 service\n";
const std::string kImu =
    "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
    "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
    "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n" + kHeader + kVectors;
const std::string kOdometry =
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
    "geometry_msgs/TwistWithCovariance twist\n" + kHeader + kVectors + kLine +
    "\nMSG: geometry_msgs/PoseWithCovariance\nPose pose\nfloat64[36] covariance\n" + kLine +
    "\nMSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n" + kLine +
    "\nMSG: geometry_msgs/TwistWithCovariance\nTwist twist\nfloat64[36] covariance\n" + kLine +
    "\nMSG: geometry_msgs/Twist\nVector3 linear\nVector3 angular\n";
const std::string kTwistStamped = "std_msgs/Header header\ngeometry_msgs/Twist twist\n" + kHeader + kVectors + kLine +
                                  "\nMSG: geometry_msgs/Twist\ngeometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n";

constexpr std::int64_t kStart = 1'700'000'000'000'000'000;

/// A log of one topic, written from samples.
template <class Fill>
std::vector<std::uint8_t> ros_log(const std::string& type, const std::string& definition, const std::string& topic,
                                  Fill fill) {
  MemorySink sink;
  mcap::WriterSettings settings;
  settings.profile = "ros2";
  Writer writer(sink, settings);
  const auto schema = *writer.add_schema(type, "ros2msg", as_bytes(definition));
  const auto channel = *writer.add_channel(schema, topic, "cdr");
  for (std::uint32_t i = 0; i < 20; ++i) {
    const std::int64_t stamp = kStart + 100'000'000LL * i;
    const auto bytes = fill(i, stamp).bytes();
    const auto arrival = static_cast<std::uint64_t>(stamp + 5'000'000);
    EXPECT_TRUE(writer.write({channel, i, arrival, arrival, bytes}));
  }
  EXPECT_TRUE(writer.close());
  return sink.bytes();
}

TEST(ForeignMcap, ReadsRosFixesInBothByteOrdersAtTheTimeTheyState) {
  for (const bool little : {true, false}) {
    const auto flight = flight_of(ros_log("sensor_msgs/msg/NavSatFix", kNavSatFix, "/fix", [&](auto i, auto stamp) {
      Cdr cdr(little);
      cdr.header(stamp, "gps")(std::int8_t(i == 3 ? -1 : 0))(std::uint16_t{1});
      return cdr(47.0 + i)(8.5)(500.0 + i).zeros(9)(std::uint8_t{0});
    }));
    ASSERT_EQ(flight.position.size(), 19u) << "one has no fix";
    EXPECT_EQ(flight.position.value[1].lat_deg, 48.0);
    EXPECT_EQ(flight.position.time[1].ns, kStart + 100'000'000);
    EXPECT_EQ(flight.height_ellipsoid.value[1].m, 501.0);
    EXPECT_TRUE(flight.height_msl.empty());
  }
}

TEST(ForeignMcap, TurnsRosAxesIntoOurs) {
  // Heading north-east, that is 45 degrees from east anticlockwise in ENU, nose 10 degrees up.
  const auto q_enu_flu = Eigen::AngleAxisd(M_PI / 4, Eigen::Vector3d::UnitZ()) *
                         Eigen::AngleAxisd(-10 * M_PI / 180, Eigen::Vector3d::UnitY());
  const Eigen::Quaterniond q(q_enu_flu);
  const auto flight = flight_of(ros_log("nav_msgs/msg/Odometry", kOdometry, "/odom", [&](auto i, auto stamp) {
    Cdr cdr;
    cdr.header(stamp, "odom")("base_link")(1.0 + i)(2.0)(3.0)(q.x())(q.y())(q.z())(q.w()).zeros(36);
    return cdr(5.0)(0.0)(0.0).zeros(3).zeros(36);
  }));
  ASSERT_EQ(flight.attitude.size(), 20u);
  const auto angles = euler_from_q_NB(flight.attitude.value[0]);
  EXPECT_NEAR(angles.yaw, M_PI / 4, 1e-12);
  EXPECT_NEAR(angles.pitch, 10 * M_PI / 180, 1e-12);
  EXPECT_NEAR(angles.roll, 0, 1e-12);
  // Five metres per second along the nose: north and east alike, and up.
  const double level = 5 * std::cos(10 * M_PI / 180) * std::sqrt(0.5), up = 5 * std::sin(10 * M_PI / 180);
  EXPECT_NEAR((flight.velocity.value[0] - Eigen::Vector3d(level, level, -up)).norm(), 0, 1e-12);
  EXPECT_EQ(flight.velocity.origin, VelocityOrigin::fused);
  EXPECT_EQ(flight.local_position.value[4], Eigen::Vector3d(2, 5, -3));
}

TEST(ForeignMcap, TakesSpecificForceAndAttitudeFromRosImus) {
  const auto flight = flight_of(ros_log("sensor_msgs/msg/Imu", kImu, "/imu", [&](auto, auto stamp) {
    Cdr cdr;
    cdr.header(stamp, "base_link")(0.0)(0.0)(0.0)(1.0).zeros(9).zeros(3).zeros(9);
    return cdr(0.1)(0.2)(9.8).zeros(9);
  }));
  // Level, and by REP 103 the unit attitude faces east.
  ASSERT_EQ(flight.attitude.size(), 20u);
  EXPECT_NEAR(heading(flight.attitude.value[0]), M_PI / 2, 1e-12);
  EXPECT_EQ(flight.accelerometer.value[0], Eigen::Vector3d(0.1, -0.2, -9.8));
}

TEST(ForeignMcap, TakesVelocityInEarthAxesFromRosTwists) {
  const auto twist = [&](const char* frame) {
    return ros_log("geometry_msgs/msg/TwistStamped", kTwistStamped, "/vel", [&](auto, auto stamp) {
      return Cdr().header(stamp, frame)(1.0)(2.0)(0.5).zeros(3);
    });
  };
  EXPECT_EQ(flight_of(twist("map")).velocity.value[0], Eigen::Vector3d(2, 1, -0.5));
  EXPECT_TRUE(read_mcap(twist("base_link"), "t.mcap")->flights.empty()) << "body axes without an attitude say nothing";
}

TEST(ForeignMcap, TakesAttitudeAndPlaceFromRosPoses) {
  const std::string definition = "std_msgs/Header header\ngeometry_msgs/Pose pose\n" + kHeader + kVectors + kLine +
                                 "\nMSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n";
  const auto pose = [&](const char* frame) {
    return flight_of(ros_log("geometry_msgs/msg/PoseStamped", definition, "/pose", [&](auto, auto stamp) {
      return Cdr().header(stamp, frame)(1.0)(2.0)(3.0)(0.0)(0.0)(0.0)(1.0);
    }));
  };
  // REP 103: the unit attitude faces east; in a frame that says NED, north.
  EXPECT_NEAR(heading(pose("map").attitude.value[0]), M_PI / 2, 1e-12);
  EXPECT_EQ(pose("map").local_position.value[0], Eigen::Vector3d(2, 1, -3));
  EXPECT_NEAR(heading(pose("local_ned").attitude.value[0]), 0, 1e-12);
  EXPECT_EQ(pose("local_ned").local_position.value[0], Eigen::Vector3d(1, 2, 3));
}

TEST(ForeignMcap, TakesPx4sOwnMessagesInTheirOwnAxesAtTheirOwnTimes) {
  const auto attitude = flight_of(
      ros_log("px4_msgs/msg/VehicleAttitude", "uint64 timestamp\nuint64 timestamp_sample\nfloat32[4] q\n",
              "/fmu/out/vehicle_attitude", [&](auto, auto stamp) {
                return Cdr()(static_cast<std::uint64_t>(stamp / 1000))(std::uint64_t{0})(0.8f)(0.0f)(0.0f)(0.6f);
              }));
  ASSERT_EQ(attitude.attitude.size(), 20u);
  EXPECT_EQ(attitude.attitude.time[1].ns, kStart + 100'000'000) << "not the arrival, 5 ms later";
  EXPECT_NEAR(heading(attitude.attitude.value[0]), 2 * std::atan2(0.6, 0.8), 1e-6);
  const auto local = flight_of(
      ros_log("px4_msgs/msg/VehicleLocalPosition",
              "uint64 timestamp\nbool v_xy_valid\nbool v_z_valid\nfloat32 x\nfloat32 y\nfloat32 z\nfloat32 vx\n"
              "float32 vy\nfloat32 vz\nfloat32 evh\n",
              "/fmu/out/vehicle_local_position", [&](auto i, auto) {
                return Cdr()(std::uint64_t{5'000'000})(std::uint8_t(i != 3))(std::uint8_t{1})(1.f)(2.f)(-3.f)(4.f)(5.f)(
                    -6.f)(0.25f);
              }));
  ASSERT_EQ(local.velocity.size(), 19u) << "one is not valid";
  EXPECT_EQ(local.velocity.value[0], Eigen::Vector3d(4, 5, -6));
  EXPECT_EQ(local.velocity.origin, VelocityOrigin::fused);
  EXPECT_EQ(local.velocity.sd, std::vector<double>(19, 0.25));
  EXPECT_EQ(local.local_position.value[0], Eigen::Vector3d(1, 2, -3));
  EXPECT_EQ(local.velocity.time[0].ns, kStart + 5'000'000) << "a boot clock is not UTC: the arrival";
}

TEST(ForeignMcap, ReadsPx4FixesInOldAndNewUnits) {
  const std::string common = "uint8 fix_type\nfloat32 s_variance_m_s\nfloat32 vel_n_m_s\nfloat32 vel_e_m_s\n"
                             "float32 vel_d_m_s\nbool vel_ned_valid\n";
  const auto speeds = [](Cdr cdr, auto i) {
    return cdr(std::uint8_t(i == 0 ? 2 : 3))(0.5f)(1.f)(2.f)(3.f)(std::uint8_t{1});
  };
  const auto old_units = flight_of(
      ros_log("px4_msgs/msg/SensorGps", "int32 lat\nint32 lon\nint32 alt\nint32 alt_ellipsoid\n" + common, "/gps",
              [&](auto i, auto) { return speeds(Cdr()(473'000'000)(85'000'000)(430'000)(478'000), i); }));
  const auto new_units = flight_of(ros_log(
      "px4_msgs/msg/SensorGps",
      "float64 latitude_deg\nfloat64 longitude_deg\nfloat64 altitude_msl_m\nfloat64 altitude_ellipsoid_m\n" + common,
      "/gps", [&](auto i, auto) { return speeds(Cdr()(47.3)(8.5)(430.0)(478.0), i); }));
  for (const auto* flight : {&old_units, &new_units}) {
    ASSERT_EQ(flight->position.size(), 19u) << "one has no fix in three dimensions";
    EXPECT_NEAR(flight->position.value[0].lat_deg, 47.3, 1e-9);
    EXPECT_NEAR(flight->position.value[0].lon_deg, 8.5, 1e-9);
    EXPECT_NEAR(flight->height_msl.value[0].m, 430, 1e-9);
    EXPECT_NEAR(flight->height_ellipsoid.value[0].m, 478, 1e-9);
    EXPECT_EQ(flight->velocity.value[0], Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(flight->velocity.origin, VelocityOrigin::receiver);
    EXPECT_EQ(flight->velocity.sd[0], 0.5);
  }
}

std::vector<std::uint8_t> json_log(const std::string& topic, const std::vector<std::string>& messages) {
  MemorySink sink;
  Writer writer(sink, {});
  const auto channel = *writer.add_channel(0, topic, "json");
  for (std::uint32_t i = 0; i < messages.size(); ++i) {
    const std::uint64_t time = 1'000'000'000ull * (i + 1);
    EXPECT_TRUE(writer.write({channel, i, time, time, as_bytes(messages[i])}));
  }
  EXPECT_TRUE(writer.close());
  return sink.bytes();
}

TEST(ForeignMcap, FollowsTheUsersMap) {
  const auto log = json_log("/state", {R"({"t":5.5,"att":{"w":0.1,"v":[0.2,0.3]},"vel":[1,2,3]})",
                                       R"({"t":6.5,"att":{"w":0.1,"v":[0.2,0.3]},"vel":[4,5,6]})"});
  const auto map = parse_topic_map(R"(
[attitude]
topic = "/state"
fields = ["att.w", "att.v[0]", "att.v[1]"]
axes = "ned_frd"
time = "t"
[velocity]
topic = "/state"
fields = ["vel[0]", "vel[1]", "vel[2]"]
axes = "enu"
scale = 10
time = "t"
)", "map.toml");
  ASSERT_TRUE(map) << to_string(map.error());
  const auto flight = flight_of(log, {Reading::tolerant, true, *map});
  ASSERT_EQ(flight.velocity.size(), 2u);
  EXPECT_EQ(flight.velocity.value[1], Eigen::Vector3d(50, 40, -60));
  EXPECT_EQ(flight.velocity.time[1].ns, 6'500'000'000);
  EXPECT_NEAR(euler_from_q_NB(flight.attitude.value[0]).pitch, 0.2, 1e-12);
}

TEST(TopicMap, NamesTheLineOfWhatItDoesNotKnow) {
  const std::pair<const char*, int> wrong[] = {{"[velocity]\ntopic = \"/a\"\nfields = [\"x\"]\naxes = \"ned\"\n", 1},
                                               {"\n[speed]\ntopic = \"/a\"\n", 2},
                                               {"[velocity]\ntopic = \"/a\"\nfields = [\"x\",\"y\",\"z\"]\n", 1},
                                               {"[velocity]\ntopic = 3\n", 2},
                                               {"[velocity\n", 1},
                                               {"[position]\ntopic=\"/a\"\nfields=[\"x\",\"y\"]\nunit=\"deg\"\n", 4}};
  for (const auto& [text, line] : wrong) {
    const auto map = parse_topic_map(text, "map.toml");
    ASSERT_FALSE(map) << text;
    EXPECT_EQ(map.error().kind, Kind::usage);
    EXPECT_EQ(map.error().where.line, line) << text;
  }
}

TEST(ForeignMcap, DropsAnAttitudeThatLiesOnItsSideAndSaysWhatToDo) {
  const std::vector<std::string> messages(10, R"({"q":[0.6,0.02,0.01,0.8],"vn":1,"ve":2,"vd":3})");
  const std::vector<std::string> swapped(10, R"({"q":[0.02,0.01,0.8,0.6],"vn":1,"ve":2,"vd":3})");  // w last
  const auto doubtful = read_mcap(json_log("/a", swapped), "t.mcap");
  ASSERT_TRUE(doubtful);
  EXPECT_TRUE(doubtful->flights[0].attitude.empty());
  ASSERT_EQ(doubtful->problems.size(), 1u);
  EXPECT_NE(doubtful->problems[0].hint.find("--topics"), std::string::npos);
  EXPECT_EQ(flight_of(json_log("/a", messages)).attitude.size(), 10u);
}

TEST(ForeignMcap, CountsMessagesThatAreNotWhatTheirEncodingSays) {
  const auto content = read_mcap(json_log("/a", {"{\"vn\":1,\"ve\":2,\"vd\":3}", "{\"vn\":", "[1,2]", ""}), "t.mcap");
  ASSERT_TRUE(content);
  EXPECT_EQ(content->flights[0].velocity.size(), 1u);
  ASSERT_EQ(content->problems.size(), 1u);
  EXPECT_EQ(content->problems[0].where.topic, "/a");
  EXPECT_NE(content->problems[0].what.find("3 of 4"), std::string::npos);
}

TEST(ForeignMcap, KnowsUtcOnlyWhereLogTimesLookLikeIt) {
  EXPECT_FALSE(flight_of(json_log("/a", {"{\"vn\":1,\"ve\":2,\"vd\":3}"})).clock.utc_minus_log);
}

TEST(RosDefinition, PassesOverConstantsDefaultsAndComments) {
  const auto definition = parse_ros_definition(
      "a/msg/B", "# c\nint32 X=5\nfloat64 y 1.5 # d\nstring<=10 s \"a b\"\nint16[<=3] many\nuint8[4] four\nC[] list\n" +
                     kLine + "\nMSG: a/C\nbool flag\n");
  ASSERT_TRUE(definition);
  ASSERT_EQ(definition->structures[0].fields.size(), 5u);
  EXPECT_EQ(definition->structures[0].fields[1].type, RosType::text);
  EXPECT_EQ(definition->structures[0].fields[3].length, 4u);
  EXPECT_EQ(definition->structures[0].fields[4].structure, 1u);
}

TEST(RosDefinition, RefusesTypesThatAreMissingOrContainThemselves) {
  EXPECT_FALSE(parse_ros_definition("a/B", "Missing x\n"));
  EXPECT_FALSE(parse_ros_definition("a/B", "C c\n" + kLine + "\nMSG: a/C\nB b\n"));
  EXPECT_FALSE(parse_ros_definition("a/B", "int32\n"));
  EXPECT_FALSE(parse_ros_definition("a/B", "int32[x] y\n"));
}

TEST(RosDecoder, RefusesLengthsThatTheMessageCannotHold) {
  const mcap::KnownSchema schema{"a/B", "ros2msg", [] { const std::string t = "float64[] x\nstring s\n"; return std::vector<std::uint8_t>(t.begin(), t.end()); }(), true};
  auto decoder = ros_decoder(schema, true);
  ASSERT_TRUE(decoder);
  Json out;
  EXPECT_FALSE(decoder->decode(Cdr()(std::uint32_t{0xFFFFFFFF}).bytes(), out));
  EXPECT_FALSE(decoder->decode(Cdr()(std::uint32_t{0})(std::uint32_t{1000}).bytes(), out));
  EXPECT_FALSE(decoder->decode({}, out));
  EXPECT_TRUE(decoder->decode(Cdr()(std::uint32_t{1})(2.5)("hi").bytes(), out));
  EXPECT_EQ(out["x"][0], 2.5);
  EXPECT_EQ(out["s"], "hi");
}

}  // namespace
}  // namespace quadsonde::ingest
