#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "cli/verb.h"
#include "export/archive/answer.h"
#include "export/archive/subset.h"
#include "export/pipeline/archive_run.h"

namespace quadsonde::cli {
namespace {

namespace fs = std::filesystem;
using ingest::Kind;
using ingest::Problem;

/// Text onto standard output, or into the file of -o, whose ending says what it is.
int answer(const Call& call, const std::string& text, const std::string& json, const std::string& csv = {}) {
  if (!call.output()) {
    call.console.print(call.common.json ? json : text);
    return complete;
  }
  const auto ending = call.output()->extension();
  if (ending != ".json" && (ending != ".csv" || csv.empty())) {
    call.console.error({Kind::usage,
                        "this ending names no format of an answer",
                        {call.output()->string(), {}, {}, {}},
                        csv.empty() ? "use .json" : "use .csv or .json"});
    return wrong_usage;
  }
  product::Outputs outputs(call.common.force, call.control);
  auto done = outputs.add(*call.output(), ending == ".csv" ? csv : json);
  if (done) done = outputs.commit();
  if (!done) call.console.error(done.error());
  return done ? complete : exit_code(done.error());
}

int failed(const Call& call, const Problem& problem) {
  call.console.error(problem);
  return exit_code(problem);
}

/// Actions on one archive.
class ArchiveAction : public Verb {
 public:
  std::string usage() const override { return "DIR"; }
  std::size_t most_inputs() const override { return 1; }
  void describe(Options&) override {}

 protected:
  static ingest::Result<product::Archive> open(const Call& call) {
    return product::Archive::open(call.inputs.front(), product::archive_settings(call.control, "archive"));
  }
};

class AddAction : public ArchiveAction {
 public:
  std::string name() const override { return "archive add"; }
  std::string usage() const override { return "DIR (LOG|PROFILE.nc|RUN_FOLDER|ARCHIVE)..."; }
  std::string summary() const override {
    return "adds profiles to an archive, which is made where there is none; logs are run through first";
  }
  std::size_t most_inputs() const override { return SIZE_MAX; }
  void describe(Options& options) override { product::describe(settings_, options); }

  int run(const Call& call) override {
    product::apply_words(settings_);
    if (call.inputs.size() < 2)
      return failed(call, {Kind::usage, "what to add is missing", {}, "quadsonde archive add " + usage()});
    if (call.output()) return failed(call, {Kind::usage, "an archive is the output of `add`", {}, "leave -o out"});
    archive_ = call.inputs.front();
    if (auto opened = open_archive(call); !opened) return failed(call, opened.error());
    for (std::size_t i = 1; i < call.inputs.size() && !call.control.stopped() && !full_; ++i)
      take(call, call.inputs[i]);
    commit(call);
    if (call.common.json) call.console.print(product::added_json(all_, archive_));
    if (all_.empty()) return usage_ ? wrong_usage : no_answer;
    return failed_ || doubts_ ? with_doubts : complete;
  }

 private:
  ingest::Result<void> open_archive(const Call& call) {
    const product::WritingGuard writing(call.control);
    auto opened = product::Archive::open_or_create(archive_, product::archive_settings(call.control, "archive"));
    if (!opened) return ingest::fail(opened.error());
    return {};
  }

  void fail(const Call& call, const Problem& problem) {
    if (call.control.stopped()) return;
    call.console.error(problem);
    failed_ = true;
    usage_ = usage_ || problem.kind == Kind::usage;
    // Where one cannot be written the next cannot either.
    full_ = full_ || problem.kind == Kind::write_failed;
  }

  void take(const Call& call, const fs::path& input) {
    std::error_code error;
    if (!fs::is_directory(input, error)) return is_netcdf(input) ? take_netcdf(call, input) : take_log(call, input);
    const auto files = profiles_in(input);
    if (files.empty())
      return fail(call, {Kind::usage,
                         "this folder holds no profile.nc and is no archive",
                         {input.string(), {}, {}, {}},
                         "give the folder of `quadsonde run`, or the files"});
    for (const auto& file : files)
      if (!call.control.stopped() && !full_) take_netcdf(call, file);
  }

  static bool is_netcdf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string head(8, '\0');
    file.read(head.data(), 8);
    return head == "\x89HDF\r\n\x1a\n" || head.starts_with("CDF") || path.extension() == ".nc";
  }

  /// Of a run's folder, or one with many such: every profile.nc. Of an archive: every profile.
  static std::vector<fs::path> profiles_in(const fs::path& folder) {
    std::error_code error;
    const bool archive = fs::exists(folder / "quadsonde-archive.json", error);
    std::vector<fs::path> files;
    for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
      if (archive ? it->path().extension() == ".nc" : it->path().filename() == "profile.nc")
        files.push_back(it->path());
    std::sort(files.begin(), files.end());
    return files;
  }

  void take_netcdf(const Call& call, const fs::path& path) {
    constexpr std::uintmax_t most = std::uintmax_t{64} << 20;
    std::error_code error;
    const auto size = fs::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    if (error || !file)
      return fail(call, {Kind::unreadable, "this file cannot be read", {path.string(), {}, {}, {}}, "check its path"});
    if (size > most)
      return fail(call, {Kind::limit,
                         "this is larger than a profile can be",
                         {path.string(), {}, {}, {}},
                         "give a profile.nc that `quadsonde run` wrote"});
    std::string bytes(static_cast<std::size_t>(size), '\0');
    file.read(bytes.data(), static_cast<std::streamsize>(size));
    bytes.resize(static_cast<std::size_t>(file.gcount()));
    auto candidate = product::archive_candidate(std::move(bytes), path.string());
    if (!candidate) return fail(call, candidate.error());
    batch_.push_back(std::move(*candidate));
    if (batch_.size() >= at_once) commit(call);
  }

  void take_log(const Call& call, const fs::path& path) {
    product::RunRequest request;
    request.log = path, request.settings = settings_, request.want_classic = false;
    const auto result = product::run_log(request, call.control);
    if (!result) return fail(call, result.error());
    for (const auto& failure : result->failures) call.console.error(failure);
    doubts_ = doubts_ || result->with_doubts();
    const auto archived = product::archive_run(*result, archive_, call.control);
    if (!archived) return fail(call, archived.error());
    for (const auto& problem : archived->left_out) fail(call, problem);
    report(call, archived->added);
  }

  /// What is reported is on the disk.
  void report(const Call& call, const std::vector<product::Added>& added) {
    for (const auto& one : added) {
      if (!call.common.json) call.console.print(product::added_text(one));
      all_.push_back(one);
    }
    call.console.flush();
  }

  void commit(const Call& call) {
    if (batch_.empty() || call.control.stopped()) return;
    const product::WritingGuard writing(call.control);
    auto opened = product::Archive::open_or_create(archive_, product::archive_settings(call.control, "archive"));
    auto added =
        opened ? opened->add(batch_) : ingest::Result<std::vector<product::Added>>(ingest::fail(opened.error()));
    batch_.clear();
    if (!added) return fail(call, added.error());
    report(call, *added);
  }

  static constexpr std::size_t at_once = 32;
  product::PipelineSettings settings_;
  fs::path archive_;
  std::vector<product::ArchiveCandidate> batch_;
  std::vector<product::Added> all_;
  bool failed_ = false, usage_ = false, full_ = false, doubts_ = false;
};

class ListAction : public ArchiveAction {
 public:
  std::string name() const override { return "archive list"; }
  std::string summary() const override { return "every profile of an archive"; }
  void describe(Options& options) override {
    options("all_versions", query_.all_versions, "Also versions that a better one of the same flight has superseded.");
  }
  int run(const Call& call) override {
    auto archive = open(call);
    if (!archive) return failed(call, archive.error());
    const auto entries = archive->query(query_);
    if (!entries) return failed(call, entries.error());
    return answer(call, product::entries_text(*entries), product::entries_json(*entries, archive->root()),
                  product::entries_csv(*entries, archive->root()));
  }

 protected:
  product::ArchiveQuery query_;
};

class QueryAction : public ListAction {
 public:
  std::string name() const override { return "archive query"; }
  std::string summary() const override { return "the profiles of an archive that fit"; }
  void describe(Options& options) override { product::describe(query_, options); }
};

class ExportAction : public ArchiveAction {
 public:
  std::string name() const override { return "archive export"; }
  std::string usage() const override { return "DIR -o FOLDER|X.nc"; }
  std::string summary() const override {
    return "the profiles that fit, as an archive of their own or as one netCDF with a time axis";
  }
  void describe(Options& options) override {
    product::describe(query_, options);
    options("axis", axis_, {"altitude", "height"},
            "Vertical axis of one netCDF: above the sea, or above each take-off point.");
    options("grid_m", grid_m_, 1.0, 1000.0, "Its bins; left out, the most frequent ones of the profiles.");
  }
  int run(const Call& call) override {
    if (!call.output())
      return failed(call, {Kind::usage, "where to is missing", {}, "quadsonde archive export " + usage()});
    auto archive = open(call);
    if (!archive) return failed(call, archive.error());
    const auto entries = archive->query(query_);
    if (!entries) return failed(call, entries.error());
    if (entries->empty())
      return failed(call, {Kind::no_answer,
                           "no profile fits, so there is nothing to export",
                           {call.inputs.front().string(), {}, {}, {}},
                           "ask for more; see `quadsonde archive query`"});
    const auto written =
        call.output()->extension() == ".nc" ? merge(call, *archive, *entries) : subset(call, *archive, *entries);
    if (!written) return failed(call, written.error());
    if (call.common.json)
      call.console.print(product::entries_json(*entries, archive->root()));
    else
      call.console.print(fmt::format("{} profiles in {}\n", entries->size(), call.output()->string()));
    return complete;
  }

 private:
  ingest::Result<void> subset(const Call& call, const product::Archive& archive,
                              const std::vector<product::ArchiveEntry>& entries) {
    const product::WritingGuard writing(call.control);
    return product::export_subset(archive, entries, *call.output(), call.common.force,
                                  product::archive_settings(call.control, "exporting"));
  }
  ingest::Result<void> merge(const Call& call, const product::Archive& archive,
                             const std::vector<product::ArchiveEntry>& entries) {
    product::MergeSettings settings;
    settings.axis = axis_ == "height" ? product::MergeAxis::height : product::MergeAxis::altitude;
    settings.bin_m = grid_m_;
    const auto bytes =
        product::merged_netcdf(archive, entries, settings, product::archive_settings(call.control, "merging"));
    if (!bytes) return ingest::fail(bytes.error());
    product::Outputs outputs(call.common.force, call.control);
    if (auto done = outputs.add(*call.output(), *bytes); !done) return done;
    return outputs.commit();
  }

  product::ArchiveQuery query_;
  std::string axis_ = "altitude";
  std::optional<double> grid_m_;
};

class VerifyAction : public ArchiveAction {
 public:
  std::string name() const override { return "archive verify"; }
  std::string summary() const override {
    return "finds every file of an archive that is missing, changed, cut short or not its own";
  }
  int run(const Call& call) override {
    auto archive = open(call);
    if (!archive) return failed(call, archive.error());
    const auto report = archive->verify();
    if (!report) return failed(call, report.error());
    const int code = answer(call, product::verify_text(*report), product::verify_json(*report));
    return code == complete && !report->findings.empty() ? with_doubts : code;
  }
};

class RebuildAction : public ArchiveAction {
 public:
  std::string name() const override { return "archive rebuild"; }
  std::string summary() const override { return "makes index and catalogue of an archive again, from its files alone"; }
  int run(const Call& call) override {
    const product::WritingGuard writing(call.control);
    const auto report =
        product::Archive::rebuild(call.inputs.front(), product::archive_settings(call.control, "rebuilding"));
    if (!report) return failed(call, report.error());
    const int code = answer(call, product::rebuild_text(*report), product::rebuild_json(*report));
    return code == complete && !report->findings.empty() ? with_doubts : code;
  }
};

}  // namespace

std::vector<std::unique_ptr<Verb>> make_archive_verbs() {
  std::vector<std::unique_ptr<Verb>> verbs;
  verbs.push_back(std::make_unique<AddAction>());
  verbs.push_back(std::make_unique<ListAction>());
  verbs.push_back(std::make_unique<QueryAction>());
  verbs.push_back(std::make_unique<ExportAction>());
  verbs.push_back(std::make_unique<VerifyAction>());
  verbs.push_back(std::make_unique<RebuildAction>());
  return verbs;
}

}  // namespace quadsonde::cli
