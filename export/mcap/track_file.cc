#include "export/mcap/track_file.h"

#include <algorithm>
#include <limits>

#include "ingest/mcap/own_schema.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::LogTime;
using ingest::Result;
namespace own = ingest::own;

/// Declares the channels; gives their ids by track.
Result<std::vector<std::uint16_t>> add_channels(ingest::mcap::Writer& writer, const std::vector<Track>& tracks,
                                                std::int64_t shift, bool tells_shift) {
  std::vector<std::uint16_t> ids;
  for (const auto& track : tracks) {
    const auto& descriptor = *track.message->GetDescriptor();
    const auto data = track.json ? own::json_schema(descriptor) : own::descriptor_set(descriptor);
    const auto schema =
        writer.add_schema(descriptor.full_name(), track.json ? "jsonschema" : "protobuf", ingest::as_bytes(data));
    if (!schema) return fail(schema.error());
    auto metadata = track.metadata;
    if (tells_shift) metadata.emplace_back(own::kShift, std::to_string(shift));
    const auto id = writer.add_channel(*schema, track.topic, track.json ? "json" : "protobuf", std::move(metadata));
    if (!id) return fail(id.error());
    ids.push_back(*id);
  }
  return ids;
}

}  // namespace

Result<std::vector<TrackEntry>> merge(const std::vector<Track>& tracks) {
  std::vector<TrackEntry> entries;
  std::size_t count = 0;
  for (const auto& track : tracks) count += track.times.size();
  if (count > std::numeric_limits<std::uint32_t>::max()) return fail(ingest::Kind::limit, "more than 4e9 samples");
  entries.reserve(count);
  for (std::uint32_t t = 0; t < tracks.size(); ++t)
    for (std::uint32_t i = 0; i < tracks[t].times.size(); ++i) entries.push_back({tracks[t].times[i], t, i});
  std::ranges::stable_sort(entries, {}, &TrackEntry::time);
  return entries;
}

std::int64_t mcap_minus_log(std::optional<ingest::Duration> utc_minus_log, const std::vector<TrackEntry>& entries) {
  const auto first = entries.empty() ? LogTime{} : entries.front().time;
  const auto last = entries.empty() ? LogTime{} : entries.back().time;
  if (utc_minus_log) {
    const auto from = first + *utc_minus_log, to = last + *utc_minus_log;
    if (from.ns >= 0 && to.ns >= from.ns) return utc_minus_log->count();
  }
  return first.ns >= 0 ? 0 : (LogTime{} - first).count();
}

ingest::mcap::WriterSettings writer_settings(const FlightFileSettings& settings) {
  using Ours = FlightFileSettings::Compression;
  using Theirs = ingest::mcap::Compression;
  ingest::mcap::WriterSettings writing;
  writing.profile = "quadsonde";
  writing.compression = settings.compression == Ours::none  ? Theirs::none
                        : settings.compression == Ours::lz4 ? Theirs::lz4
                                                            : Theirs::zstd;
  return writing;
}

Result<void> write_entries(ingest::mcap::Writer& writer, std::vector<Track>& tracks,
                           const std::vector<TrackEntry>& entries, std::int64_t shift, bool tells_shift) {
  const auto ids = add_channels(writer, tracks, shift, tells_shift);
  if (!ids) return fail(ids.error());
  std::string data;
  for (const auto& entry : entries) {
    auto& track = tracks[entry.track];
    const auto time = static_cast<std::uint64_t>((entry.time + ingest::Duration(shift)).ns);
    track.encode(entry.sample, time, data);
    auto done = writer.write({(*ids)[entry.track], entry.sample, time, time, ingest::as_bytes(data)});
    if (!done) return done;
  }
  return {};
}

}  // namespace quadsonde::product
