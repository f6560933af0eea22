#include "export/mcap/products_to_mcap.h"

#include "export/mcap/product_tracks.h"
#include "export/mcap/track_file.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::LogTime;
using ingest::Result;

class StringSink : public ingest::mcap::Sink {
 public:
  bool write(ingest::Bytes part) override {
    bytes.append(ingest::as_text(part));
    return true;
  }
  std::string bytes;
};

/// @param start  of profiles
/// @param utc_minus_log  of the wind's times; profiles have UTC only, and no clock to tell
Result<std::string> file_of(const FlightProducts& products, LogTime start,
                            std::optional<ingest::Duration> utc_minus_log, const FlightFileSettings& settings) {
  std::vector<Track> tracks;
  add_product_tracks(tracks, products, start, settings);
  const auto entries = merge(tracks);
  if (!entries) return fail(entries.error());
  const auto shift = mcap_minus_log(utc_minus_log, *entries);
  StringSink sink;
  ingest::mcap::Writer writer(sink, writer_settings(settings));
  auto done = write_product_metadata(writer, products);
  if (done) done = write_entries(writer, tracks, *entries, shift, products.wind != nullptr);
  if (done) done = writer.close();
  if (!done) return fail(done.error());
  return std::move(sink.bytes);
}

/// Of the first point that knows it.
std::optional<ingest::Duration> utc_minus_log(const estimator::WindSeries& series) {
  for (const auto& point : series.points)
    if (point.utc) return ingest::Duration(point.utc->ns - point.time.ns);
  return std::nullopt;
}

LogTime earliest_utc(const profiles::WindProfile& profile) {
  std::optional<ingest::UtcTime> first;
  for (const auto& leg : profile.legs)
    if (leg.utc_from && (!first || *leg.utc_from < *first)) first = leg.utc_from;
  return {first ? first->ns : 0};
}

}  // namespace

Result<std::string> wind_mcap(const estimator::WindSeries& series, const ProductSource& source,
                              const FlightFileSettings& settings) {
  return file_of({&series, nullptr, &source}, {}, utc_minus_log(series), settings);
}

Result<std::string> profile_mcap(const profiles::WindProfile& profile, const ProductSource& source,
                                 const FlightFileSettings& settings) {
  return file_of({nullptr, &profile, &source}, earliest_utc(profile), std::nullopt, settings);
}

}  // namespace quadsonde::product
