#include "cli/verb.h"
#include "export/pipeline/tunnel_runs.h"
#include "export/report/tunnel_picture.h"

namespace quadsonde::cli {
namespace {

using ingest::Kind;

class CalibrateVerb : public Verb {
 public:
  std::string name() const override { return "calibrate"; }
  std::string usage() const override { return "--tunnel RUNS.toml -o VEHICLE.toml"; }
  std::string summary() const override { return "a vehicle's drag from flights in a known wind"; }
  std::size_t most_inputs() const override { return 1; }
  void describe(Options& options) override {
    options("tunnel", tunnel_, "The input lists flights on the spot before a wind generator, each with its wind.");
    options("mass_kg", mass_kg_, 0.001, 10000.0, "Mass of the vehicle while calibrating; wins over the list's.");
  }

  int run(const Call& call) override {
    const auto fail = [&](const ingest::Problem& problem) {
      call.console.error(problem);
      return exit_code(problem);
    };
    if (!tunnel_)
      return fail({Kind::usage,
                   "calibration from free flight is not there yet",
                   {},
                   "give a list of runs in a known wind: quadsonde calibrate " + usage()});
    const auto output = call.output();
    if (output && output->extension() != ".toml")
      return fail({Kind::usage, "this ending names no vehicle file", {output->string(), {}, {}, {}}, "use .toml"});
    const auto result = product::run_tunnel({call.inputs.front(), output, mass_kg_, call.common.force}, call.control);
    if (!result) return fail(result.error());
    call.console.warnings(result->problems);
    call.console.print(call.common.json ? product::tunnel_json(result->calibration)
                                        : product::tunnel_answer(result->calibration));
    for (const auto& file : result->files) call.console.note("written: " + file.string());
    return result->problems.empty() ? complete : with_doubts;
  }

 private:
  bool tunnel_ = false;
  std::optional<double> mass_kg_;
};

}  // namespace

std::unique_ptr<Verb> make_calibrate_verb() { return std::make_unique<CalibrateVerb>(); }

}  // namespace quadsonde::cli
