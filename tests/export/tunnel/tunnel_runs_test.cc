#include "export/pipeline/tunnel_runs.h"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "export/pipeline/outputs.h"
#include "export/report/tunnel_picture.h"
#include "tests/estimator/calibration/made_runs.h"
#include "tests/support/data.h"

namespace quadsonde::product {
namespace {

using ingest::Kind;
using ::testing::HasSubstr;

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

ingest::Problem parse_failure(std::string_view toml) {
  const auto file = parse_tunnel_file(toml, "runs/RUNS.toml");
  EXPECT_FALSE(file);
  return file ? ingest::Problem{} : file.error();
}

TEST(TunnelFile, FindsLogsAndColumnMapsFromItsOwnFolder) {
  const auto file = parse_tunnel_file(R"(
mass_kg = 0.896
trim_roll_deg = 0.5
trim_pitch_deg = -0.25
[[run]]
log = "logs/a.csv"
columns = "map.toml"
wind_speed_m_s = 4
wind_from_deg = 200
wind_speed_sd_m_s = 0.1
air_density_kg_m3 = 1.19
start_s = 10
end_s = 70.5
[[run]]
log = "b.ulg"
wind_speed_m_s = 0
)",
                                      "somewhere/RUNS.toml");
  ASSERT_TRUE(file) << to_string(file.error());
  EXPECT_EQ(file->mass_kg, 0.896);
  ASSERT_EQ(file->runs.size(), 2u);
  EXPECT_EQ(file->runs[0].log, std::filesystem::path("somewhere/logs/a.csv"));
  EXPECT_EQ(file->runs[0].columns, "somewhere/map.toml");
  EXPECT_EQ(file->runs[0].title(), "a.csv, 10 to 70.5 s");
  EXPECT_EQ(file->runs[0].wind_speed_sd_m_s, 0.1);
  EXPECT_EQ(file->runs[1].columns, "auto");
  EXPECT_EQ(file->runs[1].title(), "b.ulg");
  ASSERT_TRUE(file->trim);
  EXPECT_EQ(file->trim->pitch_deg, -0.25);
}

TEST(TunnelFile, NamesTheLineOfWhatIsMissingMisspeltOrNoNumber) {
  auto said = parse_failure("mass_kg = 1\n[[run]]\nlog = \"a\"\nwind_speed_kmh = 14\n");
  EXPECT_EQ(said.kind, Kind::usage);
  EXPECT_THAT(said.where.topic, HasSubstr("wind_speed_m_s"));
  said =
      parse_failure("mass_kg = 1\n[[run]]\nlog = \"a\"\nwind_speed_m_s = 4\nwind_from_deg = 20\nwind_speed_kmh = 14\n");
  EXPECT_EQ(said.where.line, 6u);
  EXPECT_THAT(said.where.topic, HasSubstr("wind_speed_kmh"));
  said = parse_failure("mass_kg = 1\n[[run]]\nlog = \"a\"\nwind_speed_m_s = \"4\"\nwind_from_deg = 20\n");
  EXPECT_EQ(said.where.line, 4u);
  EXPECT_THAT(parse_failure("[[run]]\nlog = \"a\"\n").where.topic, HasSubstr("mass_kg"));
  EXPECT_THAT(parse_failure("mass_kg = 1\n[[run]]\nlog = \"a\"\nwind_speed_m_s = 4\n").where.topic,
              HasSubstr("wind_from_deg"));
  EXPECT_THAT(parse_failure("mass_kg = 1\ntrim_roll_deg = 1\n").where.topic, HasSubstr("trim_pitch_deg"));
  EXPECT_EQ(parse_failure("mass_kg = = 1\n").where.line, 1u);
}

/// Logs of a calibration and the list of them.
class TunnelJob : public ::testing::Test {
 protected:
  void fly(const std::vector<double>& speeds, const std::string& mass = "0.896") {
    std::string list = "mass_kg = " + mass + "\n";
    Control control;
    Outputs outputs(true, control);
    for (const double speed : speeds) {
      support::MadeRun made;
      made.stated = speed;
      made.seed = static_cast<std::uint64_t>(speed) + 5;
      const auto name = fmt_name(speed);
      ASSERT_TRUE(outputs.add_flight(folder / name, support::fly(made).flight));
      std::ostringstream run;
      run << "[[run]]\nlog = \"" << name << "\"\nwind_speed_m_s = " << speed
          << "\nwind_from_deg = 200\nair_density_kg_m3 = 1.19\n";
      list += run.str();
    }
    ASSERT_TRUE(outputs.add(folder / "RUNS.toml", list));
    ASSERT_TRUE(outputs.commit());
  }
  static std::string fmt_name(double speed) { return "run" + std::to_string(static_cast<int>(speed)) + ".mcap"; }
  TunnelRequest request() const { return {folder / "RUNS.toml", folder / "quad.toml", {}, false}; }
  support::TemporaryFolder folder;
};

TEST_F(TunnelJob, WritesTheVehicleWithItsLogsAndTheTwoPictures) {
  fly({0, 3, 6});
  const auto done = run_tunnel(request());
  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_TRUE(done->problems.empty()) << to_string(done->problems.front());
  const auto vehicle = ingest::read_vehicle(folder / "quad.toml");
  ASSERT_TRUE(vehicle) << to_string(vehicle.error());
  EXPECT_NEAR(estimator::drag_at(*vehicle, 4.5).value, 0.275, 0.01);
  ASSERT_EQ(vehicle->logs.size(), 3u);
  EXPECT_EQ(vehicle->logs[1].name, "run3.mcap");
  EXPECT_EQ(vehicle->logs[1].sha256.size(), 64u);
  EXPECT_FALSE(vehicle->version.empty());
  EXPECT_TRUE(vehicle->created);
  for (const auto* name : {"quad_tilt.svg", "quad_drag.svg"}) {
    const auto svg = text_of(folder / name);
    EXPECT_THAT(svg, HasSubstr("</svg>"));
    EXPECT_EQ(svg.find("nan"), std::string::npos) << name;
  }
  EXPECT_THAT(text_of(folder / "quad_tilt.svg"), HasSubstr("run6.mcap"));
  // The same again: refused unless told, and then the same bytes.
  const auto first = text_of(folder / "quad.toml");
  const auto again = run_tunnel(request());
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().kind, Kind::usage);
  auto forced = request();
  forced.overwrite = true;
  ASSERT_TRUE(run_tunnel(forced));
  EXPECT_EQ(text_of(folder / "quad.toml"), first);
}

TEST_F(TunnelJob, AnswersWithin80Columns) {
  fly({0, 3, 6});
  const auto done = run_tunnel({folder / "RUNS.toml", {}, {}, false});
  ASSERT_TRUE(done) << to_string(done.error());
  std::istringstream lines(tunnel_answer(done->calibration));
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) EXPECT_LE(line.size(), 80u) << line;
  EXPECT_GT(count, 20);
  EXPECT_THAT(tunnel_json(done->calibration), HasSubstr("\"schema\": \"quadsonde.calibration/1\""));
  EXPECT_FALSE(std::filesystem::exists(folder / "quad.toml"));
}

TEST_F(TunnelJob, SaysWhichFileToCorrectForAMassOfNothingAndLeavesNothingBehind) {
  fly({0, 3}, "0");
  const auto said = run_tunnel(request());
  ASSERT_FALSE(said);
  EXPECT_EQ(said.error().kind, Kind::usage);
  EXPECT_THAT(said.error().where.file, HasSubstr("RUNS.toml"));
  EXPECT_THAT(said.error().hint, HasSubstr("mass_kg"));
  EXPECT_FALSE(std::filesystem::exists(folder / "quad.toml"));
  auto with_mass = request();
  with_mass.mass_kg = 0.9;
  const auto done = run_tunnel(with_mass);
  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(done->calibration.vehicle.mass_kg, 0.9);
}

TEST_F(TunnelJob, NamesALogThatIsNotThere) {
  fly({0, 3});
  std::filesystem::remove(folder / "run3.mcap");
  const auto said = run_tunnel(request());
  ASSERT_FALSE(said);
  EXPECT_EQ(said.error().kind, Kind::unreadable);
  EXPECT_THAT(said.error().where.file, HasSubstr("run3.mcap"));
}

TEST_F(TunnelJob, UsesTheStatedPartOfALogAndNamesIt) {
  fly({0, 3, 6});
  std::ofstream(folder / "RUNS.toml", std::ios::app)
      << "[[run]]\nlog = \"run6.mcap\"\nwind_speed_m_s = 6\nwind_from_deg = 200\nair_density_kg_m3 = 1.19\nstart_s = "
         "5\nend_s = 35\n";
  const auto said = run_tunnel(request());
  ASSERT_FALSE(said);
  EXPECT_EQ(said.error().where.file, "run6.mcap, 5 to 35 s");
  EXPECT_THAT(said.error().what, HasSubstr("through only"));
}

}  // namespace
}  // namespace quadsonde::product
