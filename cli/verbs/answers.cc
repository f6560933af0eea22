#include "cli/verbs/answers.h"

#include <fmt/format.h>

#include <algorithm>

#include "export/csv/tables.h"
#include "export/pipeline/merge.h"
#include "export/pipeline/netcdf.h"

namespace quadsonde::cli {

using ingest::Kind;
using ingest::Problem;

void tell(Console& console, const product::RunResult& result) {
  console.warnings(result.notes);
  for (const auto& run : result.flights) {
    console.warnings(run.answer.source.problems);
    if (run.answer.no_profile) console.warning(*run.answer.no_profile);
  }
  for (const auto& failure : result.failures) console.error(failure);
}

std::filesystem::path numbered(const std::filesystem::path& path, int flight, bool several) {
  if (!several) return path;
  return path.parent_path() / fmt::format("{}-{}{}", path.stem().string(), flight, path.extension().string());
}

bool wants_json(const Call& call) { return call.common.json || call.output(); }

int give(const Call& call, const std::vector<std::string>& texts) {
  if (!wants_json(call)) {
    for (std::size_t i = 0; i < texts.size(); ++i) call.console.print((i ? "\n" : "") + texts[i]);
    return complete;
  }
  const auto text = texts.size() == 1 ? texts.front() : product::json_list(texts);
  if (!call.output()) {
    call.console.print(text);
    return complete;
  }
  product::Outputs outputs(call.common.force, call.control);
  auto done = outputs.add(*call.output(), text);
  if (done) done = outputs.commit();
  if (!done) call.console.error(done.error());
  return done ? complete : exit_code(done.error());
}

namespace {

/// What makes an output impossible, told before anything is computed.
std::optional<Problem> output_fault(const std::filesystem::path& output, bool tool_names, bool merge, bool section,
                                    const Call& call) {
  std::error_code error;
  const auto refuse = [&](const char* what, const char* hint) {
    return Problem{Kind::usage, what, {output.string(), {}, {}, {}}, hint};
  };
  if (tool_names) return std::nullopt;
  if (std::filesystem::is_directory(output, error))
    return refuse("this is a folder, not a file",
                  "name a file in it, or let the tool name a campaign file with --layout uasdc");
  const auto format = product::format_of(output);
  if (!format)
    return refuse("this ending names no format of an answer",
                  "use .csv, .json, .nc, .mcap, .bufr, .svg, .html, .kml, .geojson or .ascii2nc");
  if (section && !product::holds_sections(*format))
    return refuse("this format holds no section", "write it as .csv, .json, .nc, .svg or .html");
  if (!call.common.force && std::filesystem::exists(output, error))
    return refuse("this file is already there", "name another output or allow overwriting with --force");
  if (call.inputs.size() > 1 && !merge && format != product::Format::json)
    return refuse("one file of this format holds one log", "give one log, or -o X.json");
  return std::nullopt;
}

}  // namespace

bool AnswerVerb::tool_names(const std::filesystem::path& output) const {
  std::error_code error;
  return settings.product.layout == "uasdc" &&
         (std::filesystem::is_directory(output, error) || !output.has_filename() || !output.has_extension());
}

std::vector<product::FlightRun> AnswerVerb::collect(const Call& call, int& code) {
  std::vector<product::FlightRun> runs;
  bool any = false, failed = false;
  code = complete;
  for (const auto& input : call.inputs) {
    product::RunRequest request;
    request.log = input;
    request.references.assign(references.begin(), references.end());
    request.settings = settings;
    request.want_profile = want_profile;
    request.all_flights = merge || section;
    auto result = product::run_log(request, call.control);
    if (!result) {
      call.console.error(result.error());
      code = std::max(code == no_answer ? 0 : code, exit_code(result.error()));
      failed = true;
      continue;
    }
    tell(call.console, *result);
    if (result->with_doubts()) code = std::max(code, with_doubts);
    for (auto& run : result->flights) {
      if (want_profile && !run.answer.profile) {
        failed = true;
        continue;
      }
      any = true;
      runs.push_back(std::move(run));
    }
  }
  if (!any && code != wrong_usage) code = no_answer;
  if (any && failed) code = with_doubts;
  return runs;
}

int AnswerVerb::write(const Call& call, const std::vector<product::FlightRun>& runs) {
  const auto path = *call.output();
  product::Outputs outputs(call.common.force, call.control);
  const auto finish = [&](const ingest::Result<void>& done) {
    if (!done) call.console.error(done.error());
    return done ? complete : exit_code(done.error());
  };
  if (tool_names(path)) {
    if (auto made = outputs.make_folder(path); !made) return finish(made);
    for (const auto& run : runs) {
      const auto named = product::named_uasdc_of(run.answer);
      if (!named) return finish(ingest::fail(named.error()));
      if (auto done = outputs.add(path / named->name, named->bytes); !done) return finish(done);
    }
    return finish(outputs.commit());
  }
  const auto format = *product::format_of(path);
  if (format == product::Format::json && runs.size() > 1) {
    std::vector<std::string> objects;
    for (const auto& run : runs) objects.push_back(*render(run.answer, format));
    if (auto done = outputs.add(path, product::json_list(objects)); !done) return finish(done);
    return finish(outputs.commit());
  }
  for (const auto& run : runs) {
    const auto content = render(run.answer, format);
    if (!content) return finish(ingest::fail(content.error()));
    if (auto done = outputs.add(numbered(path, run.answer.part.number, runs.size() > 1), *content); !done)
      return finish(done);
  }
  return finish(outputs.commit());
}

void AnswerVerb::print(const Call& call, const std::vector<product::FlightRun>& runs) {
  if (call.common.json) {
    std::vector<std::string> objects;
    for (const auto& run : runs) objects.push_back(*render(run.answer, product::Format::json));
    call.console.print(objects.size() == 1 ? objects.front() : product::json_list(objects));
    return;
  }
  for (std::size_t i = 0; i < runs.size(); ++i) call.console.print((i ? "\n" : "") + say(runs[i].answer));
}

std::optional<product::FlightRun> AnswerVerb::merged(const Call& call,
                                                     const std::vector<product::FlightRun>& runs) const {
  std::vector<const product::FlightAnswer*> answers;
  for (const auto& run : runs) answers.push_back(&run.answer);
  auto one = section ? product::section_of(answers) : product::merge_answers(answers);
  if (!one) {
    call.console.error(one.error());
    return std::nullopt;
  }
  if (one->merged) call.console.warnings(one->profile->problems);
  return product::FlightRun{std::move(*one), {}, {}};
}

int AnswerVerb::run(const Call& call) {
  product::apply_words(settings);
  const auto output = call.output();
  if (output)
    if (const auto fault = output_fault(*output, tool_names(*output), merge || section, section, call)) {
      call.console.error(*fault);
      return wrong_usage;
    }
  int code = complete;
  auto runs = collect(call, code);
  if (runs.empty() || call.control.stopped()) return code;
  if (merge || section) {
    auto one = merged(call, runs);
    if (!one) return wrong_usage;
    runs.clear();
    runs.push_back(std::move(*one));
  }
  if (output) {
    if (const int written = write(call, runs); written != complete) return written;
    if (!call.common.json) return code;
  }
  print(call, runs);
  return code;
}

}  // namespace quadsonde::cli
