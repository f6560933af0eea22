#include <fmt/format.h>

#include "cli/verb.h"
#include "export/csv/flight_csv.h"
#include "export/csv/json.h"
#include "export/csv/numbers.h"
#include "export/csv/truth_csv.h"
#include "export/pipeline/outputs.h"
#include "export/report/text_answer.h"
#include "ingest/motion/scenario.h"

namespace quadsonde::cli {
namespace {

using ingest::Kind;

class SimulateVerb : public Verb {
 public:
  std::string name() const override { return "simulate"; }
  std::string usage() const override { return "SCENARIO.toml -o X.mcap|.csv --truth T.csv"; }
  std::string summary() const override { return "a flight in a known wind, for tests, teaching and planning"; }
  std::size_t most_inputs() const override { return 1; }
  void describe(Options& options) override {
    options("truth", truth_, "T.csv", "Where the wind that was really there is written.");
    options("flown-vehicle", flown_vehicle_, "VEHICLE.toml",
            "Where the vehicle as flown is written, with the drag law that an ideal wind tunnel would find.");
  }

  int run(const Call& call) override {
    const auto fail = [&](const ingest::Problem& problem) {
      call.console.error(problem);
      return exit_code(problem);
    };
    const auto output = call.output();
    if (output && output->extension() != ".mcap" && output->extension() != ".csv")
      return fail(
          {Kind::usage, "this ending names no format of a log", {output->string(), {}, {}, {}}, "use .mcap or .csv"});
    const auto scenario = ingest::read_scenario(call.inputs.front());
    if (!scenario) return fail(scenario.error());
    call.control.report("flying", 0.1);
    const auto simulation = ingest::simulate(*scenario);
    if (!simulation) return fail(simulation.error());
    call.control.report("writing", 0.8);
    if (auto done = write(call, *simulation); !done) return fail(done.error());
    if (!output || call.common.json)
      call.console.print(call.common.json ? facts_json(*scenario, *simulation) : facts_text(*scenario, *simulation));
    return complete;
  }

 private:
  ingest::Result<void> write(const Call& call, const ingest::Simulation& simulation) {
    product::Outputs outputs(call.common.force, call.control);
    const auto output = call.output();
    if (output) {
      auto done = output->extension() == ".csv" ? outputs.add(*output, product::flight_csv(simulation.flight))
                                                : outputs.add_flight(*output, simulation.flight, simulation.truth);
      if (!done) return done;
    }
    if (!truth_.empty())
      if (auto done = outputs.add(truth_, product::truth_csv(simulation.truth)); !done) return done;
    if (!flown_vehicle_.empty())
      if (auto done = outputs.add(flown_vehicle_, ingest::to_toml(simulation.vehicle)); !done) return done;
    return outputs.commit();
  }

  /// Duration, heights and mean wind of what was flown.
  struct Facts {
    double duration = 0, low = 1e9, high = -1e9, slowest = 1e9, fastest = 0;
  };
  static Facts facts_of(const ingest::Simulation& simulation) {
    Facts f;
    for (const auto& t : simulation.truth) {
      const double speed = t.v_NA_N.head<2>().norm();
      f.low = std::min(f.low, t.height.m), f.high = std::max(f.high, t.height.m);
      f.slowest = std::min(f.slowest, speed), f.fastest = std::max(f.fastest, speed);
    }
    if (!simulation.truth.empty())
      f.duration = ingest::to_seconds(simulation.truth.back().time - simulation.truth.front().time);
    return f;
  }
  static std::string facts_text(const ingest::Scenario& scenario, const ingest::Simulation& simulation) {
    const auto f = facts_of(simulation);
    return fmt::format("{}: {}, {:.0f} to {:.0f} m above take-off, wind of {:.1f} to {:.1f} m/s\n", scenario.name,
                       product::duration_text(f.duration), f.low, f.high, f.slowest, f.fastest);
  }
  static std::string facts_json(const ingest::Scenario& scenario, const ingest::Simulation& simulation) {
    const auto f = facts_of(simulation);
    return product::json_text({{"schema", "quadsonde.simulation/1"},
                               {"scenario", scenario.name},
                               {"duration_s", product::json_number(f.duration, 3)},
                               {"lowest_m", product::json_number(f.low, 2)},
                               {"highest_m", product::json_number(f.high, 2)},
                               {"slowest_wind_m_s", product::json_number(f.slowest, 4)},
                               {"fastest_wind_m_s", product::json_number(f.fastest, 4)}});
  }

  std::string truth_, flown_vehicle_;
};

}  // namespace

std::unique_ptr<Verb> make_simulate_verb() { return std::make_unique<SimulateVerb>(); }

}  // namespace quadsonde::cli
