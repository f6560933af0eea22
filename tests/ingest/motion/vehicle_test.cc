#include "ingest/motion/vehicle.h"

#include <cmath>
#include <fstream>

#include "tests/support/data.h"

namespace quadsonde::ingest {
namespace {

/// Every field set, with numbers that have no short decimal form.
Vehicle unusual_vehicle() {
  Vehicle v;
  v.id = "quad-07";
  v.name = "five-inch \"test\" quad\\\nsecond line, h\xC3\xA9lice\x7f";
  v.mass_kg = 0.1 + 0.2;
  v.rotor_diameter_m = 1.0 / 3;
  v.rotors = 6;
  v.drag = {0.257 / 3, 0.004 / 7, -0.03 / 11, 1e-17};
  v.latency_s = 0.15 / 7;
  v.trim_roll_deg = -0.8 / 3;
  v.trim_pitch_deg = 2;
  Eigen::Matrix<double, 7, 7> root;
  for (int i = 0; i < 7; ++i)
    for (int j = 0; j < 7; ++j) root(i, j) = std::sin(1.0 + i * 7 + j) * 1e-3;
  v.covariance = root * root.transpose();
  v.covariance = (0.5 * (v.covariance + v.covariance.transpose())).eval();
  v.between_flights_rel_sd = 0.06 / 0.7;
  v.air_density_kg_m3 = 1.19 / 1.1;
  v.density_exponent = 0.5;
  v.airspeed_range_m_s = {0.1 / 3, 8.2};
  v.tilt_sd_deg = 0.7 / 3;
  v.tilt_correlation_s = 1.0;
  v.method = "free-flight";
  v.excitation_m_s = 3.1 / 9;
  v.residual_rms_m_s2 = 0.07 / 3;
  v.leave_one_out_m_s = 0.21;
  v.logs = {{"run 1.ulg", "00ff"}, {"run2.bin", ""}};
  v.created = UtcTime{1'795'435'200'000'000'000};
  v.version = "0.1.0";
  return v;
}

TEST(VehicleFile, IsReadBackBitForBit) {
  const Vehicle v = unusual_vehicle();
  const auto back = parse_vehicle(to_toml(v), "v.toml");
  ASSERT_TRUE(back) << to_string(back.error());
  EXPECT_EQ(back->id, v.id);
  EXPECT_EQ(back->name, v.name);
  EXPECT_EQ(back->mass_kg, v.mass_kg);
  EXPECT_EQ(back->rotor_diameter_m, v.rotor_diameter_m);
  EXPECT_EQ(back->rotors, v.rotors);
  EXPECT_EQ(back->drag.linear, v.drag.linear);
  EXPECT_EQ(back->drag.quadratic, v.drag.quadratic);
  EXPECT_EQ(back->drag.climb_linear, v.drag.climb_linear);
  EXPECT_EQ(back->drag.climb_quadratic, v.drag.climb_quadratic);
  EXPECT_EQ(back->latency_s, v.latency_s);
  EXPECT_EQ(back->trim_roll_deg, v.trim_roll_deg);
  EXPECT_EQ(back->trim_pitch_deg, v.trim_pitch_deg);
  EXPECT_EQ(back->covariance, v.covariance);
  EXPECT_EQ(back->between_flights_rel_sd, v.between_flights_rel_sd);
  EXPECT_EQ(back->air_density_kg_m3, v.air_density_kg_m3);
  EXPECT_EQ(back->density_exponent, v.density_exponent);
  EXPECT_EQ(back->airspeed_range_m_s, v.airspeed_range_m_s);
  EXPECT_EQ(back->tilt_sd_deg, v.tilt_sd_deg);
  EXPECT_EQ(back->tilt_correlation_s, v.tilt_correlation_s);
  EXPECT_EQ(back->method, v.method);
  EXPECT_EQ(back->excitation_m_s, v.excitation_m_s);
  EXPECT_EQ(back->residual_rms_m_s2, v.residual_rms_m_s2);
  EXPECT_EQ(back->leave_one_out_m_s, v.leave_one_out_m_s);
  ASSERT_EQ(back->logs.size(), 2u);
  EXPECT_EQ(back->logs[0].name, "run 1.ulg");
  EXPECT_EQ(back->logs[0].sha256, "00ff");
  EXPECT_EQ(back->created, v.created);
  EXPECT_EQ(back->version, v.version);
  EXPECT_EQ(to_toml(*back), to_toml(v));
}

TEST(VehicleFile, OfTheClassPriorIsReadBackBitForBit) {
  const auto text = to_toml(class_prior());
  const auto back = parse_vehicle(text, "prior.toml");
  ASSERT_TRUE(back) << to_string(back.error());
  EXPECT_EQ(to_toml(*back), text);
  EXPECT_TRUE(back->is_prior());
}

TEST(VehicleFile, WrittenByHandTakesThePriorForWhatItDoesNotTell) {
  const auto v = parse_vehicle("[drag]\nlinear_per_s = 0.3\n", "hand.toml");
  ASSERT_TRUE(v) << to_string(v.error());
  EXPECT_EQ(v->drag.linear, 0.3);
  EXPECT_EQ(v->drag.climb_linear, class_prior().drag.climb_linear);
  EXPECT_EQ(v->covariance, class_prior().covariance) << "never a certainty that nobody measured";
  EXPECT_FALSE(v->mass_kg);
  EXPECT_FALSE(v->is_prior());
}

struct BadFile {
  const char* why;
  const char* text;
  std::uint64_t line;  ///< 0: a missing key has none
  const char* topic;
  const char* words;
};

TEST(VehicleFile, EachFaultIsOneProblemWithItsLine) {
  const BadFile bad[] = {
      {"no TOML", "[drag\nlinear_per_s = 1\n", 1, "", ""},
      {"a key twice", "[drag]\nlinear_per_s = 1\nlinear_per_s = 2\n", 3, "", ""},
      {"no drag", "[vehicle]\nid = \"x\"\n", 0, "drag.linear_per_s", "is missing"},
      {"misspelt key", "[drag]\nlinear_per_s = 0.2\nlinaer = 3\n", 3, "drag.linaer", "not a key"},
      {"misspelt table", "[drag]\nlinear_per_s = 0.2\n[nosie]\n", 3, "nosie", "not a key"},
      {"text for a number", "[drag]\nlinear_per_s = \"0.2\"\n", 2, "drag.linear_per_s", "expected a number"},
      {"drag without end", "[drag]\nlinear_per_s = inf\n", 2, "drag.linear_per_s", "expected a number"},
      {"drag that is none", "[drag]\nlinear_per_s = nan\n", 2, "drag.linear_per_s", "expected a number"},
      {"negative drag", "[drag]\nlinear_per_s = -0.2\n", 2, "drag.linear_per_s", "expected a number"},
      {"number for a text", "[vehicle]\nid = 7\n[drag]\nlinear_per_s = 0.2\n", 2, "vehicle.id", "text in quotes"},
      {"no mass", "[vehicle]\nmass_kg = 0\n[drag]\nlinear_per_s = 0.2\n", 2, "vehicle.mass_kg", "expected a number"},
      {"value for a table", "drag = 3\n", 1, "drag", "expected a table"},
      {"short range", "[drag]\nlinear_per_s = 0.2\nairspeed_range_m_s = [1.0]\n", 3, "drag.airspeed_range_m_s",
       "expected 2 numbers"},
      {"covariance of six", "[drag]\nlinear_per_s = 0.2\ncovariance = [[1,0,0,0,0,0]]\n", 3, "drag.covariance",
       "7 by 7"},
      {"covariance of text", "[drag]\nlinear_per_s = 0.2\ncovariance = \"no\"\n", 3, "drag.covariance", "7 by 7"},
      {"logs that are none", "[drag]\nlinear_per_s = 0.2\n[provenance]\nlogs = [\"a.ulg\"]\n", 4, "provenance.logs",
       "expected a table"},
      {"a date that is none", "[drag]\nlinear_per_s = 0.2\n[provenance]\ncreated_utc = \"yesterday\"\n", 0,
       "provenance.created_utc", "expected a time"},
  };
  for (const auto& file : bad) {
    const auto v = parse_vehicle(file.text, "bad.toml");
    ASSERT_FALSE(v) << file.why;
    const Problem& p = v.error();
    EXPECT_EQ(p.kind, Kind::usage) << file.why;
    EXPECT_EQ(p.where.file, "bad.toml") << file.why;
    EXPECT_EQ(p.where.topic, file.topic) << file.why;
    EXPECT_NE(p.what.find(file.words), std::string::npos) << file.why << ": " << p.what;
    EXPECT_FALSE(p.hint.empty()) << file.why;
    if (file.line > 0) {
      ASSERT_TRUE(p.where.line) << file.why;
      EXPECT_EQ(*p.where.line, file.line) << file.why;
    }
  }
}

TEST(VehicleFile, RefusesACovarianceThatNoErrorsCanHave) {
  Vehicle v = class_prior();
  v.covariance(p_linear, p_trim_roll) = 1;
  auto read = parse_vehicle(to_toml(v), "v.toml");
  ASSERT_FALSE(read) << "not symmetric";
  EXPECT_NE(read.error().what.find("symmetric"), std::string::npos);
  v.covariance(p_trim_roll, p_linear) = 1;  // symmetric, but the correlation is 4.8
  EXPECT_FALSE(parse_vehicle(to_toml(v), "v.toml"));
  v = class_prior();
  v.covariance(p_latency, p_latency) = -1;
  EXPECT_FALSE(parse_vehicle(to_toml(v), "v.toml"));
}

TEST(VehicleFile, ThatIsNotThereSaysWhatToDo) {
  const auto v = read_vehicle("/nowhere/v.toml");
  ASSERT_FALSE(v);
  EXPECT_EQ(v.error().kind, Kind::unreadable);
  EXPECT_FALSE(v.error().hint.empty());
}

TEST(VehicleFile, IsReadFromDisk) {
  const support::TemporaryFolder folder;
  std::ofstream(folder / "v.toml") << to_toml(unusual_vehicle());
  const auto v = read_vehicle(folder / "v.toml");
  ASSERT_TRUE(v);
  EXPECT_EQ(v->id, "quad-07");
}

TEST(ClassPrior, IsAsWideAsTheVehiclesThatWereSeen) {
  const Vehicle v = class_prior();
  EXPECT_DOUBLE_EQ(v.drag.linear, 0.20);
  EXPECT_NEAR(v.parameter_sd(p_linear), 0.35 * 0.20, 1e-15);
  EXPECT_NEAR(v.parameter_sd(p_trim_roll), 3, 1e-15);
  EXPECT_NEAR(v.parameter_sd(p_climb_linear), 0.05, 1e-15);
  EXPECT_NEAR(v.parameter_sd(p_climb_quadratic), 0.03, 1e-15);
  EXPECT_TRUE(v.is_prior());
  EXPECT_TRUE(class_prior("generic"));
  const auto none = class_prior("submarine");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, Kind::usage);
  EXPECT_NE(none.error().hint.find("generic"), std::string::npos);
}

TEST(FlownAt, ScalesTheDragAndItsCovarianceAlike) {
  Vehicle v = unusual_vehicle();
  v.mass_kg = 1.0;
  v.air_density_kg_m3 = 1.2;
  const auto flown = flown_at(v, 1.44, 1.2 * 0.81);
  ASSERT_TRUE(flown);
  const double linear = 0.9 / 1.2, quadratic = 0.81 / 1.44;
  EXPECT_NEAR(flown->drag.linear, v.drag.linear * linear, 1e-15);
  EXPECT_NEAR(flown->drag.quadratic, v.drag.quadratic * quadratic, 1e-15);
  EXPECT_NEAR(flown->covariance(p_linear, p_linear), v.covariance(p_linear, p_linear) * linear * linear, 1e-18);
  EXPECT_NEAR(flown->covariance(p_linear, p_quadratic), v.covariance(p_linear, p_quadratic) * linear * quadratic,
              1e-18);
  EXPECT_NEAR(flown->covariance(p_quadratic, p_latency), v.covariance(p_quadratic, p_latency) * quadratic, 1e-18);
  EXPECT_EQ(flown->covariance(p_latency, p_trim_roll), v.covariance(p_latency, p_trim_roll));
  EXPECT_EQ(flown->mass_kg, 1.44);
  EXPECT_NEAR(flown->air_density_kg_m3, 0.972, 1e-15);
}

TEST(FlownAt, RefusesAMassWhereTheFileHasNone) {
  Vehicle v = unusual_vehicle();
  v.mass_kg.reset();
  const auto flown = flown_at(v, 1.5, 1.2);
  ASSERT_FALSE(flown);
  EXPECT_EQ(flown.error().kind, Kind::usage);
  EXPECT_TRUE(flown_at(v, std::nullopt, 1.2)) << "without a mass there is nothing to refuse";
}

TEST(AirDensity, IsThatOfTheStandards) {
  EXPECT_DOUBLE_EQ(standard_air_density(0), 1.225);
  EXPECT_NEAR(standard_air_density(1000), 1.1116, 1e-4) << "ISO 2533, by geopotential altitude";
  EXPECT_NEAR(standard_air_density(5000), 0.7361, 1e-4);
  EXPECT_NEAR(air_density(101325, 288.15, 0), 1.2250, 1e-4) << "dry air";
  // 30 C, saturated: vapour 42.4 hPa, 0.622 of dry air's mass: 1.6 % lighter.
  EXPECT_NEAR(air_density(101325, 303.15, 100) / air_density(101325, 303.15, 0), 0.9841, 2e-4);
}

}  // namespace
}  // namespace quadsonde::ingest
