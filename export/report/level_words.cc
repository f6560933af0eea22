#include "export/report/level_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "export/report/words.h"
#include "profiles/levels.h"

namespace quadsonde::product {
namespace {

double half_width(const profiles::Uncertain& u) { return 1.96 * u.sd; }

/// "3.2 +- 0.4 m/s from 253 +- 8 deg (west-southwest)"
std::string with_interval(const estimator::WindEstimate& wind) {
  if (!wind.has_covariance) return wind_words(wind);
  const auto report = estimator::to_report(wind);
  auto text = fmt::format("{:.1f} +- {:.1f} m/s", report.speed_m_s, 1.96 * estimator::speed_sd(wind));
  const auto sd_from = estimator::direction_sd_deg(wind);
  if (!report.from_deg || !sd_from) return text + ", direction not determined";
  return text + fmt::format(" from {:.0f} +- {:.0f} deg ({})", *report.from_deg, std::min(180.0, 1.96 * *sd_from),
                            compass_word(*report.from_deg));
}

std::string shear_sentence(const profiles::Shear& s) {
  auto text = fmt::format("between {:.0f} and {:.0f} m: shear {:.3f} +- {:.3f} 1/s", s.lower, s.upper, s.shear.value,
                          half_width(s.shear));
  if (s.veer)
    text += fmt::format(", {} by {:.0f} +- {:.0f} deg", s.veer->value < 0 ? "backing" : "veering",
                        std::abs(s.veer->value), half_width(*s.veer));
  return text;
}

}  // namespace

std::vector<std::string> level_sentences(const profiles::WindProfile& profile) {
  std::vector<std::string> all;
  const auto levels = profiles::describe_levels(profile);
  for (const auto& level : levels.winds) {
    const bool hub = profile.hub_height && level.height == *profile.hub_height;
    if (level.wind)
      all.push_back(
          fmt::format("at {}{:.0f} m: {}", hub ? "hub height, " : "", level.height, with_interval(*level.wind)));
    else if (hub)
      all.push_back(fmt::format("at hub height, {:.0f} m: the profile does not reach there", level.height));
  }
  for (const auto& shear : levels.shears) all.push_back(shear_sentence(shear));
  // A law that the flight hardly tells is not worth a line; JSON has it with its sd.
  if (levels.power && half_width(levels.power->exponent) < 0.3)
    all.push_back(fmt::format("power law: exponent {:.2f} +- {:.2f} over {} bins", levels.power->exponent.value,
                              half_width(levels.power->exponent), levels.power->bins));
  if (levels.log && half_width(levels.log->log_roughness) < 3) {
    const auto& z = levels.log->log_roughness;
    all.push_back(fmt::format("log law (neutral): roughness {:.2g} m ({:.2g} to {:.2g}), friction velocity {:.2f} m/s",
                              levels.log->roughness, std::exp(z.value - half_width(z)),
                              std::exp(z.value + half_width(z)), levels.log->friction_velocity.value));
  }
  // Less than half sure it is no news, only what the noise can look like; JSON has it.
  if (levels.jet && levels.jet->probability >= 0.5)
    all.push_back(fmt::format("low-level jet at {:.0f} m: {:.1f} m/s, {:.1f} m/s above the minimum over it, {:.0f} % sure",
                              levels.jet->height, levels.jet->speed.value, levels.jet->drop_above,
                              100 * levels.jet->probability));
  if (levels.richardson)
    all.push_back(fmt::format("bulk Richardson number {:.2f} +- {:.2f} between {:.0f} and {:.0f} m",
                              levels.richardson->number.value, half_width(levels.richardson->number),
                              levels.richardson->lower, levels.richardson->upper));
  return all;
}

std::vector<std::string> leg_sentences(const profiles::WindProfile& profile) {
  std::vector<std::string> all;
  using Kind = profiles::FoundLeg::Kind;
  for (const auto& leg : profile.found) {
    auto text = std::string(profiles::name(leg.kind));
    const bool climbs = leg.kind == Kind::ascent || leg.kind == Kind::descent;
    if (leg.lowest && climbs)
      text += fmt::format(" from {:.0f} to {:.0f} m", leg.kind == Kind::ascent ? *leg.lowest : *leg.highest,
                          leg.kind == Kind::ascent ? *leg.highest : *leg.lowest);
    else if (leg.lowest)
      text += fmt::format(" at {:.0f} m", (*leg.lowest + *leg.highest) / 2);
    text += fmt::format(" for {:.0f} s", leg.seconds);
    if (climbs) text += fmt::format(" ({:.1f} m/s)", std::abs(leg.climb));
    if (leg.kind == Kind::level || leg.kind == Kind::transit) text += fmt::format(" ({:.1f} m/s over ground)", leg.speed);
    all.push_back(std::move(text));
  }
  return all;
}

std::vector<std::string> note_sentences(const profiles::WindProfile& profile) {
  std::vector<std::string> all;
  for (const auto& note : profile.notes) {
    all.push_back(problem_sentence(note));
    auto& first = all.back().front();
    if (first >= 'a' && first <= 'z') first = static_cast<char>(first - 'a' + 'A');
  }
  return all;
}

}  // namespace quadsonde::product
