#include "cli/verbs/answers.h"
#include "export/report/text_answer.h"

namespace quadsonde::cli {
namespace {

class EstimateVerb : public Verb {
 public:
  std::string name() const override { return "estimate"; }
  std::string usage() const override { return "LOG -o X.csv|.json|.nc|.svg"; }
  std::string summary() const override { return "the wind along a flight, with its uncertainty"; }
  void describe(Options& options) override {
    auto& s = verb_.settings;
    product::describe(s.input, options);
    product::describe(s.flight, options);
    product::describe(s.drag, options);
    product::describe(s.mode, options);
    estimator::describe(s.estimate, options);
  }
  int run(const Call& call) override {
    verb_.want_profile = false;
    verb_.render = product::render_wind;
    verb_.say = [](const product::FlightAnswer& a) {
      return product::wind_answer(a.title, a.series, a.source.vehicle);
    };
    return verb_.run(call);
  }

 private:
  AnswerVerb verb_;
};

}  // namespace

std::unique_ptr<Verb> make_estimate_verb() { return std::make_unique<EstimateVerb>(); }

}  // namespace quadsonde::cli
