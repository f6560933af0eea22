#include "cli/verb.h"
#include "export/pipeline/free_flights.h"
#include "export/pipeline/tunnel_runs.h"
#include "export/report/free_flight_answer.h"
#include "export/report/tunnel_picture.h"

namespace quadsonde::cli {
namespace {

using ingest::Kind;

class CalibrateVerb : public Verb {
 public:
  std::string name() const override { return "calibrate"; }
  std::string usage() const override { return "LOG... | --tunnel RUNS.toml -o VEHICLE.toml"; }
  std::string summary() const override { return "a vehicle's drag from free flights, or from flights in a known wind"; }
  void describe(Options& options) override {
    options("tunnel", tunnel_, "The input lists flights on the spot before a wind generator, each with its wind.");
    options("vehicle", drag_.vehicle, "FILE|class:NAME|auto",
            "A vehicle file to be updated by the flights; auto begins anew from the class prior.");
    options("mass_kg", drag_.mass_kg, 0.001, 10000.0, "Mass of the vehicle while calibrating; wins over the list's.");
    product::describe(flight_, options);
    product::describe(input_, options);
  }

  int run(const Call& call) override {
    const auto output = call.output();
    if (output && output->extension() != ".toml")
      return failed(call,
                    {Kind::usage, "this ending names no vehicle file", {output->string(), {}, {}, {}}, "use .toml"});
    return tunnel_ ? run_tunnel(call) : run_free(call);
  }

 private:
  static int failed(const Call& call, const ingest::Problem& problem) {
    call.console.error(problem);
    return exit_code(problem);
  }

  int run_tunnel(const Call& call) {
    if (call.inputs.size() > 1)
      return failed(call, {Kind::usage,
                           "--tunnel takes one list of runs",
                           {call.inputs[1].string(), {}, {}, {}},
                           "put all runs into one RUNS.toml"});
    const auto result =
        product::run_tunnel({call.inputs.front(), call.output(), drag_.mass_kg, call.common.force}, call.control);
    if (!result) return failed(call, result.error());
    call.console.warnings(result->problems);
    call.console.print(call.common.json ? product::tunnel_json(result->calibration)
                                        : product::tunnel_answer(result->calibration));
    for (const auto& file : result->files) call.console.note("written: " + file.string());
    return result->problems.empty() ? complete : with_doubts;
  }

  int run_free(const Call& call) {
    const auto result = product::run_free_flights(
        {call.inputs, call.output(), input_, flight_, drag_, call.common.force}, call.control);
    if (!result) return failed(call, result.error());
    call.console.warnings(result->problems);
    const auto& calibration = result->calibration;
    call.console.print(call.common.json ? product::free_flight_json(calibration)
                                        : product::free_flight_answer(calibration, result->updates));
    for (const auto& file : result->files) call.console.note("written: " + file.string());
    if (calibration.refused) {
      const auto& advice = calibration.identifiability.advice;
      return failed(call, {Kind::no_answer,
                           *calibration.refused,
                           {},
                           advice.empty() ? "calibrate each vehicle, and each load, from its own logs"
                                          : estimator::words(advice.front().manoeuvre)});
    }
    return result->problems.empty() ? complete : with_doubts;
  }

  bool tunnel_ = false;
  product::DragSettings drag_;
  product::FlightChoice flight_;
  product::InputSettings input_;
};

}  // namespace

std::unique_ptr<Verb> make_calibrate_verb() { return std::make_unique<CalibrateVerb>(); }

}  // namespace quadsonde::cli
