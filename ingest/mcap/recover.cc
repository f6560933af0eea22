#include "ingest/mcap/recover.h"

#include <map>
#include <memory>

namespace quadsonde::ingest::mcap {
namespace {

Writer::Pairs owned(const StringPairs& pairs) { return {pairs.begin(), pairs.end()}; }

class Recovery {
 public:
  Recovery(Bytes file, Sink& sink, const RecoverSettings& settings)
      : reader_(file, {Reading::salvage, settings.check_crc, settings.max_chunk, settings.file_name}),
        sink_(sink),
        writing_(settings.writing) {}

  Result<Recovered> run() {
    Record record;
    while (reader_.next(record))
      if (auto done = take(record); !done) return fail(done.error());
    const auto& problems = reader_.problems();
    if (!writer_ && !problems.empty() && problems.front().kind == Kind::not_a_log) return fail(problems.front());
    if (auto done = writer().close(); !done) return fail(done.error());
    result_.counts = reader_.counts();
    result_.problems = problems;
    return std::move(result_);
  }

 private:
  /// Made with the first record behind the header, when the profile is known.
  Writer& writer() {
    if (!writer_) writer_ = std::make_unique<Writer>(sink_, writing_);
    return *writer_;
  }

  Result<void> take(const Record& record) {
    switch (record.op) {
      case Op::header:
        take_header(*parse_header(record.content));
        return {};
      case Op::message:
        return copy(record.message());
      case Op::attachment: {
        const auto a = *parse_attachment(record.content);
        ++result_.attachments;
        return writer().attach(a.log_time, a.create_time, std::string(a.name), std::string(a.media_type), a.data);
      }
      case Op::metadata: {
        const auto m = *parse_metadata(record.content);
        ++result_.metadata;
        return writer().add_metadata(std::string(m.name), owned(m.metadata));
      }
      default:
        return {};
    }
  }

  void take_header(const Header& header) {
    if (writer_) return;
    writing_.profile = header.profile;
    writing_.library = header.library;
  }

  Result<void> copy(Message message) {
    auto id = channel(message.channel_id);
    if (!id) return fail(id.error());
    message.channel_id = *id;
    return writer().write(message);
  }

  Result<std::uint16_t> channel(std::uint16_t old_id) {
    const auto found = channels_.find(old_id);
    if (found != channels_.end()) return found->second;
    const auto& known = *reader_.registry().channel(old_id);
    const auto schema_id = schema(known.schema_id);
    if (!schema_id) return schema_id;
    auto id = writer().add_channel(*schema_id, known.topic, known.message_encoding, known.metadata);
    if (id) channels_[old_id] = *id;
    return id;
  }

  Result<std::uint16_t> schema(std::uint16_t old_id) {
    const auto* known = reader_.registry().schema(old_id);
    if (!known) return std::uint16_t{0};
    const auto found = schemas_.find(old_id);
    if (found != schemas_.end()) return found->second;
    auto id = writer().add_schema(known->name, known->encoding, known->data);
    if (id) schemas_[old_id] = *id;
    return id;
  }

  RecordReader reader_;
  Sink& sink_;
  WriterSettings writing_;
  std::unique_ptr<Writer> writer_;
  std::map<std::uint16_t, std::uint16_t> channels_, schemas_;
  Recovered result_;
};

}  // namespace

Result<Recovered> recover(Bytes file, Sink& sink, const RecoverSettings& settings) {
  return Recovery(file, sink, settings).run();
}

}  // namespace quadsonde::ingest::mcap
