#include "cli/verbs/answers.h"
#include "export/report/text_answer.h"

namespace quadsonde::cli {
namespace {

std::string profile_of(const product::FlightAnswer& a) {
  return product::profile_answer(a.title, *a.profile, a.series.diagnostics, a.source.vehicle);
}

class ProfileVerb : public Verb {
 public:
  std::string name() const override { return "profile"; }
  std::string usage() const override { return "LOG... -o X.csv|.json|.nc|.svg|.html"; }
  std::string summary() const override { return "the vertical wind profile of a flight"; }
  void describe(Options& options) override { product::describe(verb_.settings, options); }
  int run(const Call& call) override {
    verb_.render = product::render_profile;
    verb_.say = profile_of;
    return verb_.run(call);
  }

 private:
  AnswerVerb verb_;
};

}  // namespace

std::unique_ptr<Verb> make_profile_verb() { return std::make_unique<ProfileVerb>(); }

}  // namespace quadsonde::cli
