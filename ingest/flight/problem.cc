#include "ingest/flight/problem.h"

#include <fmt/format.h>

namespace quadsonde::ingest {

std::string to_string(const Where& where) {
  std::string text = where.file;
  const auto append = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (where.line) append(fmt::format("line {}", *where.line));
  if (where.byte) append(fmt::format("byte {}", *where.byte));
  if (!where.topic.empty()) append(where.topic);
  return text;
}

std::string to_string(const Problem& problem) {
  std::string text = to_string(problem.where);
  if (!text.empty()) text += ": ";
  text += problem.what;
  if (!text.empty() && text.back() != '.') text += '.';
  if (!problem.hint.empty()) text += " " + problem.hint;
  if (!text.empty() && text.back() != '.') text += '.';
  return text;
}

}  // namespace quadsonde::ingest
