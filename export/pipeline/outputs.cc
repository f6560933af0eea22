#include "export/pipeline/outputs.h"

#include <fmt/format.h>


namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;

/// Bytes on their way into a file, until somebody wants to stop.
class StoppableSink : public ingest::mcap::Sink {
 public:
  StoppableSink(AtomicFile& file, const Control& control) : file_(file), control_(control) {}
  bool write(ingest::Bytes bytes) override {
    if (control_.stopped()) problem = stopped_problem();
    if (problem) return false;
    if (auto written = file_.write(bytes); !written) problem = written.error();
    return !problem;
  }
  std::optional<ingest::Problem> problem;

 private:
  AtomicFile& file_;
  const Control& control_;
};

}  // namespace

Outputs::Outputs(bool overwrite, Control control) : overwrite_(overwrite), control_(std::move(control)) {
  if (control_.writing) ++*control_.writing;
}

Outputs::~Outputs() {
  files_.clear();
  // Only empty folders go: remove() refuses others.
  std::error_code ignored;
  if (!committed_)
    for (auto it = made_folders_.rbegin(); it != made_folders_.rend(); ++it) std::filesystem::remove(*it, ignored);
  if (control_.writing) --*control_.writing;
}

ingest::Result<void> Outputs::make_folder(const std::filesystem::path& folder) {
  if (control_.stopped()) return fail(stopped_problem());
  std::vector<std::filesystem::path> missing;
  std::error_code error;
  for (auto at = folder; !at.empty() && !std::filesystem::exists(at, error); at = at.parent_path())
    missing.push_back(at);
  for (auto it = missing.rbegin(); it != missing.rend(); ++it) {
    if (std::filesystem::create_directory(*it, error)) made_folders_.push_back(*it);
    if (error)
      return fail(Kind::write_failed, fmt::format("this folder cannot be made: {}", error.message()),
                  {it->string(), {}, {}, {}}, "name another output or change its permissions");
  }
  if (!std::filesystem::is_directory(folder, error))
    return fail(Kind::usage, "this is a file, not a folder", {folder.string(), {}, {}, {}}, "name a folder with -o");
  return {};
}

ingest::Result<AtomicFile*> Outputs::begin(const std::filesystem::path& path) {
  if (control_.stopped()) return fail(stopped_problem());
  auto file = AtomicFile::create(path, overwrite_);
  if (!file) return fail(file.error());
  files_.push_back(std::move(*file));
  return &files_.back();
}

ingest::Result<void> Outputs::add(const std::filesystem::path& path, std::string_view content) {
  auto file = begin(path);
  if (!file) return fail(file.error());
  constexpr std::size_t piece = std::size_t{1} << 20;
  for (std::size_t at = 0; at < content.size(); at += piece) {
    if (control_.stopped()) return fail(stopped_problem());
    if (auto written = (*file)->write(content.substr(at, piece)); !written) return written;
  }
  return {};
}

ingest::Result<void> Outputs::add_flight(const std::filesystem::path& path, const ingest::Flight& flight,
                                         const ingest::Truth& truth, const FlightProducts& products) {
  auto file = begin(path);
  if (!file) return fail(file.error());
  StoppableSink sink(**file, control_);
  auto written = write_flight(sink, flight, {}, truth, products);
  if (sink.problem) return fail(*sink.problem);
  return written;
}

ingest::Result<void> Outputs::commit() {
  if (control_.stopped()) return fail(stopped_problem());
  for (auto& file : files_)
    if (auto done = file.commit(); !done) return done;
  committed_ = true;
  return {};
}

}  // namespace quadsonde::product
