#include "export/mcap/flight_to_mcap.h"

#include <fmt/format.h>

#include <limits>

#include "export/atomic_file.h"
#include "export/mcap/tracks.h"
#include "ingest/mcap/own_schema.h"
#include "ingest/mcap/writer.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::LogTime;
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

/// One sample of one track.
struct Entry {
  LogTime time;
  std::uint32_t track = 0, sample = 0;
};

/// All samples in the order of their times; those of one time in the order of the tracks.
Result<std::vector<Entry>> merge(const std::vector<Track>& tracks) {
  std::vector<Entry> entries;
  std::size_t count = 0;
  for (const auto& track : tracks) count += track.times.size();
  if (count > std::numeric_limits<std::uint32_t>::max()) return fail(ingest::Kind::limit, "more than 4e9 samples");
  entries.reserve(count);
  for (std::uint32_t t = 0; t < tracks.size(); ++t)
    for (std::uint32_t i = 0; i < tracks[t].times.size(); ++i) entries.push_back({tracks[t].times[i], t, i});
  std::ranges::stable_sort(entries, {}, &Entry::time);
  return entries;
}

/// What to add to a log time for an MCAP time: UTC where it is known and after 1970, else the log clock itself,
/// moved only as far as negative times need.
std::int64_t mcap_minus_log(const ingest::Flight& flight, const std::vector<Entry>& entries) {
  const auto first = entries.empty() ? LogTime{} : entries.front().time;
  const auto last = entries.empty() ? LogTime{} : entries.back().time;
  if (const auto offset = flight.clock.utc_minus_log) {
    const auto from = first + *offset, to = last + *offset;
    if (from.ns >= 0 && to.ns >= from.ns) return offset->count();
  }
  return first.ns >= 0 ? 0 : (LogTime{} - first).count();
}

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

/// Declares the channels; gives their ids by track.
Result<std::vector<std::uint16_t>> add_channels(ingest::mcap::Writer& writer, const std::vector<Track>& tracks,
                                                std::int64_t shift) {
  std::vector<std::uint16_t> ids;
  for (const auto& track : tracks) {
    const auto& descriptor = *track.message->GetDescriptor();
    const auto data = track.json ? own::json_schema(descriptor) : own::descriptor_set(descriptor);
    const auto schema = writer.add_schema(descriptor.full_name(), track.json ? "jsonschema" : "protobuf",
                                          ingest::as_bytes(data));
    if (!schema) return fail(schema.error());
    auto metadata = track.metadata;
    metadata.emplace_back(own::kShift, std::to_string(shift));
    const auto id = writer.add_channel(*schema, track.topic, track.json ? "json" : "protobuf", std::move(metadata));
    if (!id) return fail(id.error());
    ids.push_back(*id);
  }
  return ids;
}

}  // namespace

Result<void> write_flight(ingest::mcap::Sink& sink, const ingest::Flight& flight, const FlightFileSettings& settings,
                          const ingest::Truth& truth) {
  ingest::mcap::WriterSettings writing;
  writing.profile = "quadsonde";
  writing.compression = settings.compression == FlightFileSettings::Compression::none  ? ingest::mcap::Compression::none
                        : settings.compression == FlightFileSettings::Compression::lz4 ? ingest::mcap::Compression::lz4
                                                                                       : ingest::mcap::Compression::zstd;
  auto tracks = tracks_of(flight, truth, settings);
  const auto entries = merge(tracks);
  if (!entries) return fail(entries.error());
  const auto shift = mcap_minus_log(flight, *entries);
  ingest::mcap::Writer writer(sink, writing);
  if (auto done = write_metadata(writer, flight, shift); !done) return done;
  const auto ids = add_channels(writer, tracks, shift);
  if (!ids) return fail(ids.error());
  std::string data;
  for (const auto& entry : *entries) {
    auto& track = tracks[entry.track];
    const auto time = static_cast<std::uint64_t>((entry.time + ingest::Duration(shift)).ns);
    track.encode(entry.sample, time, data);
    auto done = writer.write({(*ids)[entry.track], entry.sample, time, time, ingest::as_bytes(data)});
    if (!done) return done;
  }
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
