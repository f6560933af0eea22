#include "export/bufr/elements.h"

#include <cmath>

namespace quadsonde::product {

BufrWind bufr_wind(const estimator::MaybeWind& maybe, const BufrElement& speed, const BufrElement& from,
                   bool keep_speed) {
  const auto* wind = std::get_if<estimator::WindEstimate>(&maybe);
  if (!wind) return {};
  const auto report = estimator::to_report(*wind);
  const auto rounded = within(speed, report.speed_m_s);
  if (!rounded) return {};
  if (*rounded == 0) return {0.0, 0.0};
  auto direction = within(from, report.from_deg);
  if (direction == 0.0) direction = 360.0;
  if (!direction && !keep_speed) return {};
  return {rounded, direction};
}

std::optional<double> quality_0_33_003(estimator::Quality quality) {
  using estimator::Quality;
  if (quality == Quality::none) return std::nullopt;
  return quality == Quality::good ? 0.0 : quality == Quality::doubtful ? 1.0 : 3.0;
}

std::optional<double> quality_0_33_002(estimator::Quality quality) {
  if (quality == estimator::Quality::none) return std::nullopt;
  return quality == estimator::Quality::good ? 0.0 : 1.0;
}

void set_wigos(BufrMessage& message, const Station& station) {
  const auto id = parse_wigos_id(station.wigos_id);
  const auto number = [&](int WigosId::*part) { return id ? std::optional<double>((*id).*part) : std::nullopt; };
  message.set("wigosIdentifierSeries", number(&WigosId::series));
  message.set("wigosIssuerOfIdentifier", number(&WigosId::issuer));
  message.set("wigosIssueNumber", number(&WigosId::number));
  message.set_text("wigosLocalIdentifierCharacter", id ? id->local : "");
}

void set_time(BufrMessage& message, std::size_t rank, ingest::UtcTime time, bool with_seconds) {
  const auto t = split_utc(time);
  message.set(rank, "year", t.year);
  message.set(rank, "month", t.month);
  message.set(rank, "day", t.day);
  message.set(rank, "hour", t.hour);
  message.set(rank, "minute", t.minute);
  if (with_seconds) message.set(rank, "second", t.second);
}

}  // namespace quadsonde::product
