#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "cli/verbs/answers.h"
#include "export/archive/answer.h"
#include "export/csv/tables.h"
#include "export/pipeline/archive_run.h"
#include "export/report/text_answer.h"

namespace quadsonde::cli {
namespace {

class RunVerb : public Verb {
 public:
  std::string name() const override { return "run"; }
  std::string usage() const override { return "LOG... -o DIR"; }
  std::string summary() const override { return "the whole job: a folder with tables, picture and report per flight"; }
  void describe(Options& options) override {
    product::describe(settings_, options);
    options.list("reference", references_, "FILE",
                 "Winds of others to compare with: the true wind of a simulation, METAR, a table of a station.");
    product::describe(reference_, options);
    options("archive", archive_, "DIR", "Also adds the profiles to this archive; made where there is none.");
  }

  int run(const Call& call) override {
    product::apply_words(settings_);
    std::vector<std::string> printed;
    int code = complete;
    bool any = false, failed = false;
    for (const auto& input : call.inputs) {
      if (call.control.stopped()) break;
      product::RunRequest request;
      request.log = input;
      request.folder = call.output();
      request.references.assign(references_.begin(), references_.end());
      request.reference = reference_;
      request.settings = settings_;
      request.overwrite = call.common.force;
      const auto result = product::run_log(request, call.control);
      if (!result) {
        call.console.error(result.error());
        failed = true;
        if (result.error().kind == ingest::Kind::usage) code = wrong_usage;
        continue;
      }
      any = true;
      tell(call.console, *result);
      if (result->with_doubts()) code = std::max(code == wrong_usage ? 0 : code, with_doubts);
      for (const auto& flight : result->flights) answer(call, flight, printed);
      if (!archive_.empty()) code = std::max(code, archive(call, *result));
    }
    if (call.common.json && !printed.empty())
      call.console.print(printed.size() == 1 ? printed.front() : product::json_list(printed));
    if (!any) return code == wrong_usage ? wrong_usage : no_answer;
    return failed ? with_doubts : code;
  }

 private:
  void answer(const Call& call, const product::FlightRun& run, std::vector<std::string>& printed) {
    const auto& a = run.answer;
    if (call.common.json) {
      printed.push_back(product::run_json(a, run.files));
      return;
    }
    auto text = a.profile ? product::profile_answer(a.title, *a.profile, a.series.diagnostics, a.source.vehicle,
                                                    a.autopilot_wind)
                          : product::wind_answer(a.title, a.series, a.source.vehicle, a.autopilot_wind);
    if (a.comparison) text += "\n" + product::comparison_text(*a.comparison);
    if (!run.folder.empty())
      text += "\n" + run.folder.string() + ":\n" +
              product::wrapped(fmt::format("  {}", fmt::join(run.files, ", ")), 79, 2) + "\n";
    call.console.print((printed.empty() ? "" : "\n") + text);
    printed.push_back({});
  }

  int archive(const Call& call, const product::RunResult& result) {
    const auto archived = product::archive_run(result, archive_, call.control);
    if (!archived) {
      call.console.error(archived.error());
      return with_doubts;
    }
    call.console.warnings(archived->left_out);
    for (const auto& added : archived->added)
      if (!call.common.json) call.console.print("\n" + archive_ + ":\n  " + product::added_text(added));
    return archived->left_out.empty() ? complete : with_doubts;
  }

  product::PipelineSettings settings_;
  std::string archive_;
  std::vector<std::string> references_;
  product::ReferenceSettings reference_;
};

}  // namespace

std::unique_ptr<Verb> make_run_verb() { return std::make_unique<RunVerb>(); }

}  // namespace quadsonde::cli
