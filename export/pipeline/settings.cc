#include "export/pipeline/settings.h"

namespace quadsonde::product {

void apply_words(PipelineSettings& s) {
  using estimator::Mode;
  s.estimate.mode = s.mode.causal || s.mode.mode == "causal" ? Mode::causal
                    : s.mode.mode == "classic"               ? Mode::classic
                                                             : Mode::smoothed;
  s.profile.method = s.leg.method == "optimal" ? profiles::Method::optimal : profiles::Method::bins;
  s.profile.datum = s.leg.datum == "msl" ? profiles::Datum::msl : profiles::Datum::agl;
}

}  // namespace quadsonde::product
