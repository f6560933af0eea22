#include <fmt/format.h>

#include <algorithm>

#include "cli/verb.h"
#include "export/csv/flight_csv.h"
#include "export/pipeline/load.h"
#include "export/pipeline/outputs.h"

namespace quadsonde::cli {
namespace {

using ingest::Kind;

class ConvertVerb : public Verb {
 public:
  std::string name() const override { return "convert"; }
  std::string usage() const override { return "LOG -o X.mcap|.csv"; }
  std::string summary() const override { return "any supported log to MCAP or CSV"; }
  std::size_t most_inputs() const override { return 1; }
  void describe(Options& options) override {
    product::describe(input_, options);
    product::describe(flight_, options);
  }

  int run(const Call& call) override {
    const auto output = call.output();
    const auto fail = [&](const ingest::Problem& problem) {
      call.console.error(problem);
      return exit_code(problem);
    };
    if (!output) return fail({Kind::usage, "convert needs an output", {}, "give -o X.mcap or -o X.csv"});
    const auto ending = output->extension();
    if (ending != ".mcap" && ending != ".csv")
      return fail(
          {Kind::usage, "this ending names no format of a log", {output->string(), {}, {}, {}}, "use .mcap or .csv"});
    std::error_code error;
    if (!call.common.force && std::filesystem::exists(*output, error))
      return fail({Kind::usage,
                   "this file is already there",
                   {output->string(), {}, {}, {}},
                   "name another output or allow overwriting with --force"});
    const auto log = product::load_log(call.inputs.front(), input_, call.control);
    if (!log) return fail(log.error());
    std::vector<ingest::Problem> notes = log->content.problems;
    const auto boot = choose(*log, notes);
    if (!boot) return fail(boot.error());
    notes.insert(notes.end(), (*boot)->problems.begin(), (*boot)->problems.end());
    call.console.warnings(notes);
    product::Outputs outputs(call.common.force, call.control);
    auto done =
        ending == ".csv" ? outputs.add(*output, product::flight_csv(**boot)) : outputs.add_flight(*output, **boot);
    if (done) done = outputs.commit();
    if (!done) return fail(done.error());
    return notes.empty() ? complete : with_doubts;
  }

 private:
  /// One boot of the autopilot, whole: the one of the flight asked for, else of the longest, else the only one.
  ingest::Result<std::shared_ptr<const ingest::Flight>> choose(const product::LoadedLog& log,
                                                               std::vector<ingest::Problem>& notes) {
    if (log.boots.empty()) return ingest::fail(*log.nothing);
    if (log.boots.size() == 1 && flight_.flight.empty()) return log.boots.front();
    if (log.parts.empty()) return log.boots.front();
    std::vector<ingest::Problem> longest;
    const auto chosen = product::choose_flights(log, flight_.flight == "all" ? "" : flight_.flight, false, longest);
    if (!chosen) return ingest::fail(chosen.error());
    if (log.boots.size() > 1 && flight_.flight.empty())
      notes.push_back({Kind::doubtful,
                       fmt::format("the log has {} boots of the autopilot; this is the one of the longest flight",
                                   log.boots.size()),
                       {log.path.string(), {}, {}, {}},
                       "choose another by one of its flights: --flight N"});
    return chosen->front().boot;
  }

  product::InputSettings input_;
  product::FlightChoice flight_;
};

}  // namespace

std::unique_ptr<Verb> make_convert_verb() { return std::make_unique<ConvertVerb>(); }

}  // namespace quadsonde::cli
