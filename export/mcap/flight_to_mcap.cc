#include "export/mcap/flight_to_mcap.h"

#include <fmt/format.h>

#include "export/atomic_file.h"
#include "export/mcap/product_tracks.h"
#include "export/mcap/track_file.h"
#include "ingest/mcap/own_schema.h"
#include "ingest/mcap/writer.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Result;
using Pairs = ingest::mcap::Writer::Pairs;
namespace own = ingest::own;

class FileSink : public ingest::mcap::Sink {
 public:
  explicit FileSink(AtomicFile& file) : file_(file) {}
  bool write(ingest::Bytes bytes) override {
    auto written = file_.write(bytes);
    if (!written) problem_ = written.error();
    return written.has_value();
  }
  const std::optional<ingest::Problem>& problem() const { return problem_; }

 private:
  AtomicFile& file_;
  std::optional<ingest::Problem> problem_;
};

std::string text(double value) { return fmt::format("{}", value); }

Pairs clock_pairs(const ingest::Clock& clock, std::int64_t shift) {
  Pairs pairs{{own::kShift, std::to_string(shift)}, {"source", own::utf8(clock.source)}};
  pairs.emplace_back("uncertainty_s", text(clock.uncertainty_s));
  if (clock.utc_minus_log) pairs.emplace_back("utc_minus_log_ns", std::to_string(clock.utc_minus_log->count()));
  return pairs;
}

Pairs vehicle_pairs(const ingest::VehicleIdentity& vehicle) {
  Pairs pairs{{"name", own::utf8(vehicle.name)},
              {"autopilot", own::utf8(vehicle.autopilot)},
              {"firmware", own::utf8(vehicle.firmware)},
              {"airframe", std::string(own::name_of(vehicle.airframe))},
              {"rotors", std::to_string(vehicle.rotors)},
              {"simulated", vehicle.simulated ? "true" : "false"}};
  if (vehicle.mass_kg) pairs.emplace_back("mass_kg", text(*vehicle.mass_kg));
  return pairs;
}

Pairs origin_pairs(const ingest::Origin& origin) {
  Pairs pairs{{"lat_deg", text(origin.point.lat_deg)}, {"lon_deg", text(origin.point.lon_deg)}};
  if (origin.height_msl) pairs.emplace_back("height_msl_m", text(origin.height_msl->m));
  return pairs;
}

Result<void> write_metadata(ingest::mcap::Writer& writer, const ingest::Flight& flight, std::int64_t shift) {
  auto done = writer.add_metadata(own::kFlight, {{"version", "1"}});
  if (done) done = writer.add_metadata(own::kClock, clock_pairs(flight.clock, shift));
  if (done) done = writer.add_metadata(own::kVehicle, vehicle_pairs(flight.vehicle));
  if (done && flight.origin) done = writer.add_metadata(own::kOrigin, origin_pairs(*flight.origin));
  return done;
}

}  // namespace

Result<void> write_flight(ingest::mcap::Sink& sink, const ingest::Flight& flight, const FlightFileSettings& settings,
                          const ingest::Truth& truth, const FlightProducts& products) {
  auto tracks = tracks_of(flight, truth, settings);
  add_product_tracks(tracks, products, first_time(tracks), settings);
  const auto entries = merge(tracks);
  if (!entries) return fail(entries.error());
  const auto shift = mcap_minus_log(flight.clock.utc_minus_log, *entries);
  ingest::mcap::Writer writer(sink, writer_settings(settings));
  if (auto done = write_metadata(writer, flight, shift); !done) return done;
  if (auto done = write_product_metadata(writer, products); !done) return done;
  if (auto done = write_entries(writer, tracks, *entries, shift); !done) return done;
  return writer.close();
}

Result<void> write_flight(const std::filesystem::path& path, const ingest::Flight& flight,
                          const FlightFileSettings& settings, const ingest::Truth& truth) {
  auto file = AtomicFile::create(path, settings.overwrite);
  if (!file) return fail(file.error());
  FileSink sink(*file);
  if (auto done = write_flight(sink, flight, settings, truth); !done) {
    if (sink.problem()) return fail(*sink.problem());
    if (done.error().where.file.empty()) done.error().where.file = path.string();
    return done;
  }
  return file->commit();
}

}  // namespace quadsonde::product
