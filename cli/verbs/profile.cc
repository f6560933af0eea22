#include "cli/verbs/answers.h"
#include "export/pipeline/merge.h"
#include "export/report/section_answer.h"
#include "export/report/text_answer.h"

namespace quadsonde::cli {
namespace {

std::string profile_of(const product::FlightAnswer& a) {
  if (a.merged)
    return product::merged_answer(a.title, *a.profile, product::spread_sentence(a), a.source.vehicle);
  return product::profile_answer(a.title, *a.profile, a.series.diagnostics, a.source.vehicle, a.autopilot_wind);
}

std::string section_text(const product::FlightAnswer& a) {
  return product::section_answer(a.title, *a.section, a.source.vehicle);
}

class ProfileVerb : public Verb {
 public:
  std::string name() const override { return "profile"; }
  std::string usage() const override { return "LOG... -o X.csv|.json|.nc|.svg|.html|..."; }
  std::string summary() const override { return "the vertical wind profile of a flight"; }
  void describe(Options& options) override {
    product::describe(verb_.settings, options);
    product::describe(verb_.settings.product, options);
    options("merge", verb_.merge, "All flights of all logs to one profile, weighted by their covariances.");
    options("section", verb_.section,
            "Wind over time and height instead: each ascent and descent of all flights of all logs as a column of its "
            "own, nothing interpolated; as text, .csv, .json, .nc, .svg or .html.");
  }
  int run(const Call& call) override {
    verb_.render = verb_.section ? product::render_section : product::render_profile;
    verb_.say = verb_.section ? section_text : profile_of;
    return verb_.run(call);
  }

 private:
  AnswerVerb verb_;
};

}  // namespace

std::unique_ptr<Verb> make_profile_verb() { return std::make_unique<ProfileVerb>(); }

}  // namespace quadsonde::cli
