#include "export/pipeline/check.h"

#include "cli/verbs/answers.h"

namespace quadsonde::cli {
namespace {

class CheckVerb : public Verb {
 public:
  std::string name() const override { return "check"; }
  std::string usage() const override { return "LOG..."; }
  std::string summary() const override { return "whether a log's telemetry is consistent, and what is wrong with it"; }
  void describe(Options& options) override { product::describe(settings_, options); }

  int run(const Call& call) override {
    std::vector<product::CheckAnswer> answers;
    Tally tally;
    for (const auto& input : call.inputs) check_log(call, input, answers, tally);
    if (answers.empty()) return tally.wrong ? wrong_usage : no_answer;
    std::vector<std::string> texts;
    for (const auto& answer : answers)
      texts.push_back(wants_json(call) ? product::check_json(answer) : product::check_text(answer));
    if (const int given = give(call, texts); given != complete) return given;
    return tally.wrong ? wrong_usage : tally.failed || tally.doubts ? with_doubts : complete;
  }

 private:
  struct Tally {
    bool failed = false, wrong = false, doubts = false;
  };

  void check_log(const Call& call, const std::filesystem::path& input, std::vector<product::CheckAnswer>& answers,
                 Tally& tally) {
    const auto fail = [&](const ingest::Problem& problem) {
      call.console.error(problem);
      (problem.kind == ingest::Kind::usage ? tally.wrong : tally.failed) = true;
    };
    const auto log = product::load_log(input, settings_.input, call.control);
    if (!log) return fail(log.error());
    std::vector<ingest::Problem> notes;
    const auto parts = product::choose_flights(*log, settings_.flight.flight, false, notes);
    if (!parts) return fail(parts.error());
    const auto vehicle = product::choose_vehicle(settings_.drag, input, &parts->front().boot->vehicle);
    if (!vehicle) return fail(vehicle.error());
    call.console.warnings(notes);
    tally.doubts = tally.doubts || !notes.empty();
    for (const auto& part : *parts) {
      auto answer = product::check(*log, part, *vehicle, settings_.check, call.control);
      if (!answer) {
        fail(answer.error());
        continue;
      }
      if (const auto advice = product::heading_problem(answer->heading, estimator::EstimateSettings{}.heading_sd_deg,
                                                       settings_.input, input.string()))
        answer->problems.push_back(*advice);
      call.console.warnings(answer->problems);
      if (const auto problem = product::verdict_problem(answer->report, input.string())) call.console.warning(*problem);
      tally.doubts = tally.doubts || answer->report.verdict == ingest::Verdict::inconsistent;
      answers.push_back(std::move(*answer));
    }
  }

  product::CheckSettings settings_;
};

}  // namespace

std::unique_ptr<Verb> make_check_verb() { return std::make_unique<CheckVerb>(); }

}  // namespace quadsonde::cli
