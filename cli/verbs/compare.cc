#include <algorithm>

#include "cli/verbs/answers.h"
#include "export/csv/tables.h"
#include "export/pipeline/compare_files.h"

namespace quadsonde::cli {
namespace {

class CompareVerb : public Verb {
 public:
  std::string name() const override { return "compare"; }
  std::string usage() const override { return "PROFILE... REFERENCE... -o X.json|.svg"; }
  std::string summary() const override { return "scores of profiles against METAR, stations or the true wind"; }
  void describe(Options& options) override { product::describe(settings_, options); }

  int run(const Call& call) override {
    if (const auto problem = wrong_output(call)) return refuse(call, *problem);
    const auto result = product::compare_files(call.inputs, settings_, call.control);
    if (!result) return refuse(call, result.error());
    for (const auto& taken : result->taken) call.console.note(taken);
    for (const auto& failure : result->failures) call.console.error(failure);
    if (result->flights.empty()) return no_answer;
    for (const auto& flight : result->flights) call.console.warnings(flight.comparison.problems());
    if (is_picture(call) && result->flights.size() > 1)
      return refuse(call, {ingest::Kind::usage,
                           "one picture holds one profile",
                           {call.output()->string(), {}, {}, {}},
                           "give one profile, or -o X.json"});
    if (const int given = answer(call, result->flights); given != complete) return given;
    return result->with_doubts() ? with_doubts : complete;
  }

 private:
  static bool is_picture(const Call& call) { return call.output() && call.output()->extension() == ".svg"; }

  static std::optional<ingest::Problem> wrong_output(const Call& call) {
    const auto output = call.output();
    if (!output) return std::nullopt;
    if (output->extension() != ".json" && output->extension() != ".svg")
      return ingest::Problem{ingest::Kind::usage,
                             "this ending names no format of a comparison",
                             {output->string(), {}, {}, {}},
                             "use .json or .svg"};
    std::error_code error;
    if (!call.common.force && std::filesystem::exists(*output, error))
      return ingest::Problem{ingest::Kind::usage,
                             "this file is already there",
                             {output->string(), {}, {}, {}},
                             "name another output or allow overwriting with --force"};
    return std::nullopt;
  }

  static int refuse(const Call& call, const ingest::Problem& problem) {
    call.console.error(problem);
    return exit_code(problem);
  }

  static int write(const Call& call, const std::string& text) {
    product::Outputs outputs(call.common.force, call.control);
    auto done = outputs.add(*call.output(), text);
    if (done) done = outputs.commit();
    return done ? complete : refuse(call, done.error());
  }

  static int answer(const Call& call, const std::vector<product::ComparedFlight>& flights) {
    std::vector<std::string> objects;
    for (const auto& f : flights) objects.push_back(comparison_json(f.comparison, f.title.file, f.flight));
    const auto json = objects.size() == 1 ? objects.front() : product::json_list(objects);
    if (call.output()) {
      const auto& text = is_picture(call) ? compared_svg(flights.front()) : json;
      if (const int written = write(call, text); written != complete || !call.common.json) return written;
    }
    if (call.common.json) {
      call.console.print(json);
      return complete;
    }
    for (std::size_t i = 0; i < flights.size(); ++i) call.console.print((i ? "\n" : "") + compared_text(flights[i]));
    return complete;
  }

  product::ReferenceSettings settings_;
};

}  // namespace

std::unique_ptr<Verb> make_compare_verb() { return std::make_unique<CompareVerb>(); }

}  // namespace quadsonde::cli
