#include "cli/verbs/answers.h"
#include "export/report/text_answer.h"

namespace quadsonde::cli {
namespace {

class EstimateVerb : public Verb {
 public:
  std::string name() const override { return "estimate"; }
  std::string usage() const override { return "LOG -o X.csv|.json|.nc|.mcap|.svg|.kml|.geojson"; }
  std::string summary() const override { return "the wind along a flight, with its uncertainty"; }
  void describe(Options& options) override {
    auto& s = verb_.settings;
    product::describe(s.input, options);
    product::describe(s.flight, options);
    product::describe(s.drag, options);
    product::describe(s.mode, options);
    estimator::describe(s.estimate, options);
    product::describe(s.station, options);
    product::describe(s.product, options);
    options("picture", picture_, {"wind", "state"},
            "What X.svg shows: speed and direction, or airspeed and wind north and east.");
    options.list("reference", verb_.references, "FILE.csv",
                 "Tables of the true wind (time_s, height_agl_m, wind_east_m_s, ...), drawn in the picture.");
  }
  int run(const Call& call) override {
    verb_.want_profile = false;
    verb_.render = [this](const product::FlightAnswer& answer, product::Format format) {
      if (format == product::Format::svg && picture_ == "state")
        return ingest::Result<std::string>(product::render_state(answer));
      return product::render_wind(answer, format);
    };
    verb_.say = [](const product::FlightAnswer& a) {
      return product::wind_answer(a.title, a.series, a.source.vehicle, a.autopilot_wind);
    };
    return verb_.run(call);
  }

 private:
  std::string picture_ = "wind";
  AnswerVerb verb_;
};

}  // namespace

std::unique_ptr<Verb> make_estimate_verb() { return std::make_unique<EstimateVerb>(); }

}  // namespace quadsonde::cli
